"""What drives on wheels share: sizes from the description, commands that expire, odometry."""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from cartwheel.codes import robot
from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import Cylinder, RobotDescription, Sphere
from cartwheel.geometry import Array, matrix_from_quat
from cartwheel.plugins.control.controller import Controller, Rhythm
from cartwheel.plugins.control.settings import Settings
from cartwheel.plugins.odometry import DeadReckoning, Odometry

if TYPE_CHECKING:
    from cartwheel.plugins.base import Plugin

LEFT, UP = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
"""What wheels and steerings turn about, in the robot's axes."""
_MOST_KEPT = 10_000
"""Velocities that an average is taken of."""
_NEVER = -(1 << 62)


def joint_place(description: RobotDescription, joint: str) -> tuple[float, float, float]:
    """Where a joint's child link is in the robot, m, at zero positions."""
    found = description.joint(joint)
    assert found is not None
    poses = link_poses(description, {})
    front = poses[description.canonical_link].inverse()
    return (front @ poses[found.child]).position


def check_axis(controller: Controller, joint: str, wanted: tuple[float, float, float]) -> None:
    """Tells of a joint that turns the other way than its drive expects.

    Args:
        controller: The drive.
        joint: Of a wheel or a steering.
        wanted: About what it should turn, in the robot's axes.
    """
    description = controller.part.description
    found = description.joint(joint)
    assert found is not None
    poses = link_poses(description, {})
    front = poses[description.canonical_link].inverse()
    turn = matrix_from_quat((front @ poses[found.child]).orientation)
    axis = turn @ np.array(found.axis.xyz)
    if float(axis @ np.array(wanted)) < -0.5:
        name = "xyz"[max(range(3), key=lambda index: wanted[index])]
        controller.warn(
            robot.WHEEL_AXIS_MISALIGNED,
            f'the axis of joint "{joint}" points along -{name} of the robot, so it turns in the '
            "opposite direction",
            at=found.origin,
            values={"joint": joint, "axis": f"-{name}"},
        )


def wheel_radius(description: RobotDescription, joint: str) -> float | None:
    """Of a joint's wheel, m: that of its cylinder or sphere; None where it has neither."""
    found = description.joint(joint)
    link = description.link(found.child) if found is not None else None
    if link is None:
        return None
    shapes = [part.shape for part in link.collisions] + [part.shape for part in link.visuals]
    for shape in shapes:
        if isinstance(shape, Cylinder | Sphere):
            return shape.radius
    return None


def frame_prefix(controller: Controller, settings: Settings) -> str:
    """What ROS 2's drives put before their frames: ``tf_frame_prefix``, or the namespace."""
    wanted = settings.boolean("tf_frame_prefix_enable", True)
    own = settings.text("tf_frame_prefix", "")
    space = (own or controller.rig.namespace).strip("/")
    return f"{space}/" if wanted and space else ""


class TwistCommand:
    """The last Twist heard, which counts for a limited time.

    Args:
        controller: Whose topic it is.
        topic: Its name.
        timeout: s; 0 is endless.
        stamped: Whether it is a TwistStamped.
    """

    def __init__(
        self, controller: Controller, topic: str, *, timeout: float, stamped: bool = False
    ) -> None:
        self._part = controller.part
        self._timeout_ns = round(timeout * 1e9)
        self._stamped = stamped
        self.stop()
        controller.subscribe(
            topic, f"geometry_msgs/msg/Twist{'Stamped' if stamped else ''}", self._heard
        )

    def stop(self) -> None:
        """Forgets it."""
        self._values = (0.0, 0.0, 0.0)
        self._time_ns = _NEVER

    def at(self, time_ns: int) -> tuple[float, float, float]:
        """Velocities along x and y in m/s and about z in rad/s; zeros when it is too old."""
        if self._timeout_ns > 0 and time_ns - self._time_ns > self._timeout_ns:
            return (0.0, 0.0, 0.0)
        return self._values

    def _heard(self, message: Any) -> None:
        twist = message.twist if self._stamped else message
        values = (float(twist.linear.x), float(twist.linear.y), float(twist.angular.z))
        if all(math.isfinite(value) for value in values):
            self._values = values
            self._time_ns = self._part.time_ns


class WheelOdometry:
    """Dead reckoning from wheels, told at a rate; velocities are a mean of the last ones.

    Args:
        controller: Whose topics and frames count.
        settings: ``publish_rate``, frames, covariances, ``velocity_rolling_window_size``.
        topic: Of the odometry.
        transform: Whether the transform is published.
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
            cast("Plugin[Any]", controller),
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
        """From the origin, at rest."""
        self.reckoning.restart()
        self._recent.clear()
        self._rhythm.start(time_ns)

    def go(self, forward: float, turn: float, seconds: float, *, sideways: float = 0.0) -> None:
        """A way in m and a turn in rad, in a time in s."""
        self.reckoning.go(forward, turn, seconds, sideways=sideways)
        if seconds > 0:
            self._recent.append((forward / seconds, sideways / seconds, turn / seconds))

    def tell(self, time_ns: int) -> None:
        """Publishes when it is due and read."""
        if not self._rhythm.due(time_ns) or not self._odometry.wanted():
            return
        place, turn, _, _ = self.reckoning.motion()
        count = max(len(self._recent), 1)
        forward, sideways, rate = (
            sum(each[axis] for each in self._recent) / count for axis in range(3)
        )
        self._odometry.publish(time_ns, place, turn, (forward, sideways, 0.0), (0.0, 0.0, rate))

    def close(self) -> None:
        """The controller is unloaded."""
        self._odometry.close()


def _covariance(settings: Settings, name: str) -> Array:
    """Shape (36,)."""
    values = settings.numbers(name, [0.0] * 6)
    if len(values) == 36:
        return np.array(values)
    if len(values) != 6:
        raise settings.invalid(name, values, "6 numbers, or 36")
    return np.diag(values).ravel()
