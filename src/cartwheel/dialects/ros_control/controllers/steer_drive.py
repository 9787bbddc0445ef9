"""``steer_drive_controller``: ROS 1's controller of one driven wheel and one steering joint."""

from __future__ import annotations

from typing import ClassVar

from cartwheel.devices.drives.steered_wheels import SteeredByAngle, SteeredByAngleConfig
from cartwheel.dialects.ros_control.controllers.limits import read_limits
from cartwheel.dialects.ros_control.controllers.odometry import wheel_odometry
from cartwheel.dialects.ros_control.controllers.twist_command import TwistCommand
from cartwheel.dialects.ros_control.controllers.wheel_controller import WheelController
from cartwheel.dialects.ros_control.controllers.wheels import (
    LEFT,
    UP,
    check_axis,
    joint_place,
    wheel_radius,
)
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.geometry import Vec3


class SteerDriveController(WheelController):
    """One driven wheel and one steered joint, as in ROS 1.

    ``linear.x`` on ``cmd_vel`` is the speed, ``angular.z`` the steering angle. Source:
    ackermann_steering_controller and steer_drive_controller of ROS 1.
    """

    types: ClassVar[tuple[str, ...]] = ("steer_drive_controller/SteerDriveController",)
    _wheels: SteeredByAngle

    def configure(self, settings: Settings) -> None:
        wheel = settings.text("rear_wheel", "rear_wheel_joint")
        steer = settings.text("front_steer", "front_steer_joint")
        driven = self.claim(wheel, "velocity")
        steering = self.claim(steer, "position")
        check_axis(self, wheel, LEFT)
        check_axis(self, steer, UP)
        description = self.part.description
        base = settings.optional_number("wheel_separation_h")
        if base is None:
            base = abs(joint_place(description, steer)[0] - joint_place(description, wheel)[0])
        radius = settings.optional_number("wheel_radius") or wheel_radius(description, wheel)
        if not base or base <= 0 or not radius or radius <= 0:
            name = "wheel_radius" if base and base > 0 else "wheel_separation_h"
            raise settings.invalid(name, radius if name == "wheel_radius" else base, "positive")
        config = SteeredByAngleConfig(
            wheel_base=base * settings.number("wheel_separation_h_multiplier", 1.0),
            radius=radius * settings.number("wheel_radius_multiplier", 1.0),
            angle_factor=settings.number("steer_pos_multiplier", 1.0),
            speed_limits=read_limits(settings.section("linear/x")),
            angle_limits=read_limits(settings.section("angular/z")),
            open_loop=settings.boolean("open_loop", False),
        )
        settings.ignore("allow_multiple_cmd_vel_publishers")
        self._command = TwistCommand(
            self, "cmd_vel", timeout=settings.number("cmd_vel_timeout", 0.5)
        )
        self._odometry = wheel_odometry(
            self, settings, transform=settings.boolean("enable_odom_tf", True)
        )
        self._wheels = SteeredByAngle(config, driven, steering, self._odometry.reckoning)

    def _drive(self, command: Vec3, time_ns: int, seconds: float) -> None:  # noqa: ARG002
        forward, _, angle = command
        self._wheels.command(forward, angle, seconds)
