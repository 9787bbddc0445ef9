"""Message types of hector_gazebo_plugins. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.msgs import geometry_msgs

@dataclass
class SetBias_Request:
    __msgtype__: ClassVar[str]
    bias: geometry_msgs.Vector3 = ...

@dataclass
class SetBias_Response:
    __msgtype__: ClassVar[str]
