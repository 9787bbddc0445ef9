"""``steer_drive_controller``: ROS 1's controller of one driven wheel and one steering joint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.drives.limiter import Limits
from cartwheel.devices.drives.steered_wheels import SteeredByAngle, SteeredByAngleConfig
from cartwheel.dialects.ros_control.controllers.limits import read_limits
from cartwheel.dialects.ros_control.controllers.odometry import (
    OdometryParameters,
    open_loop_parameter,
    wheel_odometry,
)
from cartwheel.dialects.ros_control.controllers.twist_command import TwistCommand
from cartwheel.dialects.ros_control.controllers.wheel_controller import WheelController
from cartwheel.dialects.ros_control.controllers.wheels import (
    LEFT,
    check_axis,
    check_steering,
    joint_place,
    wheel_radius,
)
from cartwheel.dialects.ros_control.parameters import ignored, parameter
from cartwheel.geometry import Vec3


@dataclass(frozen=True, kw_only=True, slots=True)
class SteerDriveParameters(OdometryParameters):
    wheel: str = parameter(
        "rear_wheel",
        default="rear_wheel_joint",
        role="joint",
        interface="velocity",
        doc="Joint of the driven wheel.",
    )
    steer: str = parameter(
        "front_steer",
        default="front_steer_joint",
        role="joint",
        interface="position",
        doc="Steering joint.",
    )
    base: float | None = parameter(
        "wheel_separation_h",
        default=None,
        unit="m",
        role="wheel_base",
        wheels=("steer", "wheel"),
        doc="Distance between the axles. Default: read from the description.",
    )
    base_factor: float = parameter(
        "wheel_separation_h_multiplier", default=1.0, doc="Factor on the distance of the axles."
    )
    radius: float | None = parameter(
        "wheel_radius",
        default=None,
        unit="m",
        role="wheel_radius",
        wheels=("wheel",),
        doc="Radius of the driven wheel. Default: read from the description.",
    )
    radius_factor: float = parameter(
        "wheel_radius_multiplier", default=1.0, doc="Factor on the radius."
    )
    angle_factor: float = parameter(
        "steer_pos_multiplier", default=1.0, doc="Factor on the steering angle."
    )
    linear: Limits = parameter("linear/x", read=read_limits, doc="Limits of the forward speed.")
    angular: Limits = parameter("angular/z", read=read_limits, doc="Limits of the steering angle.")
    open_loop: bool = open_loop_parameter()
    timeout: float = parameter(
        "cmd_vel_timeout", default=0.5, unit="s", doc="Time after which a command expires."
    )
    unused: None = ignored("allow_multiple_cmd_vel_publishers")


class SteerDriveController(WheelController):
    """One driven wheel and one steered joint, as in ROS 1.

    ``linear.x`` on ``cmd_vel`` is the speed, ``angular.z`` the steering angle. Source:
    ackermann_steering_controller and steer_drive_controller of ROS 1.
    """

    types: ClassVar[tuple[str, ...]] = ("steer_drive_controller/SteerDriveController",)
    _wheels: SteeredByAngle

    parameters = SteerDriveParameters

    def configure(self, given: SteerDriveParameters) -> None:
        driven = self.claim(given.wheel, "velocity")
        steering = self.claim(given.steer, "position")
        # With SteerBotHardwareGazebo, other joints move instead of the claimed ones.
        check_axis(self, driven.joint, LEFT)
        check_steering(self, steering.joint, driven.joint, backward=False)
        description = self.part.description
        wheel, steer = (
            claimed if description.joint(claimed) is not None else moved.joint
            for claimed, moved in ((given.wheel, driven), (given.steer, steering))
        )
        base = given.base
        if base is None:
            base = abs(joint_place(description, steer)[0] - joint_place(description, wheel)[0])
        radius = given.radius or wheel_radius(description, wheel)
        if not base or base <= 0 or not radius or radius <= 0:
            name = "wheel_radius" if base and base > 0 else "wheel_separation_h"
            raise self.settings.invalid(
                name, radius if name == "wheel_radius" else base, "positive"
            )
        config = SteeredByAngleConfig(
            wheel_base=base * given.base_factor,
            radius=radius * given.radius_factor,
            angle_factor=given.angle_factor,
            speed_limits=given.linear,
            angle_limits=given.angular,
            open_loop=given.open_loop,
        )
        self._command = TwistCommand(self, "cmd_vel", timeout=given.timeout)
        self._odometry = wheel_odometry(self, given)
        self._wheels = SteeredByAngle(config, driven, steering, self._odometry.reckoning)

    def commanded(self, forward: float, turn: float) -> tuple[float, float]:
        return forward, self._wheels.turned(forward, turn)

    def _drive(self, command: Vec3, time_ns: int, seconds: float) -> None:  # noqa: ARG002
        forward, _, angle = command
        self._wheels.command(forward, angle, seconds)
