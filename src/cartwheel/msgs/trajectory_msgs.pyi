"""Message types of trajectory_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cartwheel.msgs import builtin_interfaces, geometry_msgs, std_msgs

@dataclass(init=False)
class JointTrajectory:
    __msgtype__: ClassVar[str]
    header: std_msgs.Header = ...
    joint_names: list[str] = ...
    points: list[JointTrajectoryPoint] = ...
    def __init__(
        self,
        header: std_msgs.Header = ...,
        joint_names: list[str] | tuple[str, ...] = ...,
        points: list[JointTrajectoryPoint] | tuple[JointTrajectoryPoint, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class JointTrajectoryPoint:
    __msgtype__: ClassVar[str]
    positions: NDArray[np.float64] = ...
    velocities: NDArray[np.float64] = ...
    accelerations: NDArray[np.float64] = ...
    effort: NDArray[np.float64] = ...
    time_from_start: builtin_interfaces.Duration = ...
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
    joint_names: list[str] = ...
    points: list[MultiDOFJointTrajectoryPoint] = ...
    def __init__(
        self,
        header: std_msgs.Header = ...,
        joint_names: list[str] | tuple[str, ...] = ...,
        points: list[MultiDOFJointTrajectoryPoint] | tuple[MultiDOFJointTrajectoryPoint, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class MultiDOFJointTrajectoryPoint:
    __msgtype__: ClassVar[str]
    transforms: list[geometry_msgs.Transform] = ...
    velocities: list[geometry_msgs.Twist] = ...
    accelerations: list[geometry_msgs.Twist] = ...
    time_from_start: builtin_interfaces.Duration = ...
    def __init__(
        self,
        transforms: list[geometry_msgs.Transform] | tuple[geometry_msgs.Transform, ...] = ...,
        velocities: list[geometry_msgs.Twist] | tuple[geometry_msgs.Twist, ...] = ...,
        accelerations: list[geometry_msgs.Twist] | tuple[geometry_msgs.Twist, ...] = ...,
        time_from_start: builtin_interfaces.Duration | float = ...,
    ) -> None: ...
