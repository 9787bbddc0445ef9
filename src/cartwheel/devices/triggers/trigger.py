"""Publishes messages when a message arrives that matches."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.codes.graph import DELAYED_LOST
from cartwheel.component import Component, Scope
from cartwheel.messages import to_dict

_MOST = 1000
"""Messages that wait for their delay."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Match:
    """A condition on a message."""

    path: tuple[str, ...]
    """Names of the nested fields that are compared; empty for the message."""
    wanted: Any
    """The value. A list is contained in a repeated field."""
    negated: bool
    tolerance: float
    """Of numbers."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TriggeredMessage:
    """A message that is published."""

    topic: str
    type: str
    message: Any


@dataclass(frozen=True, kw_only=True, slots=True)
class TriggerConfig:
    topic: str
    type: str
    matches: tuple[Match, ...]
    """All of them must hold."""
    outputs: tuple[TriggeredMessage, ...]
    delay: float
    """Simulation time between the input and the outputs, s."""


class Trigger(Component):
    """Publishes messages at the first step after a matching message and the delay."""

    def __init__(self, scope: Scope, config: TriggerConfig) -> None:
        super().__init__(scope)
        self._config = config
        self._delay_ns = round(config.delay * 1e9)
        self._due: deque[int] = deque()
        self._lost = 0
        self._outputs = [
            (self.advertise(each.topic, each.type), each.message) for each in config.outputs
        ]
        self.subscribe(config.topic, config.type, self._on_message, unset=True)
        self.part.schedule(0, before=self._publish, active=lambda: bool(self._due))

    def reset(self) -> None:
        super().reset()
        self._due.clear()
        self._lost = 0

    def _on_message(self, message: Any) -> None:
        if not all(holds(each, message) for each in self._config.matches):
            return
        if len(self._due) < _MOST:
            self._due.append(self.part.time_ns + self._delay_ns)
            return
        self._lost += 1
        if self._lost == 1:
            self.warn(
                DELAYED_LOST,
                f"messages on {self._config.topic} trigger nothing: {_MOST} triggers already wait",
                hint="Shorten the delay, or check whether an output triggers its own input.",
                values={"topic": self._config.topic, "waiting": _MOST},
            )

    def _publish(self) -> None:
        # Those that its own outputs trigger are due at the next step. Otherwise, a loop never ends.
        for _ in range(len(self._due)):
            # A subscriber that resets the world clears the rest.
            if not self._due or self._due[0] > self.part.time_ns:
                break
            self._due.popleft()
            for publisher, message in self._outputs:
                publisher.publish(message)


def part_of(message: Any, path: Sequence[str]) -> Any:
    """The nested field of a message."""
    for name in path:
        message = getattr(message, name)
    return message


def holds(match: Match, message: Any) -> bool:
    """Whether a message meets a condition."""
    value, wanted = part_of(message, match.path), match.wanted
    if match.path and isinstance(wanted, list | np.ndarray):
        same = all(any(_equal(each, one, match.tolerance) for each in value) for one in wanted)
    else:
        same = _equal(value, wanted, match.tolerance)
    return same is not match.negated


def _equal(one: Any, other: Any, tolerance: float) -> bool:
    if isinstance(one, bool | np.bool_ | str) or isinstance(other, bool | np.bool_ | str):
        return bool(one == other)
    if isinstance(one, int | float | np.number) and isinstance(other, int | float | np.number):
        return bool(one == other or abs(float(one) - float(other)) <= tolerance)
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return all(_equal(one[name], other[name], tolerance) for name in one if name != "header")
    if isinstance(one, Sequence | np.ndarray) and isinstance(other, Sequence | np.ndarray):
        return len(one) == len(other) and all(
            _equal(a, b, tolerance) for a, b in zip(one, other, strict=True)
        )
    return _equal(to_dict(one), to_dict(other), tolerance)
