"""Time controls for clients."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, kw_only=True, slots=True)
class TimeState:
    """State of simulation time."""

    time_ns: int
    paused: bool
    speed: float | None
    """Target real-time factor. None means as fast as possible."""


class Controls(Protocol):
    """Control of simulation time. Callable on any thread."""

    @property
    def time_ns(self) -> int:
        """Simulation time, which is read for each message."""

    def state(self) -> TimeState:
        """Current state."""

    def pause(self) -> None:
        """Pauses time."""

    def resume(self) -> None:
        """Resumes time."""

    def set_speed(self, speed: float | None) -> None:
        """Sets the target real-time factor."""

    def seek(self, time_ns: int) -> None:
        """Jumps to a time. A simulation can jump only to its start."""
