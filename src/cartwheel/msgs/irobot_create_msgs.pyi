"""Message types of irobot_create_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.msgs import std_msgs

@dataclass
class DockStatus:
    __msgtype__: ClassVar[str]
    header: std_msgs.Header = ...
    dock_visible: bool = ...
    is_docked: bool = ...

@dataclass
class HazardDetection:
    __msgtype__: ClassVar[str]
    BACKUP_LIMIT: ClassVar[int]
    BUMP: ClassVar[int]
    CLIFF: ClassVar[int]
    STALL: ClassVar[int]
    WHEEL_DROP: ClassVar[int]
    OBJECT_PROXIMITY: ClassVar[int]
    header: std_msgs.Header = ...
    type: int = ...

@dataclass
class IrIntensity:
    __msgtype__: ClassVar[str]
    header: std_msgs.Header = ...
    value: int = ...

@dataclass
class IrOpcode:
    __msgtype__: ClassVar[str]
    CODE_IR_FORCE_FIELD: ClassVar[int]
    CODE_IR_VIRTUAL_WALL: ClassVar[int]
    CODE_IR_BUOY_GREEN: ClassVar[int]
    CODE_IR_BUOY_RED: ClassVar[int]
    CODE_IR_BUOY_BOTH: ClassVar[int]
    CODE_IR_EVAC_GREEN_FIELD: ClassVar[int]
    CODE_IR_EVAC_RED_FIELD: ClassVar[int]
    CODE_IR_EVAC_BOTH_FIELD: ClassVar[int]
    SENSOR_OMNI: ClassVar[int]
    SENSOR_DIRECTIONAL_FRONT: ClassVar[int]
    header: std_msgs.Header = ...
    opcode: int = ...
    sensor: int = ...

@dataclass
class Mouse:
    __msgtype__: ClassVar[str]
    header: std_msgs.Header = ...
    integrated_x: float = ...
    integrated_y: float = ...
    frame_id: int = ...
    last_squal: int = ...
