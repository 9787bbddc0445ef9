"""Odometry: the message and the transform from the odometry frame to the robot."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.drives.odometry_frame import OdometryFrame
from cartwheel.devices.drives.reckoning import Motion
from cartwheel.devices.joints.transforms import JointTransforms
from cartwheel.geometry import Array, Quat, Vec3, yaw_of
from cartwheel.messages import header, message_class
from cartwheel.simulation.handles import LinkHandle

NO_COVARIANCE = np.zeros(36)
UNKNOWN = 1e12
"""Variance of the degrees of freedom that planar odometry does not estimate."""


def planar_covariance(x: float, y: float, yaw: float) -> Array:
    """Returns the covariance of a planar pose (m², rad²) or twist (m²/s², rad²/s²), shape (36,)."""
    return np.diag([x, y, UNKNOWN, UNKNOWN, UNKNOWN, yaw]).ravel()


@dataclass(frozen=True, kw_only=True, slots=True)
class OdometryConfig:
    """Topics, frames and covariances of an odometry."""

    topic: str | None
    """Topic of the odometry; None: not published."""
    frame: str
    """Reference frame of the pose."""
    base: str
    """Frame whose pose and twist are published."""
    rate: float = 0.0
    """Publish rate, Hz; 0: every step."""
    transform: bool = True
    """Publish the transform from the odometry frame to the robot."""
    tf_topic: str = "/tf"
    """Topic of the transforms."""
    joints: tuple[str, ...] = ()
    """Joints whose transforms are published with the transform of the robot."""
    pose_covariance: Array = field(default_factory=lambda: NO_COVARIANCE)
    """Shape (36,)."""
    twist_covariance: Array = field(default_factory=lambda: NO_COVARIANCE)
    """Shape (36,)."""


class Odometry(Component):
    """Publishes ``nav_msgs/Odometry`` and the transform from the odometry frame to the robot."""

    def __init__(self, scope: Scope, config: OdometryConfig) -> None:
        super().__init__(scope)
        self._frame, self._base = self.frame(config.frame), self.frame(config.base)
        self._joints = JointTransforms(self, config.joints) if config.joints else None
        self.pose_covariance = config.pose_covariance
        self.twist_covariance = config.twist_covariance
        self._Odometry = message_class("nav_msgs/msg/Odometry")
        self._PoseWithCovariance = message_class("geometry_msgs/msg/PoseWithCovariance")
        self._TwistWithCovariance = message_class("geometry_msgs/msg/TwistWithCovariance")
        self._Pose = message_class("geometry_msgs/msg/Pose")
        self._Point = message_class("geometry_msgs/msg/Point")
        self._Quaternion = message_class("geometry_msgs/msg/Quaternion")
        self._Twist = message_class("geometry_msgs/msg/Twist")
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._Transform = message_class("geometry_msgs/msg/Transform")
        self._TransformStamped = message_class("geometry_msgs/msg/TransformStamped")
        self._TFMessage = message_class("tf2_msgs/msg/TFMessage")
        rate = config.rate or None
        self._odometry = (
            self.advertise(config.topic, "nav_msgs/msg/Odometry", rate=rate)
            if config.topic
            else None
        )
        self._tf = (
            self.advertise(config.tf_topic, "tf2_msgs/msg/TFMessage", rate=rate)
            if config.transform or config.joints
            else None
        )
        self._child = self.keep(OdometryFrame(self, config.base)) if config.transform else None

    def wanted(self) -> bool:
        """Whether one of the topics has subscribers."""
        if self._odometry is not None and self._odometry.wanted:
            return True
        return self._tf is not None and self._tf.wanted

    def publish(
        self,
        time_ns: int,
        place: Vec3,
        turn: Quat,
        linear: Sequence[float],
        angular: Sequence[float],
    ) -> None:
        """Publishes on the topics that have subscribers.

        Args:
            time_ns: Time of the state.
            place: Position of the base in the odometry frame, m.
            turn: Orientation of the base in the odometry frame.
            linear: Velocity, usually in the base frame, m/s, shape (3,).
            angular: Angular velocity, usually in the base frame, rad/s, shape (3,).
        """
        # The hottest path of all messages. Positional fields and shared sub-messages halve its
        # cost. Local names for the classes save attribute lookups.
        Vector3, Quaternion = self._Vector3, self._Quaternion
        head, rotation = header(time_ns, self._frame), Quaternion(*turn)
        if self._tf is not None and self._tf.wanted:
            sent = []
            if self._child is not None:
                Transform, TransformStamped = self._Transform, self._TransformStamped
                where, turned = self._child.place(place, turn)
                turning = rotation if turned is turn else Quaternion(*turned)
                moved = Transform(Vector3(*where), turning)
                sent.append(TransformStamped(head, self._child.name, moved))
            if self._joints is not None:
                sent += self._joints.at(time_ns)
            TFMessage = self._TFMessage
            self._tf.publish(TFMessage(sent))
        if self._odometry is not None and self._odometry.wanted:
            Odometry, Pose, Point, Twist = self._Odometry, self._Pose, self._Point, self._Twist
            PoseWithCovariance = self._PoseWithCovariance
            TwistWithCovariance = self._TwistWithCovariance
            pose = Pose(Point(*place), rotation)
            twist = Twist(Vector3(*linear), Vector3(*angular))
            self._odometry.publish(
                Odometry(
                    head,
                    self._base,
                    PoseWithCovariance(pose, self.pose_covariance),
                    TwistWithCovariance(twist, self.twist_covariance),
                )
            )


def planar_motion(base: LinkHandle) -> Motion:
    """Returns ground-truth pose in the world, planar velocity along the heading (m/s), yaw rate."""
    place, turned = base.place()
    (vx, vy, _), (_, _, turn_rate) = base.motion_at(place)
    yaw = yaw_of(turned)
    cos, sin = math.cos(yaw), math.sin(yaw)
    return place, turned, (cos * vx + sin * vy, cos * vy - sin * vx, 0.0), (0.0, 0.0, turn_rate)
