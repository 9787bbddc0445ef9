"""Message types of std_srvs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

@dataclass
class Empty_Request:
    __msgtype__: ClassVar[str]

@dataclass
class Empty_Response:
    __msgtype__: ClassVar[str]

@dataclass
class SetBool_Request:
    __msgtype__: ClassVar[str]
    data: bool = ...

@dataclass
class SetBool_Response:
    __msgtype__: ClassVar[str]
    success: bool = ...
    message: str = ...

@dataclass
class Trigger_Request:
    __msgtype__: ClassVar[str]

@dataclass
class Trigger_Response:
    __msgtype__: ClassVar[str]
    success: bool = ...
    message: str = ...
