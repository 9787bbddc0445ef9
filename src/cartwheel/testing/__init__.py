"""Tests of robots with pytest: fixtures, marks, and functions that check behaviour.

pytest loads the plugin of this package in each run, so nothing is imported until it is used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cartwheel.testing.launching import Launched, launch
    from cartwheel.testing.matchers import (
        UnmetError,
        holds,
        joint_reaches,
        keeps_clear,
        moves,
        publishes,
        reaches,
        sees,
        stays_within,
        touches,
        touches_nothing,
    )
    from cartwheel.testing.node import Node, NodePublisher

__all__ = [
    "Launched",
    "Node",
    "NodePublisher",
    "UnmetError",
    "holds",
    "joint_reaches",
    "keeps_clear",
    "launch",
    "moves",
    "publishes",
    "reaches",
    "sees",
    "stays_within",
    "touches",
    "touches_nothing",
]
_MODULES = {"Node": "node", "NodePublisher": "node", "Launched": "launching", "launch": "launching"}
"""Where the names are that are not in `matchers`."""


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(name)
    return getattr(importlib.import_module(f"{__name__}.{_MODULES.get(name, 'matchers')}"), name)


def __dir__() -> list[str]:
    """Lists the functions for `help` and completion. Python does not know them before their use."""
    return [*globals(), *__all__]
