"""``tricycle_controller``: ROS 2's controller of a front wheel that is driven and steered."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.drives.limiter import Limits
from cartwheel.devices.drives.steered_wheels import SteeredWheel, SteeredWheelConfig
from cartwheel.dialects.ros_control.controllers.limits import read_limits
from cartwheel.dialects.ros_control.controllers.odometry import (
    OdometryParameters,
    open_loop_parameter,
    wheel_odometry,
)
from cartwheel.dialects.ros_control.controllers.twist_command import TwistCommand
from cartwheel.dialects.ros_control.controllers.wheel_controller import WheelController
from cartwheel.dialects.ros_control.controllers.wheels import LEFT, UP, check_axis
from cartwheel.dialects.ros_control.parameters import ignored, parameter
from cartwheel.geometry import Vec3


@dataclass(frozen=True, kw_only=True, slots=True)
class TricycleParameters(OdometryParameters):
    traction: str = parameter(
        "traction_joint_name",
        role="joint",
        interface="velocity",
        doc="Joint of the driven wheel.",
    )
    steering: str = parameter(
        "steering_joint_name", role="joint", interface="position", doc="Steering joint."
    )
    base: float = parameter(
        "wheelbase",
        unit="m",
        role="wheel_base",
        wheels=("steering",),
        positive=True,
        doc="Distance between the axles.",
    )
    radius: float = parameter(
        "wheel_radius",
        unit="m",
        role="wheel_radius",
        wheels=("traction",),
        positive=True,
        doc="Radius of the driven wheel.",
    )
    speed_limits: Limits = parameter(
        "traction", read=read_limits, doc="Limits of the forward speed."
    )
    steering_rate: float = parameter(
        "steering/max_velocity",
        default=math.inf,
        unit="rad/s",
        doc="Maximum velocity of the steering joint.",
    )
    steering_lower: float = parameter(
        "steering/min_position", default=-math.inf, unit="rad", doc="Minimum steering angle."
    )
    steering_upper: float = parameter(
        "steering/max_position", default=math.inf, unit="rad", doc="Maximum steering angle."
    )
    open_loop: bool = open_loop_parameter()
    timeout: float = parameter(
        "cmd_vel_timeout", default=500.0, unit="ms", doc="Time after which a command expires."
    )
    stamped: bool = parameter(
        "use_stamped_vel", default=True, doc="Subscribe to TwistStamped instead of Twist."
    )
    publish_command: bool = parameter(
        "publish_ackermann_command", default=False, doc="Not supported."
    )
    only_twist: bool = parameter("odom_only_twist", default=False, doc="Not supported.")
    unused: None = ignored("traction", "steering", doc="Other limits have no effect.")


class TricycleController(WheelController):
    """A front wheel that is driven and steered. Source: tricycle_controller."""

    types: ClassVar[tuple[str, ...]] = ("tricycle_controller/TricycleController",)
    _wheels: SteeredWheel

    parameters = TricycleParameters

    def configure(self, given: TricycleParameters) -> None:
        wheel = self.claim(given.traction, "velocity")
        steering = self.claim(given.steering, "position")
        check_axis(self, wheel.joint, LEFT)
        check_axis(self, steering.joint, UP)
        config = SteeredWheelConfig(
            wheel_base=given.base,
            radius=given.radius,
            open_loop=given.open_loop,
            speed_limits=given.speed_limits,
            steering_rate=given.steering_rate,
            steering_range=(given.steering_lower, given.steering_upper),
        )
        if given.publish_command:
            self.warn_ignored("publish_ackermann_command")
        if given.only_twist:
            self.warn_ignored("odom_only_twist")
        timeout = given.timeout / 1000.0
        self._command = TwistCommand(self, "cmd_vel", timeout=timeout, stamped=given.stamped)
        self._odometry = wheel_odometry(self, given)
        self._wheels = SteeredWheel(config, wheel, steering, self._odometry.reckoning)

    def _drive(self, command: Vec3, time_ns: int, seconds: float) -> None:  # noqa: ARG002
        forward, _, turn = command
        self._wheels.command(forward, turn, seconds)
