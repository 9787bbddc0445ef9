"""Changes of restored objects, and the error for what cannot be restored."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any

import numpy as np

from cartwheel.codes.world import STATE_MISMATCH
from cartwheel.errors import SimulationError


def refill(target: Any, items: list[Any]) -> None:
    """Replaces the items of a deque."""
    target.clear()
    target.extend(items)


def refill_set(target: set[Any], items: list[Any]) -> None:
    """Replaces the items of a set."""
    if target != set(items):
        target.clear()
        target.update(items)


def refill_dict(target: dict[Any, Any], items: dict[Any, Any]) -> None:
    """Replaces the items of a dictionary, in their order."""
    target.clear()
    target.update(items)


def set_slots(target: Any, values: dict[str, Any], removed: Sequence[str]) -> None:
    """Sets some slots of an object and clears others; a frozen object has all its slots."""
    frozen = getattr(getattr(target, "__dataclass_params__", None), "frozen", False)
    put = object.__setattr__ if frozen else setattr
    for name, value in values.items():
        put(target, name, value)
    for name in removed:
        if hasattr(target, name):
            delattr(target, name)


def set_attributes(target: Any, values: dict[str, Any], kept: set[str]) -> None:
    """Sets the attributes of an object, and deletes others except those that are `kept`."""
    attributes = target.__dict__
    for name in [name for name in attributes if name not in values and name not in kept]:
        del attributes[name]
    attributes.update(values)


def set_random(target: Any, content: Any) -> None:
    """Sets the state of a random generator."""
    if isinstance(target, np.random.Generator):
        target.bit_generator.state = content
    elif isinstance(target, random.Random):
        target.setstate(content)
    else:
        target.set_state(content)


def mismatch(difference: str) -> SimulationError:
    """Returns the error for a world that differs from the saved one."""
    return SimulationError(
        f"the world differs from the one that was saved: {difference}",
        code=STATE_MISMATCH,
        hint="Restore the state in the world that was saved, or in one that is made from the same "
        "files with the same options.",
        values={"difference": difference},
    )
