"""Message types of gazebo_ros_link_attacher. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

@dataclass
class Attach_Request:
    __msgtype__: ClassVar[str]
    model_name_1: str = ...
    link_name_1: str = ...
    model_name_2: str = ...
    link_name_2: str = ...

@dataclass
class Attach_Response:
    __msgtype__: ClassVar[str]
    ok: bool = ...
