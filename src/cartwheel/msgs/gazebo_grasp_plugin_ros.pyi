"""Message types of gazebo_grasp_plugin_ros. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

@dataclass
class GazeboGraspEvent:
    __msgtype__: ClassVar[str]
    arm: str = ...
    object: str = ...
    attached: bool = ...
