"""What the package needs of its host: an event loop, and a receiver of warnings."""

from __future__ import annotations

import selectors
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

READ = selectors.EVENT_READ


class File(Protocol):
    """A socket, or a different file that can be polled."""

    def fileno(self) -> int:
        """File descriptor."""

    def close(self) -> None:
        """Closes the file."""


class EventLoop(Protocol):
    """An event loop. All methods are called on its thread."""

    def watch(self, sock: File, events: int, ready: Callable[[int], None], /) -> None:
        """Calls `ready` with those of `events` for which a file is ready."""

    def forget(self, sock: File, /) -> None:
        """Stops watching a file."""

    def after(self, seconds: float, function: Callable[[], None], /) -> None:
        """Calls a function once after a delay, s."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LimitWarning:
    """Participants or endpoints are ignored because there are too many."""

    message: str
    values: Mapping[str, str | int]
    """The limit, as ``most``, and the ``host`` or ``topic`` that it applies to."""


class DomainFullError(Exception):
    """All ports for participants in the domain are in use."""


class UnknownHostError(Exception):
    """The name of a host cannot be resolved. The argument is the name."""
