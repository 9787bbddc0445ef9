"""Message types of builtin_interfaces. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

@dataclass
class Duration:
    __msgtype__: ClassVar[str]
    sec: int = ...
    nanosec: int = ...

@dataclass
class Time:
    __msgtype__: ClassVar[str]
    sec: int = ...
    nanosec: int = ...
