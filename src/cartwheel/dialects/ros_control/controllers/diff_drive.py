"""``diff_drive_controller``: left and right wheels that follow Twist commands."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal

from cartwheel.codes import devices, robot, running
from cartwheel.devices.drives.differential import (
    DifferentialDrive,
    DifferentialDriveConfig,
    WheelPair,
)
from cartwheel.devices.drives.limiter import Limits
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.controllers.limits import read_limits
from cartwheel.dialects.ros_control.controllers.odometry import (
    open_loop_parameter,
    position_feedback_parameter,
    wheel_odometry,
)
from cartwheel.dialects.ros_control.controllers.twist_command import TwistCommand
from cartwheel.dialects.ros_control.controllers.wheels import (
    FramePrefixParameters,
    check_axes,
    faces_backward,
    frame_prefix,
    joint_place,
    leftward,
    wheel_radius,
)
from cartwheel.dialects.ros_control.parameters import ignored, parameter, ros2_parameter
from cartwheel.dialects.wheel_pairs import are_swapped
from cartwheel.messages import header, message_class


@dataclass(frozen=True, kw_only=True, slots=True)
class DiffDriveParameters(FramePrefixParameters):
    left: tuple[str, ...] = parameter(
        ros1=("left_wheel",),
        ros2=("left_wheel_names",),
        role="joint",
        interface="velocity",
        doc="Joints of the left wheels.",
    )
    right: tuple[str, ...] = parameter(
        ros1=("right_wheel",),
        ros2=("right_wheel_names",),
        role="joint",
        interface="velocity",
        doc="Joints of the right wheels.",
    )
    separation: float | None = parameter(
        "wheel_separation",
        default=None,
        unit="m",
        role="wheel_separation",
        wheels=("left", "right"),
        positive=True,
        doc="Distance between the left and right wheels. Default: read from the description.",
    )
    separation_factor: float = parameter(
        "wheel_separation_multiplier", default=1.0, doc="Factor on the wheel separation."
    )
    radius: float | None = parameter(
        "wheel_radius",
        default=None,
        unit="m",
        role="wheel_radius",
        wheels=("left", "right"),
        doc="Radius of the wheels. Default: read from the description.",
    )
    radius_factor: float = parameter(
        "wheel_radius_multiplier", default=1.0, doc="Factor on the radius of all wheels."
    )
    left_factor: float | None = parameter(
        "left_wheel_radius_multiplier",
        default=None,
        doc="Factor on the radius of the left wheels. Default: `wheel_radius_multiplier`.",
    )
    right_factor: float | None = parameter(
        "right_wheel_radius_multiplier",
        default=None,
        doc="Factor on the radius of the right wheels. Default: `wheel_radius_multiplier`.",
    )
    linear: Limits = parameter("linear/x", read=read_limits, doc="Limits of the forward speed.")
    angular: Limits = parameter("angular/z", read=read_limits, doc="Limits of the turning rate.")
    open_loop: bool = open_loop_parameter()
    position_feedback: bool = position_feedback_parameter(default=True)
    timeout: float = parameter(
        "cmd_vel_timeout", default=0.5, unit="s", doc="Time after which a command expires."
    )
    stamped: bool = ros2_parameter(
        "use_stamped_vel",
        default=True,
        doc="Subscribe to TwistStamped on `cmd_vel` instead of Twist on `cmd_vel_unstamped`.",
    )
    publish_limited: bool = parameter(
        ros1=("publish_cmd",),
        ros2=("publish_limited_velocity",),
        default=False,
        doc="Publish the limited command on `cmd_vel_out`.",
    )
    unused: None = ignored(
        "wheels_per_side",
        "allow_multiple_cmd_vel_publishers",
        "publish_wheel_joint_controller_state",
        "publish_wheel_data",
    )


class DiffDriveController(Controller):
    """Drives left and right wheels from Twist commands, and publishes odometry.

    Commands arrive on ``cmd_vel``: Twist in ROS 1, TwistStamped in ROS 2. With ``use_stamped_vel:
    false``, ROS 2 uses ``cmd_vel_unstamped`` (Twist). If the wheel separation or radius is not
    specified, it is read from the description. Source: diff_drive_controller.
    """

    types: ClassVar[tuple[str, ...]] = ("diff_drive_controller/DiffDriveController",)

    parameters = DiffDriveParameters
    _followed: tuple[float, float, float] | None = None
    """The command that the drive has received."""

    def configure(self, given: DiffDriveParameters) -> None:
        ros2, left, right = self.robot.ros2, given.left, given.right
        if not left or len(left) != len(right):
            raise self.settings.error(
                devices.WHEELS_UNPAIRED,
                "the numbers of left and right wheels must be equal and positive "
                f"(got {len(left)} and {len(right)})",
                values={"left": len(left), "right": len(right)},
            )
        pairs = list(zip(left, right, strict=True))
        claims = [self.claim(name, "velocity") for name in (*left, *right)]
        left_factor, right_factor = (
            given.radius_factor if each is None else each
            for each in (given.left_factor, given.right_factor)
        )
        first_left, first_right = claims[0].joint, claims[len(left)].joint
        x, y, z = leftward(self.part.description, first_left, first_right)
        joints = [each.joint for each in claims]
        sides = joints[: len(left)], joints[len(left) :]
        if not faces_backward(self.part.description, *sides):
            # A negative multiplier turns the wheels of a side in the other direction.
            senses = (left_factor,) * len(left) + (right_factor,) * len(right)
            axes = [(x, y, z) if sense >= 0 else (-x, -y, -z) for sense in senses]
            check_axes(self, dict(zip(joints, axes, strict=True)))
        if are_swapped(self.part.description, first_left, first_right):
            turns = (
                ", so the robot turns the wrong way" if min(left_factor, right_factor) > 0 else ""
            )
            self.warn(
                robot.WHEELS_SWAPPED,
                f'the left wheel ("{first_left}") is to the right of the right wheel '
                f'("{first_right}"){turns}',
                values={"left": first_left, "right": first_right},
            )
        separation = given.separation_factor * self._separation(given, first_left, first_right)
        radius = self._radius(given, first_left)
        topic = "cmd_vel_unstamped" if ros2 and not given.stamped else "cmd_vel"
        self._command = TwistCommand(
            self, topic, timeout=given.timeout, stamped=ros2 and given.stamped
        )
        self._odometry = wheel_odometry(self, given, prefix=frame_prefix(self, given))
        by_position = given.position_feedback
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
                            left_radius=radius * left_factor,
                            right_radius=radius * right_factor,
                        )
                        for one, other in pairs
                    ),
                    linear=given.linear,
                    angular=given.angular,
                    odometry="commands" if given.open_loop else measured,
                    measured_pairs=None,
                    drive=None,
                ),
                wheel_of=self.claims.__getitem__,
                reckoning=self._odometry.reckoning,
            )
        )
        self._limited = (
            self.advertise("cmd_vel_out", "geometry_msgs/msg/TwistStamped")
            if given.publish_limited
            else None
        )

    def start(self, time_ns: int) -> None:
        self._command.stop()
        self._followed = None
        self._odometry.start(time_ns)
        self._drive.start()

    def update(self, time_ns: int, seconds: float) -> None:
        drive, odometry = self._drive, self._odometry
        drive.measure(seconds)
        if time_ns >= odometry.periodic.next_ns:
            odometry.publish(time_ns)
        command = self._command.at(time_ns)
        if command is not self._followed:
            self._followed = command
            drive.command(*command)
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

    def _separation(self, given: DiffDriveParameters, left: str, right: str) -> float:
        description = self.part.description
        value = given.separation
        if value is None:
            value = math.dist(joint_place(description, left), joint_place(description, right))
        if value <= 0:
            raise self.settings.invalid("wheel_separation", value, "positive")
        return value

    def _radius(self, given: DiffDriveParameters, wheel: str) -> float:
        value = given.radius or wheel_radius(self.part.description, wheel)
        if value is None:
            raise self.settings.error(
                running.NOT_A_WHEEL,
                f'"wheel_radius" is missing, and the wheel of joint "{wheel}" has no cylinder from '
                "which to derive it",
                values={"parameter": "wheel_radius", "joint": wheel},
            )
        if value <= 0:
            raise self.settings.invalid("wheel_radius", value, "positive")
        return value
