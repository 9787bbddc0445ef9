"""Diagnostics on ``/rosout``."""

from __future__ import annotations

from collections.abc import Callable

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros2.middleware import Middleware, Outlet, publisher
from cartwheel.bridges.rosout import TOPIC, TYPE, line
from cartwheel.errors import Diagnostic


class Log:
    """Publishes diagnostics, also to nodes that subscribe later.

    Args:
        loop: Event loop of the bridge.
        node: Name of the node.
        time_ns: Returns the simulation time.
    """

    def __init__(self, loop: Loop, *, node: str, time_ns: Callable[[], int]) -> None:
        self._loop = loop
        self._node = node
        self._time_ns = time_ns
        self._outlet: Outlet | None = None

    def begin(self, middleware: Middleware) -> None:
        """Advertises the topic. Call it on the loop's thread."""
        self._outlet = middleware.publish(publisher(TOPIC, TYPE, "latched"))

    def write(self, diagnostic: Diagnostic) -> None:
        """Logs a diagnostic. Callable on any thread."""
        time_ns = self._time_ns()
        self._loop.post(lambda: self._send(diagnostic, time_ns))

    def _send(self, diagnostic: Diagnostic, time_ns: int) -> None:
        if self._outlet is not None:
            self._outlet.send(line(diagnostic, node=self._node, time_ns=time_ns))
