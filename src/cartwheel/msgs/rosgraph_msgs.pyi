"""Message types of rosgraph_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.msgs import _converted, builtin_interfaces, std_msgs

@dataclass(init=False)
class Clock:
    __msgtype__: ClassVar[str]
    clock: _converted.Time[builtin_interfaces.Time] = ...
    def __init__(
        self,
        clock: builtin_interfaces.Time | float = ...,
    ) -> None: ...

@dataclass(init=False)
class Log:
    __msgtype__: ClassVar[str]
    DEBUG: ClassVar[int]
    INFO: ClassVar[int]
    WARN: ClassVar[int]
    ERROR: ClassVar[int]
    FATAL: ClassVar[int]
    header: std_msgs.Header = ...
    level: int = ...
    name: str = ...
    msg: str = ...
    file: str = ...
    function: str = ...
    line: int = ...
    topics: _converted.List[str] = ...
    def __init__(
        self,
        header: std_msgs.Header = ...,
        level: int = ...,
        name: str = ...,
        msg: str = ...,
        file: str = ...,
        function: str = ...,
        line: int = ...,
        topics: list[str] | tuple[str, ...] = ...,
    ) -> None: ...
