"""What the worlds of a batch receive and return."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Protocol, get_args

import numpy as np

from cartwheel.codes.world import BATCH_INVALID
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Array
from cartwheel.messages.making import expanded

if TYPE_CHECKING:
    from cartwheel.api import World

Apply = Callable[["World", Array], object]
"""Applies an action to a world: receives the world and some columns of the actions, shape (k,)."""
Actions = Mapping[str, Sequence[str] | tuple[Apply, int]]
"""The fields that are set in the messages of each topic, such as
``{"/cmd_vel": ["linear.x", "angular.z"]}``. Or for any name, a function and its number of columns.
"""
Fields = str | Sequence[str]
"""A field that is a number or an array of numbers, such as ``ranges``; or several numbers."""


class Readable(Protocol):
    """What an observation reads from a world without a message."""

    def reader(self, world: World) -> Callable[[], list[float]]:
        """Returns a function that reads the numbers. They are as many each time."""


Observation = Fields | tuple[str, Fields] | Callable[["World"], Any] | Readable
"""Fields of the topic that is the name of the observation; or a topic and its fields; or a function
that returns numbers of a world; or the pose of a model, see `PoseOf`."""
Observations = Mapping[str, Observation]
Backend = Literal["mujoco", "warp"]
BACKENDS: tuple[Backend, ...] = get_args(Backend)
Vary = Callable[["World", np.random.Generator], None]
"""Changes a world after a reset, with random numbers that depend on the seed of the world."""


class AbsoluteVary(ABC):
    """A `Vary` that sets the same values each time, whatever it has set before.

    The world then need not be restored before, which takes longer than a reset.
    """

    @abstractmethod
    def __call__(self, world: World, random: np.random.Generator) -> None:
        """Changes a world."""


@dataclass(frozen=True)
class TopicFields:
    """Fields of the newest message of a topic."""

    topic: str
    fields: tuple[str, ...]
    single: bool
    """Whether the observation is one field, which may be an array."""


@dataclass(frozen=True)
class Applied:
    """Columns of the actions that a function applies."""

    function: Apply
    count: int


@dataclass(frozen=True)
class Plan:
    """How each world of a batch runs. It can be pickled if its functions can.

    Raises:
        CartwheelError: A value is invalid.
    """

    act: Mapping[str, tuple[str, ...] | Applied]
    obs: Mapping[str, TopicFields | Callable[[World], Any] | Readable]
    period: float
    """Simulation time of a step, s."""
    vary: Vary | None

    @classmethod
    def of(
        cls, act: Actions, obs: Observations, *, period: float, vary: Vary | None = None
    ) -> Plan:
        """Checks and completes the arguments of `Batch`."""
        if not isinstance(period, int | float | np.number) or not 0 < period < math.inf:
            raise invalid(f"the period must be a positive number (got {period!r:.60})", "period")
        if vary is not None and not callable(vary):
            raise invalid(f"vary must be a function (got {vary!r:.60})", "vary")
        actions = {name: _action(name, each) for name, each in act.items()}
        if not obs:
            raise invalid("a batch requires at least one observation", "obs")
        return cls(actions, {name: _observation(name, each) for name, each in obs.items()}, period,
                   vary)  # fmt: skip

    @property
    def action_names(self) -> tuple[str, ...]:
        """Topic and field of each column of the actions, or the name and number of a function's."""
        return tuple(
            f"{name} {field}"
            for name, each in self.act.items()
            for field in (range(each.count) if isinstance(each, Applied) else each)
        )


def _action(name: str, value: Any) -> tuple[str, ...] | Applied:
    if isinstance(value, Sequence) and not isinstance(value, str) and value:
        if all(isinstance(each, str) for each in value):
            return columns_of(value)
        if len(value) == 2 and callable(value[0]):
            function, count = value
            if isinstance(count, int) and not isinstance(count, bool) and count >= 1:
                return Applied(function, count)
    raise invalid(
        f'the action "{name}" must have a list of fields, or a function and its number of columns',
        "act",
    )


def columns_of(fields: Iterable[str]) -> tuple[str, ...]:
    """The field that each column sets: two for ``data[:2]``.

    Raises:
        GraphError: The length of an array is invalid.
    """
    return tuple(each for field in fields for each in expanded(field))


def _observation(name: str, value: Any) -> Any:
    if callable(value) or hasattr(value, "reader"):
        return value
    topic = name
    if isinstance(value, tuple) and len(value) == 2 and str(value[0]).startswith("/"):
        topic, value = value
    if isinstance(value, str):
        return TopicFields(topic, (value,), True)
    fields = tuple(value) if isinstance(value, Sequence) else ()
    if not fields or not all(isinstance(each, str) for each in fields):
        raise invalid(f'the observation "{name}" must be a field, a list of fields, a topic with '
                      "its fields, a PoseOf, or a function", "obs")  # fmt: skip
    return TopicFields(topic, fields, False)


def invalid(message: str, argument: str) -> CartwheelError:
    """The error of an invalid argument."""
    return CartwheelError(message, code=BATCH_INVALID, values={"argument": argument})
