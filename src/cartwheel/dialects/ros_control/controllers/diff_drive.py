"""``diff_drive_controller``: left and right wheels that follow Twist commands."""

from __future__ import annotations

import math
from typing import ClassVar

from cartwheel.codes import devices, running
from cartwheel.devices.drives.limiter import Limiter
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.controllers.limits import read_limits
from cartwheel.dialects.ros_control.controllers.odometry import wheel_odometry
from cartwheel.dialects.ros_control.controllers.twist_command import TwistCommand
from cartwheel.dialects.ros_control.controllers.wheels import (
    LEFT,
    check_axis,
    frame_prefix,
    joint_place,
    wheel_radius,
)
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.messages import header, message_class


class DiffDriveController(Controller):
    """Drives left and right wheels from Twist commands, and publishes odometry.

    Commands arrive on ``cmd_vel``: Twist in ROS 1, TwistStamped in ROS 2. With ``use_stamped_vel:
    false``, ROS 2 uses ``cmd_vel_unstamped`` (Twist). If the wheel separation or radius is not
    specified, it is read from the description. Source: diff_drive_controller.
    """

    types: ClassVar[tuple[str, ...]] = ("diff_drive_controller/DiffDriveController",)

    def configure(self, settings: Settings) -> None:
        ros2 = self.rig.ros2
        left = settings.texts("left_wheel_names" if ros2 else "left_wheel")
        right = settings.texts("right_wheel_names" if ros2 else "right_wheel")
        if not left or len(left) != len(right):
            raise settings.error(
                devices.WHEELS_UNPAIRED,
                "the numbers of left and right wheels must be equal and positive "
                f"(got {len(left)} and {len(right)})",
                values={"left": len(left), "right": len(right)},
            )
        self._left = [self.claim(name, "velocity") for name in left]
        self._right = [self.claim(name, "velocity") for name in right]
        for wheel in (*self._left, *self._right):
            check_axis(self, wheel.joint, LEFT)
        separation = self._separation(settings, self._left[0].joint, self._right[0].joint)
        radius = self._radius(settings, self._left[0].joint)
        self._separation_used = separation * settings.number("wheel_separation_multiplier", 1.0)
        both = settings.number("wheel_radius_multiplier", 1.0)
        self._left_radius = radius * settings.number("left_wheel_radius_multiplier", both)
        self._right_radius = radius * settings.number("right_wheel_radius_multiplier", both)
        self._linear = Limiter(read_limits(settings.section("linear/x")))
        self._angular = Limiter(read_limits(settings.section("angular/z")))
        settings.ignore("wheels_per_side", "allow_multiple_cmd_vel_publishers")
        self._open_loop = settings.boolean("open_loop", False)
        self._by_position = settings.boolean("position_feedback", True)
        timeout = settings.number("cmd_vel_timeout", 0.5)
        settings.ignore("publish_wheel_joint_controller_state", "publish_wheel_data")
        stamped = ros2 and settings.boolean("use_stamped_vel", True)
        topic = "cmd_vel_unstamped" if ros2 and not stamped else "cmd_vel"
        self._command = TwistCommand(self, topic, timeout=timeout, stamped=stamped)
        self._odometry = wheel_odometry(
            self,
            settings,
            transform=settings.boolean("enable_odom_tf", True),
            prefix=frame_prefix(self, settings) if ros2 else "",
        )
        published = settings.boolean("publish_limited_velocity" if ros2 else "publish_cmd", False)
        self._out = (
            self.advertise("cmd_vel_out", "geometry_msgs/msg/TwistStamped") if published else None
        )
        self._turned = (0.0, 0.0)

    def start(self, time_ns: int) -> None:
        self._command.stop()
        self._odometry.start(time_ns)
        self._linear.reset()
        self._angular.reset()
        self._turned = self._positions()

    def update(self, time_ns: int, seconds: float) -> None:
        self._reckon(seconds)
        self._odometry.publish(time_ns)
        forward, _, turn = self._command.at(time_ns)
        forward = self._linear.step(forward, seconds)
        turn = self._angular.step(turn, seconds)
        half = turn * self._separation_used / 2
        for joint in self._left:
            joint.command = (forward - half) / self._left_radius
        for joint in self._right:
            joint.command = (forward + half) / self._right_radius
        if self._out is not None and self._out.wanted:
            self._publish_limited(time_ns, forward, turn)

    def stop(self, time_ns: int) -> None:  # noqa: ARG002
        for joint in self.claims.values():
            joint.command = 0.0

    def _reckon(self, seconds: float) -> None:
        if self._open_loop:
            forward, turn = self._linear.value, self._angular.value
            self._odometry.reckoning.go(forward * seconds, turn * seconds, seconds)
            return
        if self._by_position:
            left, right = self._positions()
            ways = (left - self._turned[0], right - self._turned[1])
            self._turned = (left, right)
        else:
            ways = (
                seconds * _mean([joint.velocity for joint in self._left]),
                seconds * _mean([joint.velocity for joint in self._right]),
            )
        left, right = ways[0] * self._left_radius, ways[1] * self._right_radius
        self._odometry.reckoning.go(
            (left + right) / 2, (right - left) / self._separation_used, seconds
        )

    def _positions(self) -> tuple[float, float]:
        return (
            _mean([joint.position for joint in self._left]),
            _mean([joint.position for joint in self._right]),
        )

    def _publish_limited(self, time_ns: int, forward: float, turn: float) -> None:
        assert self._out is not None
        Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._out.publish(
            message_class("geometry_msgs/msg/TwistStamped")(
                header=header(time_ns, ""),
                twist=message_class("geometry_msgs/msg/Twist")(
                    linear=Vector3(forward, 0.0, 0.0), angular=Vector3(0.0, 0.0, turn)
                ),
            )
        )

    def _separation(self, settings: Settings, left: str, right: str) -> float:
        description = self.part.description
        value = settings.number(
            "wheel_separation",
            math.dist(joint_place(description, left), joint_place(description, right)),
        )
        if value <= 0:
            raise settings.invalid("wheel_separation", value, "positive")
        return value

    def _radius(self, settings: Settings, wheel: str) -> float:
        value = settings.optional_number("wheel_radius") or wheel_radius(
            self.part.description, wheel
        )
        if value is None:
            raise settings.error(
                running.NOT_A_WHEEL,
                f'"wheel_radius" is missing, and the wheel of joint "{wheel}" has no cylinder from '
                "which to derive it",
                values={"parameter": "wheel_radius", "joint": wheel},
            )
        if value <= 0:
            raise settings.invalid("wheel_radius", value, "positive")
        return value


def _mean(values: list[float]) -> float:
    return sum(values) / len(values)
