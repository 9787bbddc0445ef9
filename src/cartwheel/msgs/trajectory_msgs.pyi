"""Message types of trajectory_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cartwheel.msgs import _converted, builtin_interfaces, geometry_msgs, std_msgs

@dataclass(init=False)
class JointTrajectory:
    __msgtype__: ClassVar[str]
    header: std_msgs.Header = ...
    joint_names: _converted.List[str] = ...
    points: _converted.List[JointTrajectoryPoint] = ...
    def __init__(
        self,
        header: std_msgs.Header = ...,
        joint_names: list[str] | tuple[str, ...] = ...,
        points: list[JointTrajectoryPoint] | tuple[JointTrajectoryPoint, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class JointTrajectoryPoint:
    __msgtype__: ClassVar[str]
    positions: _converted.Array[np.float64] = ...
    velocities: _converted.Array[np.float64] = ...
    accelerations: _converted.Array[np.float64] = ...
    effort: _converted.Array[np.float64] = ...
    time_from_start: _converted.Time[builtin_interfaces.Duration] = ...
    def __init__(
        self,
        positions: ArrayLike = ...,
        velocities: ArrayLike = ...,
        accelerations: ArrayLike = ...,
        effort: ArrayLike = ...,
        time_from_start: builtin_interfaces.Duration | float = ...,
    ) -> None: ...

@dataclass(init=False)
class MultiDOFJointTrajectory:
    __msgtype__: ClassVar[str]
    header: std_msgs.Header = ...
    joint_names: _converted.List[str] = ...
    points: _converted.List[MultiDOFJointTrajectoryPoint] = ...
    def __init__(
        self,
        header: std_msgs.Header = ...,
        joint_names: list[str] | tuple[str, ...] = ...,
        points: list[MultiDOFJointTrajectoryPoint] | tuple[MultiDOFJointTrajectoryPoint, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class MultiDOFJointTrajectoryPoint:
    __msgtype__: ClassVar[str]
    transforms: _converted.List[geometry_msgs.Transform] = ...
    velocities: _converted.List[geometry_msgs.Twist] = ...
    accelerations: _converted.List[geometry_msgs.Twist] = ...
    time_from_start: _converted.Time[builtin_interfaces.Duration] = ...
    def __init__(
        self,
        transforms: list[geometry_msgs.Transform] | tuple[geometry_msgs.Transform, ...] = ...,
        velocities: list[geometry_msgs.Twist] | tuple[geometry_msgs.Twist, ...] = ...,
        accelerations: list[geometry_msgs.Twist] | tuple[geometry_msgs.Twist, ...] = ...,
        time_from_start: builtin_interfaces.Duration | float = ...,
    ) -> None: ...
