"""Controllers and plugins that accept joint positions, for sliders and other manual control."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class JointInput:
    """A controller or plugin that accepts positions for some joints of a model."""

    model: str
    owner: str
    """Name of the controller or plugin."""
    joints: tuple[str, ...]
    put: Callable[[Mapping[str, float], float], None]
    """Commands positions (rad or m) by joint name, to be reached after a time in s. Inputs that do
    not follow trajectories ignore the time. If the input has a topic, the command takes the same
    path as a message on the topic. Call it on the graph owner's thread."""


class JointInputs:
    """All joint inputs of a graph. Callable on any thread.

    Args:
        changed: Called after each change.
    """

    def __init__(self, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._lock = threading.Lock()
        self._all: tuple[JointInput, ...] = ()

    def add(self, made: JointInput) -> None:
        """Adds an input, unless it was already added."""
        with self._lock:
            new = made not in self._all
            if new:
                self._all += (made,)
        if new:
            self._changed()

    def remove(self, gone: JointInput) -> None:
        """Removes an input if it was added."""
        with self._lock:
            left = tuple(each for each in self._all if each is not gone)
            same, self._all = len(left) == len(self._all), left
        if not same:
            self._changed()

    def replace(self, every: tuple[JointInput, ...]) -> None:
        """Sets all inputs, oldest first."""
        with self._lock:
            same, self._all = self._all == every, every
        if not same:
            self._changed()

    def close(self) -> None:
        """Removes all inputs, without calling `changed`."""
        with self._lock:
            self._all = ()
            self._changed = lambda: None

    def all(self) -> tuple[JointInput, ...]:
        """All inputs, oldest first."""
        return self._all
