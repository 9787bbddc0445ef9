"""Ground truth: the pose and the velocity of a link without errors of a drive or a sensor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.drives.odometry import Odometry, OdometryConfig
from cartwheel.geometry import (
    Pose,
    Quat,
    Vec3,
    cross,
    quat_conjugate,
    quat_from_rpy,
    quat_multiply,
    quat_normalize,
    rotate,
    yaw_of,
)

State = tuple[Vec3, Quat, Sequence[float], Sequence[float]]
"""Position in m, orientation, linear velocity in m/s and angular velocity in rad/s."""
_ZERO = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class GroundTruthConfig:
    link: str
    """Link whose state is published."""
    reference: str | None = None
    """Link to which the state is relative. None: the world."""
    shift: Vec3 = _ZERO
    """Offset added to the position, in the reference frame, m."""
    rotation: Vec3 = _ZERO
    """Rotation applied to the orientation about the axes of the reference frame, as roll, pitch
    and yaw, rad."""
    twist_in_link: bool = False
    """Whether the velocities are in the link frame instead of the reference frame."""
    noise: float = 0.0
    """Standard deviation of the noise on the velocities, m/s and rad/s."""
    noise_name: str
    """Name of the random sequence."""
    odometry: OdometryConfig
    """Topic, frames, rate and covariances."""


class GroundTruth(Component):
    """Publishes the true state of a link as odometry.

    Args:
        scope: The link's model and names.
        config: Link, reference frame and topic.

    Raises:
        UnknownNameError: A link does not exist.
    """

    def __init__(self, scope: Scope, config: GroundTruthConfig) -> None:
        super().__init__(scope)
        part = self.part
        self._config = config
        self._link = part.link(config.link, origin=self.origin)
        self._reference = part.link(config.reference) if config.reference is not None else None
        self._rotation = quat_from_rpy(*config.rotation)
        self._odometry = self.add(Odometry(scope, config.odometry))
        part.schedule(config.odometry.rate, after=self._publish, topics=self._odometry.publishers)

    def _publish(self) -> None:
        config, link = self._config, self._link
        place, orientation = link.place()
        linear: Sequence[float]
        angular: Sequence[float]
        linear, angular = link.motion(local=False)
        if self._reference is not None:
            place, orientation, linear, angular = relative(
                (place, orientation, linear, angular),
                (*self._reference.place(), *self._reference.motion(local=False)),
            )
        if config.twist_in_link:
            linear, angular = link.motion(local=True)
        if any(config.shift):
            x, y, z = (a + b for a, b in zip(place, config.shift, strict=True))
            place = (x, y, z)
        if any(config.rotation):
            orientation = quat_normalize(quat_multiply(self._rotation, orientation))
        if config.noise > 0:
            drawn = self.part.random(config.noise_name).normal(0.0, config.noise, 6)
            linear = (linear + drawn[:3]).tolist()
            angular = (angular + drawn[3:]).tolist()
        self._odometry.publish(self.part.time_ns, place, orientation, linear, angular)


def relative(state: State, reference: State) -> State:
    """Returns the state relative to a moving frame, along the axes of this frame.

    The velocities are differences of the velocities in the world: the rotation of the reference
    frame does not add to them.
    """
    place, orientation, linear, angular = state
    origin, axes, frame_linear, frame_angular = reference
    pose = Pose(origin, axes).inverse() @ Pose(place, orientation)
    back = quat_conjugate(axes)
    return (
        pose.position,
        pose.orientation,
        rotate(back, [a - b for a, b in zip(linear, frame_linear, strict=True)]),
        rotate(back, [a - b for a, b in zip(angular, frame_angular, strict=True)]),
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class BaseTruthConfig:
    link: str
    """Link that carries the base frame."""
    mount: Pose
    """Pose of the base frame in the link."""
    planar: bool
    """Whether only x, y and yaw are published."""
    noise: float
    """Standard deviation of the noise on the velocities, m/s and rad/s."""
    noise_name: str
    """Name of the random sequence."""
    rate: float
    """Publish rate, Hz; 0: every step."""
    outputs: tuple[OdometryConfig, ...]
    """Topics, frames and covariances."""


class BaseTruth(Component):
    """Publishes the true pose of a base frame in the world, with velocities in the base frame.

    Args:
        scope: The base's model and names.
        config: Base frame and topics.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: BaseTruthConfig) -> None:
        super().__init__(scope)
        self._config = config
        self._link = self.part.link(config.link, origin=self.origin)
        self._outputs = [self.add(Odometry(scope, output)) for output in config.outputs]
        self.part.schedule(
            config.rate,
            after=self._publish,
            topics=[each for output in self._outputs for each in output.publishers],
        )

    def _publish(self) -> None:
        config = self._config
        pose = self._link.pose @ config.mount
        origin_velocity, angular = self._link.motion(local=False)
        arm = rotate(self._link.pose.orientation, config.mount.position)
        linear = np.array(origin_velocity) + cross(angular, arm)
        place, orientation = pose.position, pose.orientation
        if config.planar:
            place, orientation = planar_pose(place, orientation)
        back = quat_conjugate(orientation)
        twist = [*rotate(back, linear.tolist()), *rotate(back, angular)]
        if config.noise > 0:
            random = self.part.random(config.noise_name)
            twist = (np.array(twist) + random.normal(0.0, config.noise, 6)).tolist()
        if config.planar:
            twist[2] = twist[3] = twist[4] = 0.0
        for output in self._outputs:
            if output.wanted():
                output.publish(self.part.time_ns, place, orientation, twist[:3], twist[3:])


def planar_pose(place: Vec3, orientation: Quat) -> tuple[Vec3, Quat]:
    """Returns the position in the ground plane, and the rotation about the vertical."""
    half = yaw_of(orientation) / 2
    return (place[0], place[1], 0.0), (0.0, 0.0, math.sin(half), math.cos(half))
