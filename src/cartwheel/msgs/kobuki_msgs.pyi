"""Message types of kobuki_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cartwheel.msgs import _converted, std_msgs

@dataclass
class BumperEvent:
    __msgtype__: ClassVar[str]
    LEFT: ClassVar[int]
    CENTER: ClassVar[int]
    RIGHT: ClassVar[int]
    RELEASED: ClassVar[int]
    PRESSED: ClassVar[int]
    bumper: int = ...
    state: int = ...

@dataclass
class CliffEvent:
    __msgtype__: ClassVar[str]
    LEFT: ClassVar[int]
    CENTER: ClassVar[int]
    RIGHT: ClassVar[int]
    FLOOR: ClassVar[int]
    CLIFF: ClassVar[int]
    sensor: int = ...
    state: int = ...
    bottom: int = ...

@dataclass
class MotorPower:
    __msgtype__: ClassVar[str]
    OFF: ClassVar[int]
    ON: ClassVar[int]
    state: int = ...

@dataclass(init=False)
class SensorState:
    __msgtype__: ClassVar[str]
    BUMPER_RIGHT: ClassVar[int]
    BUMPER_CENTRE: ClassVar[int]
    BUMPER_LEFT: ClassVar[int]
    WHEEL_DROP_RIGHT: ClassVar[int]
    WHEEL_DROP_LEFT: ClassVar[int]
    CLIFF_RIGHT: ClassVar[int]
    CLIFF_CENTRE: ClassVar[int]
    CLIFF_LEFT: ClassVar[int]
    BUTTON0: ClassVar[int]
    BUTTON1: ClassVar[int]
    BUTTON2: ClassVar[int]
    DISCHARGING: ClassVar[int]
    DOCKING_CHARGED: ClassVar[int]
    DOCKING_CHARGING: ClassVar[int]
    ADAPTER_CHARGED: ClassVar[int]
    ADAPTER_CHARGING: ClassVar[int]
    OVER_CURRENT_LEFT_WHEEL: ClassVar[int]
    OVER_CURRENT_RIGHT_WHEEL: ClassVar[int]
    OVER_CURRENT_BOTH_WHEELS: ClassVar[int]
    DIGITAL_INPUT0: ClassVar[int]
    DIGITAL_INPUT1: ClassVar[int]
    DIGITAL_INPUT2: ClassVar[int]
    DIGITAL_INPUT3: ClassVar[int]
    DB25_TEST_BOARD_CONNECTED: ClassVar[int]
    header: std_msgs.Header = ...
    time_stamp: int = ...
    bumper: int = ...
    wheel_drop: int = ...
    cliff: int = ...
    left_encoder: int = ...
    right_encoder: int = ...
    left_pwm: int = ...
    right_pwm: int = ...
    buttons: int = ...
    charger: int = ...
    battery: int = ...
    bottom: _converted.Array[np.uint16] = ...
    current: _converted.Array[np.uint8] = ...
    over_current: int = ...
    digital_input: int = ...
    analog_input: _converted.Array[np.uint16] = ...
    def __init__(
        self,
        header: std_msgs.Header = ...,
        time_stamp: int = ...,
        bumper: int = ...,
        wheel_drop: int = ...,
        cliff: int = ...,
        left_encoder: int = ...,
        right_encoder: int = ...,
        left_pwm: int = ...,
        right_pwm: int = ...,
        buttons: int = ...,
        charger: int = ...,
        battery: int = ...,
        bottom: ArrayLike = ...,
        current: ArrayLike = ...,
        over_current: int = ...,
        digital_input: int = ...,
        analog_input: ArrayLike = ...,
    ) -> None: ...

@dataclass
class WheelDropEvent:
    __msgtype__: ClassVar[str]
    LEFT: ClassVar[int]
    RIGHT: ClassVar[int]
    RAISED: ClassVar[int]
    DROPPED: ClassVar[int]
    wheel: int = ...
    state: int = ...
