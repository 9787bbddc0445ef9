"""``tricycle_controller``: ROS 2's controller of a front wheel that is driven and steered."""

from __future__ import annotations

import math
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.devices.drives.steered_wheels import SteeredWheel, SteeredWheelConfig
from cartwheel.dialects.ros_control.controllers.limits import read_limits
from cartwheel.dialects.ros_control.controllers.odometry import wheel_odometry
from cartwheel.dialects.ros_control.controllers.twist_command import TwistCommand
from cartwheel.dialects.ros_control.controllers.wheel_controller import WheelController
from cartwheel.dialects.ros_control.controllers.wheels import LEFT, UP, check_axis
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.geometry import Vec3


class TricycleController(WheelController):
    """A front wheel that is driven and steered. Source: tricycle_controller."""

    types: ClassVar[tuple[str, ...]] = ("tricycle_controller/TricycleController",)
    _wheels: SteeredWheel

    def configure(self, settings: Settings) -> None:
        wheel = self.claim(settings.text("traction_joint_name"), "velocity")
        steering = self.claim(settings.text("steering_joint_name"), "position")
        check_axis(self, wheel.joint, LEFT)
        check_axis(self, steering.joint, UP)
        base = settings.number("wheelbase")
        radius = settings.number("wheel_radius")
        for name, value in (("wheelbase", base), ("wheel_radius", radius)):
            if value <= 0:
                raise settings.invalid(name, value, "positive")
        limits = settings.section("steering")
        config = SteeredWheelConfig(
            wheel_base=base,
            radius=radius,
            open_loop=settings.boolean("open_loop", False),
            speed_limits=read_limits(settings.section("traction")),
            steering_rate=limits.number("max_velocity", math.inf),
            steering_range=(
                limits.number("min_position", -math.inf),
                limits.number("max_position", math.inf),
            ),
        )
        settings.ignore("traction", "steering")
        for name in ("publish_ackermann_command", "odom_only_twist"):
            if settings.boolean(name, False):
                self.warn(
                    devices.CONTROLLER_PARAMETER_UNKNOWN,
                    f'the parameter "{name}" has no effect',
                    values={"parameters": (name,)},
                )
        timeout = settings.number("cmd_vel_timeout", 500.0) / 1000.0
        stamped = settings.boolean("use_stamped_vel", True)
        self._command = TwistCommand(self, "cmd_vel", timeout=timeout, stamped=stamped)
        self._odometry = wheel_odometry(
            self, settings, transform=settings.boolean("enable_odom_tf", True)
        )
        self._wheels = SteeredWheel(config, wheel, steering, self._odometry.reckoning)

    def _drive(self, command: Vec3, time_ns: int, seconds: float) -> None:  # noqa: ARG002
        forward, _, turn = command
        self._wheels.command(forward, turn, seconds)
