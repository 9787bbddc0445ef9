"""What a client may do to time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, kw_only=True, slots=True)
class TimeState:
    """How time goes."""

    time_ns: int
    paused: bool
    speed: float | None
    """The wanted real-time factor; None is as fast as it can."""


class Controls(Protocol):
    """Time in the simulation's hands; called on any thread."""

    @property
    def time_ns(self) -> int:
        """What time it is; asked for each message."""

    def state(self) -> TimeState:
        """How it goes now."""

    def pause(self) -> None:
        """Holds it."""

    def resume(self) -> None:
        """Lets it go on."""

    def set_speed(self, speed: float | None) -> None:
        """Sets the wanted real-time factor."""

    def seek(self, time_ns: int) -> None:
        """Jumps: a simulation can to its start alone."""
