"""What a drive tells of where it is: odometry and its transform."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cartwheel.geometry import Array, Quat, Vec3, yaw_of
from cartwheel.messages import header, message_class
from cartwheel.plugins.odometry_frame import OdometryFrame
from cartwheel.simulation.handles import JointHandle, LinkHandle

if TYPE_CHECKING:
    from cartwheel.plugins.base import Plugin
    from cartwheel.plugins.wheel_states import WheelTransforms

NO_COVARIANCE = np.zeros(36)
UNKNOWN = 1e12
"""Variance of what a drive on a plane does not know."""


def planar_covariance(x: float, y: float, yaw: float) -> Array:
    """Shape (36,), of a pose or twist in the plane: m² or m²/s², rad² or rad²/s²."""
    return np.diag([x, y, UNKNOWN, UNKNOWN, UNKNOWN, yaw]).ravel()


class Odometry:
    """Publishes ``nav_msgs/Odometry`` and the transform from the odometry frame to the robot.

    Args:
        plugin: Whose namespace and frames count.
        topic: Of the odometry; None for none.
        frame: In which the pose is told.
        base: The frame whose pose and twist are told.
        rate: Hz, for listings.
        transform: Whether the transform is published.
        tf_topic: Where.
        wheels: Published along with it.
        pose_covariance: Shape (36,).
        twist_covariance: Shape (36,).
    """

    def __init__(
        self,
        plugin: Plugin[Any],
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
        self._frame, self._base = plugin.frame(frame), plugin.frame(base)
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
            plugin.advertise(topic, "nav_msgs/msg/Odometry", rate=rate) if topic else None
        )
        self._tf = (
            plugin.advertise(tf_topic, "tf2_msgs/msg/TFMessage", rate=rate)
            if transform or wheels is not None
            else None
        )
        self._moved = OdometryFrame(plugin, base) if transform else None

    def wanted(self) -> bool:
        """Whether anybody reads any of it."""
        if self._odometry is not None and self._odometry.wanted:
            return True
        return self._tf is not None and self._tf.wanted

    def publish(
        self, time_ns: int, place: Vec3, turn: Quat, linear: Sequence[float], angular: Vec3
    ) -> None:
        """Publishes what somebody reads.

        Args:
            time_ns: Of the state.
            place: Of the base in the odometry frame, m.
            turn: Of the base in the odometry frame.
            linear: Velocity in the base's axes, m/s, three of them.
            angular: Turning in the base's axes, rad/s.
        """
        # The path of most messages. Fields are given by position, in the order of their
        # definition, and parts that say the same are one object: both halve its cost. So
        # does a class in a local name a little: Python looks up anew what is called by a dot.
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
        """The robot leaves the world."""
        if self._moved is not None:
            self._moved.close()


def planar_motion(base: LinkHandle) -> tuple[Vec3, Quat, Vec3, Vec3]:
    """True pose of a link in the world, its velocity along its heading, its turning about z."""
    place, turned = base.place()
    (vx, vy, _), (_, _, turn_rate) = base.motion_at(place)
    yaw = yaw_of(turned)
    cos, sin = math.cos(yaw), math.sin(yaw)
    return place, turned, (cos * vx + sin * vy, cos * vy - sin * vx, 0.0), (0.0, 0.0, turn_rate)


class DeadReckoning:
    """Where a drive believes it is, from what its wheels have turned."""

    def __init__(self) -> None:
        self.restart()

    def restart(self) -> None:
        """At the origin, at rest."""
        self.x = self.y = self.heading = 0.0
        self.forward = self.sideways = self.turn_rate = 0.0

    def go(self, forward: float, turn: float, seconds: float, *, sideways: float = 0.0) -> None:
        """Goes on by a way in m and a turn in rad, along an arc, in a time in s."""
        # Along the chord of the arc: exact for constant wheel speeds.
        shrunk = math.sin(turn / 2) / (turn / 2) if abs(turn) > 1e-9 else 1.0
        cos, sin = math.cos(self.heading + turn / 2), math.sin(self.heading + turn / 2)
        self.x += shrunk * (forward * cos - sideways * sin)
        self.y += shrunk * (forward * sin + sideways * cos)
        self.heading += turn
        if seconds > 0:
            self.forward, self.sideways = forward / seconds, sideways / seconds
            self.turn_rate = turn / seconds

    def motion(self) -> tuple[Vec3, Quat, Vec3, Vec3]:
        """As `planar_motion`."""
        half = self.heading / 2
        return (
            (self.x, self.y, 0.0),
            (0.0, 0.0, math.sin(half), math.cos(half)),
            (self.forward, self.sideways, 0.0),
            (0.0, 0.0, self.turn_rate),
        )


class AxleReckoning(DeadReckoning):
    """From what the two wheels of an axle have turned.

    Args:
        left: Joint of a wheel.
        right: Joint of the other.
        radius: m, of both wheels.
        separation: m, between them.
    """

    def __init__(
        self, left: JointHandle, right: JointHandle, *, radius: float, separation: float
    ) -> None:
        self._left, self._right = left, right
        self._radius, self._separation = radius, separation
        super().__init__()
        self.begin()

    def begin(self) -> None:
        """At the origin, at rest, wherever the wheels were turned to."""
        self.restart()
        self._turned: tuple[float, float] | None = None

    def read(self, seconds: float, *, turn: float | None = None) -> None:
        """Goes on by what the wheels have turned since the last time, s ago.

        Args:
            seconds: Since then.
            turn: rad, by which the robot turned, where a gyroscope knows it better.
        """
        turned = (self._left.position, self._right.position)
        if self._turned is not None:
            left, right = ((turned[i] - self._turned[i]) * self._radius for i in (0, 1))
            if turn is None:
                turn = (right - left) / self._separation
            self.go((left + right) / 2, turn, seconds)
        self._turned = turned
