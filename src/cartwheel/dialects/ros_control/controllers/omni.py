"""``omni_wheel_drive_controller``: omni wheels on a circle, for motion in all directions."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import robot, running
from cartwheel.devices.drives.omni import OmniWheels, OmniWheelsConfig, wheel_places
from cartwheel.devices.drives.rollers import has_grip, has_roller_links, has_rollers
from cartwheel.dialects.ros_control.controllers.odometry import (
    open_loop_parameter,
    position_feedback_parameter,
    wheel_odometry,
)
from cartwheel.dialects.ros_control.controllers.twist_command import TwistCommand
from cartwheel.dialects.ros_control.controllers.wheel_controller import WheelController
from cartwheel.dialects.ros_control.controllers.wheels import (
    FramePrefixParameters,
    frame_prefix,
    joint_axis,
)
from cartwheel.dialects.ros_control.parameters import parameter
from cartwheel.geometry import Vec3

_FEWEST = 3


@dataclass(frozen=True, kw_only=True, slots=True)
class OmniWheelParameters(FramePrefixParameters):
    wheels: tuple[str, ...] = parameter(
        "wheel_names",
        role="joint",
        interface="velocity",
        doc="Joints of three or more wheels at equal angles from each other, counter-clockwise.",
    )
    offset: float = parameter(
        "wheel_offset", unit="rad", doc="Direction of the first wheel, as an angle to the x axis."
    )
    reach: float = parameter(
        "robot_radius",
        unit="m",
        positive=True,
        doc="Distance between the centre of the robot and the wheels.",
    )
    radius: float = parameter(
        "wheel_radius",
        unit="m",
        role="wheel_radius",
        wheels=("wheels",),
        positive=True,
        doc="Radius of the wheels.",
    )
    # The original publishes at each update, and does not average.
    publish_rate: float = parameter(ros1=(), ros2=(), default=0.0, doc="")
    window: int = parameter(ros1=(), ros2=(), default=10, doc="")
    pose_covariance: tuple[float, ...] = parameter(
        "diagonal_covariance/pose",
        default=(0.0,) * 6,
        doc="Covariance of the pose: 6 numbers of the diagonal.",
    )
    twist_covariance: tuple[float, ...] = parameter(
        "diagonal_covariance/twist",
        default=(0.0,) * 6,
        doc="Covariance of the twist: 6 numbers of the diagonal.",
    )
    open_loop: bool = open_loop_parameter()
    position_feedback: bool = position_feedback_parameter(default=True)
    timeout: float = parameter(
        "cmd_vel_timeout", default=0.5, unit="s", doc="Time after which a command expires."
    )


class OmniWheelDriveController(WheelController):
    """Turns omni wheels as TwistStamped commands require, and publishes odometry.

    If the wheels model rollers, by friction or by links, friction moves the robot. Otherwise a
    servo pushes it, as for a mecanum drive, provided that the controller's parameters are known
    when the robot is spawned. Source: omni_wheel_drive_controller.
    """

    types: ClassVar[tuple[str, ...]] = ("omni_wheel_drive_controller/OmniWheelDriveController",)
    sideways: ClassVar[bool] = True
    _wheels: OmniWheels

    parameters = OmniWheelParameters

    def configure(self, given: OmniWheelParameters) -> None:
        names = given.wheels
        if len(names) < _FEWEST:
            wanted = f"a list of at least {_FEWEST} joints"
            raise self.settings.invalid("wheel_names", list(names), wanted)
        wheels = [self.claim(name, "velocity") for name in names]
        joints = [wheel.joint for wheel in wheels]
        for joint, place in zip(joints, wheel_places(len(joints), given.offset), strict=True):
            self._check_axis(joint, place)
        description = self.part.description
        config = OmniWheelsConfig(
            radius=given.radius,
            reach=given.reach,
            offset=given.offset,
            measures=(
                "nothing"
                if given.open_loop
                else "positions"
                if given.position_feedback
                else "velocities"
            ),
        )
        self._command = TwistCommand(self, "cmd_vel", timeout=given.timeout, stamped=True)
        self._odometry = wheel_odometry(
            self, given, prefix=frame_prefix(self, given), averaged=False
        )
        grips = has_grip(description, joints)
        rolls = has_rollers(description) or has_roller_links(description, joints)
        push = self.robot.push if grips and not rolls else None
        self._wheels = OmniWheels(config, wheels, push, self._odometry.reckoning)
        if not grips:
            self.warn(
                robot.WHEEL_FRICTIONLESS,
                "the wheels have no friction, so the controller does not move the robot",
            )
        elif push is None and not rolls:
            self.warn(
                running.WHEELS_WITHOUT_ROLLERS,
                "the wheels do not model rollers, so the robot does not move sideways",
                hint="Load the controller's parameters before the robot is spawned: Cartwheel then "
                "moves the whole robot at the commanded velocity.",
            )

    def _check_axis(self, joint: str, place: float) -> None:
        """Warns about a wheel whose axis does not point away from the centre at an angle in rad."""
        described = self.part.description.joint(joint)
        assert described is not None
        x, y, _ = joint_axis(self.part.description, joint).tolist()
        if x * math.cos(place) + y * math.sin(place) < -0.5:
            self.warn(
                robot.WHEEL_AXIS_MISALIGNED,
                f'the axis of joint "{joint}" points to the centre of the robot, so positive '
                "commands turn the wheel in the opposite direction",
                at=described.origin,
                values={"joint": joint, "axis": "inwards"},
            )

    def _drive(self, command: Vec3, time_ns: int, seconds: float) -> None:  # noqa: ARG002
        self._wheels.command(command)
