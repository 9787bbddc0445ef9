"""Shared parts of wheeled drives: dimensions, commands that expire, and odometry."""

from __future__ import annotations

import math
from collections import deque
from typing import Any

import numpy as np

from cartwheel.codes import robot
from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import Cylinder, RobotDescription, Sphere
from cartwheel.devices.drives.odometry import DeadReckoning, Odometry
from cartwheel.dialects.ros_control.controller import Controller, Rhythm
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.geometry import Array, matrix_from_quat

LEFT, UP = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
"""Rotation axes of wheels and of steering joints, in the robot's base frame."""
_MOST_KEPT = 10_000
"""Maximum number of averaged velocities."""
_NEVER = -(1 << 62)


def joint_place(description: RobotDescription, joint: str) -> tuple[float, float, float]:
    """Returns the position of a joint's child link in the robot in m, at zero joint positions."""
    described = description.joint(joint)
    assert described is not None
    poses = link_poses(description, {})
    front = poses[description.canonical_link].inverse()
    return (front @ poses[described.child]).position


def check_axis(controller: Controller, joint: str, wanted: tuple[float, float, float]) -> None:
    """Warns about a joint whose axis is opposite to the one that the drive expects.

    Args:
        controller: The drive.
        joint: Joint of a wheel, or a steering joint.
        wanted: Expected axis, in the robot's base frame.
    """
    description = controller.part.description
    described = description.joint(joint)
    assert described is not None
    poses = link_poses(description, {})
    front = poses[description.canonical_link].inverse()
    turn = matrix_from_quat((front @ poses[described.child]).orientation)
    axis = turn @ np.array(described.axis.xyz)
    if float(axis @ np.array(wanted)) < -0.5:
        name = "xyz"[max(range(3), key=lambda index: wanted[index])]
        controller.warn(
            robot.WHEEL_AXIS_MISALIGNED,
            f'the axis of joint "{joint}" points along the robot\'s -{name} axis, so '
            "positive commands turn it in the opposite direction",
            at=described.origin,
            values={"joint": joint, "axis": f"-{name}"},
        )


def wheel_radius(description: RobotDescription, joint: str) -> float | None:
    """Returns the radius of a joint's wheel in m: its cylinder's or sphere's, or None."""
    described = description.joint(joint)
    link = description.link(described.child) if described is not None else None
    if link is None:
        return None
    shapes = [part.shape for part in link.collisions] + [part.shape for part in link.visuals]
    for shape in shapes:
        if isinstance(shape, Cylinder | Sphere):
            return shape.radius
    return None


def frame_prefix(controller: Controller, settings: Settings) -> str:
    """Returns the prefix of a ROS 2 drive's frames: ``tf_frame_prefix``, or the namespace."""
    wanted = settings.boolean("tf_frame_prefix_enable", True)
    own = settings.text("tf_frame_prefix", "")
    space = (own or controller.rig.namespace).strip("/")
    return f"{space}/" if wanted and space else ""


class TwistCommand:
    """The last Twist command, which expires.

    Args:
        controller: The controller that subscribes to the topic.
        topic: Name of the topic.
        timeout: Time after which a command expires, s; 0: never.
        stamped: Whether the type is TwistStamped.
    """

    def __init__(
        self, controller: Controller, topic: str, *, timeout: float, stamped: bool = False
    ) -> None:
        self._part = controller.part
        self._timeout_ns = round(timeout * 1e9)
        self._stamped = stamped
        self.stop()
        controller.subscribe(
            topic, f"geometry_msgs/msg/Twist{'Stamped' if stamped else ''}", self._on_command
        )

    def stop(self) -> None:
        """Clears the command."""
        self._values = (0.0, 0.0, 0.0)
        self._time_ns = _NEVER

    def at(self, time_ns: int) -> tuple[float, float, float]:
        """Returns x and y velocities in m/s and the yaw rate in rad/s; 0 after the timeout."""
        if self._timeout_ns > 0 and time_ns - self._time_ns > self._timeout_ns:
            return (0.0, 0.0, 0.0)
        return self._values

    def _on_command(self, message: Any) -> None:
        twist = message.twist if self._stamped else message
        values = (float(twist.linear.x), float(twist.linear.y), float(twist.angular.z))
        if all(math.isfinite(value) for value in values):
            self._values = values
            self._time_ns = self._part.time_ns


class WheelOdometry:
    """Publishes dead reckoning from wheels, with velocities averaged over the last updates.

    Args:
        controller: The controller that publishes the topic.
        settings: ``publish_rate``, frames, covariances, ``velocity_rolling_window_size``.
        topic: Topic of the odometry.
        transform: Whether to publish the transform.
    """

    def __init__(
        self,
        controller: Controller,
        settings: Settings,
        *,
        topic: str = "odom",
        tf_topic: str = "/tf",
        transform: bool,
        prefix: str = "",
    ) -> None:
        rate = settings.number("publish_rate", 50.0)
        if rate <= 0:
            raise settings.invalid("publish_rate", rate, "positive")
        size = settings.integer("velocity_rolling_window_size", 10)
        if not 1 <= size <= _MOST_KEPT:
            wanted = f"from 1 to {_MOST_KEPT:,}"
            raise settings.invalid("velocity_rolling_window_size", size, wanted)
        self._recent: deque[tuple[float, float, float]] = deque(maxlen=size)
        self._rhythm = Rhythm(rate)
        self.reckoning = DeadReckoning()
        frame = settings.text("odom_frame_id", "odom")
        base = settings.text("base_frame_id", "base_link")
        self._odometry = Odometry(
            controller,
            topic=topic,
            frame=prefix + frame,
            base=prefix + base if prefix else base,
            rate=rate,
            transform=transform,
            tf_topic=tf_topic,
            pose_covariance=_covariance(settings, "pose_covariance_diagonal"),
            twist_covariance=_covariance(settings, "twist_covariance_diagonal"),
        )

    def start(self, time_ns: int) -> None:
        """Restarts at the origin, at rest."""
        self.reckoning.restart()
        self._recent.clear()
        self._rhythm.start(time_ns)

    def go(self, forward: float, turn: float, seconds: float, *, sideways: float = 0.0) -> None:
        """Adds a distance in m and a rotation in rad, made in a time in s."""
        self.reckoning.go(forward, turn, seconds, sideways=sideways)
        if seconds > 0:
            self._recent.append((forward / seconds, sideways / seconds, turn / seconds))

    def publish(self, time_ns: int) -> None:
        """Publishes the odometry if it is due and has subscribers."""
        if not self._rhythm.due(time_ns) or not self._odometry.wanted():
            return
        place, turn, _, _ = self.reckoning.motion()
        count = max(len(self._recent), 1)
        forward, sideways, rate = (
            sum(each[axis] for each in self._recent) / count for axis in range(3)
        )
        self._odometry.publish(time_ns, place, turn, (forward, sideways, 0.0), (0.0, 0.0, rate))

    def close(self) -> None:
        """Closes the topics when the controller is unloaded."""
        self._odometry.close()


def _covariance(settings: Settings, name: str) -> Array:
    """Returns a covariance, shape (36,)."""
    values = settings.numbers(name, [0.0] * 6)
    if len(values) == 36:
        return np.array(values)
    if len(values) != 6:
        raise settings.invalid(name, values, "6 numbers, or 36")
    return np.diag(values).ravel()
