"""Message types of diagnostic_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.msgs import _converted, std_msgs

@dataclass(init=False)
class DiagnosticArray:
    __msgtype__: ClassVar[str]
    header: std_msgs.Header = ...
    status: _converted.List[DiagnosticStatus] = ...
    def __init__(
        self,
        header: std_msgs.Header = ...,
        status: list[DiagnosticStatus] | tuple[DiagnosticStatus, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class DiagnosticStatus:
    __msgtype__: ClassVar[str]
    OK: ClassVar[int]
    WARN: ClassVar[int]
    ERROR: ClassVar[int]
    STALE: ClassVar[int]
    level: int = ...
    name: str = ...
    message: str = ...
    hardware_id: str = ...
    values: _converted.List[KeyValue] = ...
    def __init__(
        self,
        level: int = ...,
        name: str = ...,
        message: str = ...,
        hardware_id: str = ...,
        values: list[KeyValue] | tuple[KeyValue, ...] = ...,
    ) -> None: ...

@dataclass
class KeyValue:
    __msgtype__: ClassVar[str]
    key: str = ...
    value: str = ...
