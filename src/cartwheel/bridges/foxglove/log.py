"""Diagnostics on ``/rosout``, for the log panels of clients."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

from cartwheel.bridges.foxglove.forms import schema_of
from cartwheel.bridges.rosout import TOPIC, TYPE, line
from cartwheel.errors import Diagnostic

NODE = "cartwheel"
_KEPT = 100
"""Maximum number of stored lines."""


class Log:
    """A channel of diagnostics, used on the bridge's thread.

    The first client receives the stored lines. Additional clients do not, because a channel's
    messages go to all subscribers, which would receive each line twice.

    Args:
        context: foxglove's context of the server.
        time_ns: Simulation time.
    """

    def __init__(self, *, context: Any, time_ns: Callable[[], int]) -> None:
        import foxglove

        self._time_ns = time_ns
        self.channel = foxglove.Channel(
            TOPIC, message_encoding="cdr", schema=schema_of(TYPE, "cdr"), context=context
        )
        self._said: deque[tuple[int, bytes]] = deque(maxlen=_KEPT)
        self._readers = 0

    def join(self) -> None:
        """Called when a client subscribes."""
        self._readers += 1
        if self._readers == 1:
            for time_ns, data in self._said:
                self.channel.log(data, log_time=time_ns)

    def leave(self) -> None:
        """Called when a client unsubscribes."""
        self._readers = max(0, self._readers - 1)

    def write(self, diagnostic: Diagnostic) -> None:
        """Logs a diagnostic."""
        time_ns = self._time_ns()
        data = line(diagnostic, node=NODE, time_ns=time_ns)
        self._said.append((time_ns, data))
        if self._readers:
            self.channel.log(data, log_time=time_ns)

    def close(self) -> None:
        """Closes the channel."""
        self.channel.close()
