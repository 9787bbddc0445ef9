"""Who takes positions for which joints, for those who would move them by hand."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class JointInput:
    """Something that takes positions for some joints of a model, a controller say."""

    model: str
    owner: str
    """Its name."""
    joints: tuple[str, ...]
    put: Callable[[Mapping[str, float], float], None]
    """Sends all of its joints to positions, rad or m by name, in s if it is told a time; on the
    graph owner's thread. What it says goes the way of a message on its topic where it has one."""


class JointInputs:
    """All of a graph; from any thread.

    Args:
        changed: Called after each change.
    """

    def __init__(self, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._lock = threading.Lock()
        self._all: tuple[JointInput, ...] = ()

    def add(self, made: JointInput) -> None:
        """Offers it; nothing happens where it is offered already."""
        with self._lock:
            new = made not in self._all
            if new:
                self._all += (made,)
        if new:
            self._changed()

    def remove(self, gone: JointInput) -> None:
        """Takes it back; nothing happens where it was not offered."""
        with self._lock:
            left = tuple(each for each in self._all if each is not gone)
            same, self._all = len(left) == len(self._all), left
        if not same:
            self._changed()

    def close(self) -> None:
        """Forgets all, and tells nobody any more."""
        with self._lock:
            self._all = ()
            self._changed = lambda: None

    def all(self) -> tuple[JointInput, ...]:
        """Them, the oldest first."""
        return self._all
