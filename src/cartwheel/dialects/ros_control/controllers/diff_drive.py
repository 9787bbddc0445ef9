"""``diff_drive_controller``: left and right wheels that follow Twist commands."""

from __future__ import annotations

import math
from typing import ClassVar, Literal

from cartwheel.codes import devices, running
from cartwheel.devices.drives.differential import (
    DifferentialDrive,
    DifferentialDriveConfig,
    WheelPair,
)
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
        ros2 = self.robot.ros2
        left = settings.texts("left_wheel_names" if ros2 else "left_wheel")
        right = settings.texts("right_wheel_names" if ros2 else "right_wheel")
        if not left or len(left) != len(right):
            raise settings.error(
                devices.WHEELS_UNPAIRED,
                "the numbers of left and right wheels must be equal and positive "
                f"(got {len(left)} and {len(right)})",
                values={"left": len(left), "right": len(right)},
            )
        pairs = list(zip(left, right, strict=True))
        claims = [self.claim(name, "velocity") for name in (*left, *right)]
        for wheel in claims:
            check_axis(self, wheel.joint, LEFT)
        first_left, first_right = claims[0].joint, claims[len(left)].joint
        separation = self._separation(settings, first_left, first_right)
        radius = self._radius(settings, first_left)
        separation *= settings.number("wheel_separation_multiplier", 1.0)
        both = settings.number("wheel_radius_multiplier", 1.0)
        left_radius = radius * settings.number("left_wheel_radius_multiplier", both)
        right_radius = radius * settings.number("right_wheel_radius_multiplier", both)
        linear = read_limits(settings.section("linear/x"))
        angular = read_limits(settings.section("angular/z"))
        settings.ignore("wheels_per_side", "allow_multiple_cmd_vel_publishers")
        open_loop = settings.boolean("open_loop", False)
        by_position = settings.boolean("position_feedback", True)
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
        measured: Literal["positions", "velocities"] = "positions" if by_position else "velocities"
        self._drive = self.add(
            DifferentialDrive(
                self.scope,
                DifferentialDriveConfig(
                    pairs=tuple(
                        WheelPair(
                            left=one,
                            right=other,
                            separation=separation,
                            left_radius=left_radius,
                            right_radius=right_radius,
                        )
                        for one, other in pairs
                    ),
                    linear=linear,
                    angular=angular,
                    odometry="commands" if open_loop else measured,
                    measured_pairs=None,
                    drive=None,
                ),
                wheel_of=self.claims.__getitem__,
                reckoning=self._odometry.reckoning,
            )
        )
        published = settings.boolean("publish_limited_velocity" if ros2 else "publish_cmd", False)
        self._limited = (
            self.advertise("cmd_vel_out", "geometry_msgs/msg/TwistStamped") if published else None
        )

    def start(self, time_ns: int) -> None:
        self._command.stop()
        self._odometry.start(time_ns)
        self._drive.start()

    def update(self, time_ns: int, seconds: float) -> None:
        drive = self._drive
        drive.measure(seconds)
        self._odometry.publish(time_ns)
        drive.command(*self._command.at(time_ns))
        drive.actuate(seconds)
        if self._limited is not None and self._limited.wanted:
            self._publish_limited(time_ns, drive.linear.value, drive.angular.value)

    def stop(self, time_ns: int) -> None:  # noqa: ARG002
        for joint in self.claims.values():
            joint.command = 0.0

    def _publish_limited(self, time_ns: int, forward: float, turn: float) -> None:
        assert self._limited is not None
        Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._limited.publish(
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
