"""Odometry of drives: the message, the transform and dead reckoning."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from cartwheel.devices.drives.odometry_frame import OdometryFrame
from cartwheel.geometry import Array, Quat, Vec3, yaw_of
from cartwheel.messages import header, message_class
from cartwheel.simulation.handles import JointHandle, LinkHandle

if TYPE_CHECKING:
    from cartwheel.component import Component
    from cartwheel.devices.drives.wheel_states import WheelTransforms

NO_COVARIANCE = np.zeros(36)
UNKNOWN = 1e12
"""Variance of the degrees of freedom that planar odometry does not estimate."""


def planar_covariance(x: float, y: float, yaw: float) -> Array:
    """Returns the covariance of a planar pose (m², rad²) or twist (m²/s², rad²/s²), shape (36,)."""
    return np.diag([x, y, UNKNOWN, UNKNOWN, UNKNOWN, yaw]).ravel()


class Odometry:
    """Publishes ``nav_msgs/Odometry`` and the transform from the odometry frame to the robot.

    Args:
        owner: Provides the namespace and the frame prefix.
        topic: Topic of the odometry; None: not published.
        frame: Reference frame of the pose.
        base: Frame whose pose and twist are published.
        rate: Publish rate for listings, Hz.
        transform: Whether to publish the transform.
        tf_topic: Topic of the transforms.
        wheels: Transforms of the wheels, published with the transform of the robot.
        pose_covariance: Shape (36,).
        twist_covariance: Shape (36,).
    """

    def __init__(
        self,
        owner: Component,
        *,
        topic: str | None,
        frame: str,
        base: str,
        rate: float | None,
        transform: bool,
        tf_topic: str = "/tf",
        wheels: WheelTransforms | None = None,
        pose_covariance: Array = NO_COVARIANCE,
        twist_covariance: Array = NO_COVARIANCE,
    ) -> None:
        self._frame, self._base = owner.frame(frame), owner.frame(base)
        self._wheels = wheels
        self.pose_covariance, self.twist_covariance = pose_covariance, twist_covariance
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
        self._odometry = (
            owner.advertise(topic, "nav_msgs/msg/Odometry", rate=rate) if topic else None
        )
        self._tf = (
            owner.advertise(tf_topic, "tf2_msgs/msg/TFMessage", rate=rate)
            if transform or wheels is not None
            else None
        )
        self._moved = OdometryFrame(owner, base) if transform else None

    def wanted(self) -> bool:
        """Whether one of the topics has subscribers."""
        if self._odometry is not None and self._odometry.wanted:
            return True
        return self._tf is not None and self._tf.wanted

    def publish(
        self, time_ns: int, place: Vec3, turn: Quat, linear: Sequence[float], angular: Vec3
    ) -> None:
        """Publishes on the topics that have subscribers.

        Args:
            time_ns: Time of the state.
            place: Position of the base in the odometry frame, m.
            turn: Orientation of the base in the odometry frame.
            linear: Velocity in the base frame, m/s, shape (3,).
            angular: Angular velocity in the base frame, rad/s.
        """
        # The hottest path of all messages. Positional fields and shared sub-messages halve its
        # cost. Local names for the classes save attribute lookups.
        Vector3, Quaternion = self._Vector3, self._Quaternion
        head, rotation = header(time_ns, self._frame), Quaternion(*turn)
        if self._tf is not None and self._tf.wanted:
            sent = []
            if self._moved is not None:
                Transform, TransformStamped = self._Transform, self._TransformStamped
                where, turned = self._moved.place(place, turn)
                turning = rotation if turned is turn else Quaternion(*turned)
                moved = Transform(Vector3(*where), turning)
                sent.append(TransformStamped(head, self._moved.child, moved))
            if self._wheels is not None:
                sent += self._wheels.at(time_ns)
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

    def close(self) -> None:
        """Stops publishing static transforms."""
        if self._moved is not None:
            self._moved.close()


def planar_motion(base: LinkHandle) -> tuple[Vec3, Quat, Vec3, Vec3]:
    """Returns ground-truth pose in the world, planar velocity along the heading (m/s), yaw rate."""
    place, turned = base.place()
    (vx, vy, _), (_, _, turn_rate) = base.motion_at(place)
    yaw = yaw_of(turned)
    cos, sin = math.cos(yaw), math.sin(yaw)
    return place, turned, (cos * vx + sin * vy, cos * vy - sin * vx, 0.0), (0.0, 0.0, turn_rate)


class DeadReckoning:
    """Estimates the pose of a robot in the plane from the motion of its wheels."""

    def __init__(self) -> None:
        self.restart()

    def restart(self) -> None:
        """Resets the estimate to the origin, at rest."""
        self.x = self.y = self.heading = 0.0
        self.forward = self.sideways = self.turn_rate = 0.0

    def go(self, forward: float, turn: float, seconds: float, *, sideways: float = 0.0) -> None:
        """Adds a motion along an arc: distance in m, rotation in rad, duration in s."""
        # Along the chord of the arc, which is exact for constant wheel speeds.
        shrunk = math.sin(turn / 2) / (turn / 2) if abs(turn) > 1e-9 else 1.0
        cos, sin = math.cos(self.heading + turn / 2), math.sin(self.heading + turn / 2)
        self.x += shrunk * (forward * cos - sideways * sin)
        self.y += shrunk * (forward * sin + sideways * cos)
        self.heading += turn
        if seconds > 0:
            self.forward, self.sideways = forward / seconds, sideways / seconds
            self.turn_rate = turn / seconds

    def motion(self) -> tuple[Vec3, Quat, Vec3, Vec3]:
        """Returns the estimate in the form of `planar_motion`."""
        half = self.heading / 2
        return (
            (self.x, self.y, 0.0),
            (0.0, 0.0, math.sin(half), math.cos(half)),
            (self.forward, self.sideways, 0.0),
            (0.0, 0.0, self.turn_rate),
        )


class AxleReckoning(DeadReckoning):
    """Dead reckoning from the rotation of the two wheels on an axle.

    Args:
        left: Joint of the left wheel.
        right: Joint of the right wheel.
        radius: Radius of both wheels, m.
        separation: Distance between the wheels, m.
    """

    def __init__(
        self, left: JointHandle, right: JointHandle, *, radius: float, separation: float
    ) -> None:
        self._left, self._right = left, right
        self._radius, self._separation = radius, separation
        super().__init__()
        self.begin()

    def begin(self) -> None:
        """Resets the estimate to the origin and ignores past rotation of the wheels."""
        self.restart()
        self._turned: tuple[float, float] | None = None

    def read(self, seconds: float, *, turn: float | None = None) -> None:
        """Adds the motion of the wheels since the last call.

        Args:
            seconds: Time since the last call, s.
            turn: Rotation of the robot in rad, if a gyroscope measures it; None: computed from the
                wheels.
        """
        turned = (self._left.position, self._right.position)
        if self._turned is not None:
            left, right = ((turned[i] - self._turned[i]) * self._radius for i in (0, 1))
            if turn is None:
                turn = (right - left) / self._separation
            self.go((left + right) / 2, turn, seconds)
        self._turned = turned
