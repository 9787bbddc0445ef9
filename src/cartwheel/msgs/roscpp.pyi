"""Message types of roscpp. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.msgs import _converted

@dataclass
class Logger:
    __msgtype__: ClassVar[str]
    name: str = ...
    level: str = ...

@dataclass
class GetLoggers_Request:
    __msgtype__: ClassVar[str]

@dataclass(init=False)
class GetLoggers_Response:
    __msgtype__: ClassVar[str]
    loggers: _converted.List[Logger] = ...
    def __init__(
        self,
        loggers: list[Logger] | tuple[Logger, ...] = ...,
    ) -> None: ...

@dataclass
class SetLoggerLevel_Request:
    __msgtype__: ClassVar[str]
    logger: str = ...
    level: str = ...

@dataclass
class SetLoggerLevel_Response:
    __msgtype__: ClassVar[str]
