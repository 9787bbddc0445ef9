"""Diagnostics on ``/rosout``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros2.middleware import Middleware, Outlet, publisher
from cartwheel.errors import Diagnostic
from cartwheel.messages import encode_cdr, message_class, stamp

TOPIC, TYPE = "/rosout", "rcl_interfaces/msg/Log"
_LEVELS = {"info": 20, "warning": 30, "error": 40}


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
        origin = diagnostic.origin
        message: Any = message_class(TYPE)(
            stamp=stamp(self._time_ns()),
            level=_LEVELS[diagnostic.severity],
            name=self._node,
            msg=diagnostic.text,
            file=origin.file if origin else "",
            function="",
            line=origin.line if origin else 0,
        )
        self._loop.post(lambda: self._send(message))

    def _send(self, message: Any) -> None:
        if self._outlet is not None:
            self._outlet.send(encode_cdr(message))
