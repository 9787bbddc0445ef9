"""Diagnostics on ``/rosout``, filtered by the node's log level."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any, Literal

from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros1.publication import Publication
from cartwheel.codes.wires import LOG_LEVEL_UNKNOWN
from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.messages import header, message_class, service_classes, zero
from cartwheel.messages.ros1 import ros1_type

TOPIC, TYPE = "/rosout", "rosgraph_msgs/msg/Log"
LOGGER = "ros.cartwheel"
_LEVELS = {"debug": 1, "info": 2, "warn": 4, "error": 8, "fatal": 16}
_OF: dict[Literal["info", "warning", "error"], str] = {
    "info": "info",
    "warning": "warn",
    "error": "error",
}
_KEPT = 50
"""Maximum number of lines stored for the first subscriber, as no node can be connected earlier."""


class Log:
    """Publishes diagnostics.

    Args:
        loop: Event loop of the bridge.
        node: Name of the node.
        time_ns: Returns the simulation time.
        warn: Receives warnings about subscribers.
    """

    def __init__(
        self,
        loop: Loop,
        *,
        node: str,
        time_ns: Callable[[], int],
        warn: Callable[[Diagnostic], None],
    ) -> None:
        self._loop = loop
        self._node = node
        self._time_ns = time_ns
        self._level = "info"
        self._early: deque[Any] = deque(maxlen=_KEPT)
        self._heard = False
        self.publication = _LogPublication(
            topic=TOPIC,
            type_=ros1_type(TYPE),
            latched=False,
            node=node,
            warn=warn,
        )
        self.publication.on_first = self._catch_up

    def write(self, diagnostic: Diagnostic) -> None:
        """Logs a diagnostic. Callable on any thread."""
        level = _LEVELS[_OF[diagnostic.severity]]
        if level < _LEVELS[self._level]:
            return
        origin = diagnostic.origin
        message = message_class(TYPE)(
            header=header(self._time_ns(), ""),
            level=level,
            name=self._node,
            msg=diagnostic.text,
            file=origin.file if origin else "",
            line=origin.line if origin else 0,
        )
        self._loop.post(lambda: self._send(message))

    def get_loggers(self, _: Any) -> Any:
        """``roscpp/GetLoggers``."""
        _request, response = service_classes("roscpp/GetLoggers")
        logger = message_class("roscpp/msg/Logger")
        return response(loggers=[logger(name=LOGGER, level=self._level)])

    def set_logger_level(self, request: Any) -> Any:
        """``roscpp/SetLoggerLevel``."""
        level = request.level.lower()
        if level not in _LEVELS:
            raise CartwheelError(
                f'"{request.level}" is not a valid logger level',
                code=LOG_LEVEL_UNKNOWN,
                hint=f"Valid levels: {', '.join(_LEVELS)}.",
                values={"level": request.level},
            )
        self._level = level
        return zero("roscpp/srv/SetLoggerLevel_Response")

    def _send(self, message: Any) -> None:
        if self._heard:
            self.publication.send(message)
        else:
            self._early.append(message)

    def _catch_up(self) -> None:
        self._heard = True
        while self._early:
            self.publication.send(self._early.popleft())


class _LogPublication(Publication):
    """Notifies the log when the first subscriber connects."""

    on_first: Callable[[], None]

    def begin(self) -> None:
        self.on_first()
