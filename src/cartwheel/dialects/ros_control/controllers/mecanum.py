"""``mecanum_drive_controller``: four wheels with rollers, for motion in all directions."""

from __future__ import annotations

from typing import Any, ClassVar

from cartwheel.codes import devices, running
from cartwheel.devices.drives.mecanum import MecanumWheels, MecanumWheelsConfig
from cartwheel.devices.drives.rollers import has_rollers
from cartwheel.dialects.ros_control.controllers.limits import read_limits
from cartwheel.dialects.ros_control.controllers.odometry import wheel_odometry
from cartwheel.dialects.ros_control.controllers.twist_command import TwistCommand
from cartwheel.dialects.ros_control.controllers.wheel_controller import WheelController
from cartwheel.dialects.ros_control.controllers.wheels import (
    LEFT,
    check_axis,
    frame_prefix,
    joint_place,
    wheel_radius,
)
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.geometry import Vec3
from cartwheel.messages import header, zero
from cartwheel.messages.store import TWIN

_CORNERS = ("front_left", "front_right", "back_left", "back_right")
_ROS2_CORNERS = ("front_left", "front_right", "rear_left", "rear_right")
_STATE = f"control_msgs{TWIN}/msg/MecanumDriveControllerState"


class MecanumDriveController(WheelController):
    """Turns four mecanum wheels as Twist commands require, and publishes odometry.

    If the wheels model rollers, friction moves the robot; see `has_rollers`. Otherwise a servo
    pushes it, as for gz-sim-mecanum-drive-system, provided that the controller's parameters are
    known when the robot is spawned. ROS 1 uses the topic ``cmd_vel``, ROS 2 ``reference``.
    Husarion's controller with the same name has different parameters and uses ``cmd_vel``. Source:
    mecanum_drive_controller; husarion_controllers.
    """

    types: ClassVar[tuple[str, ...]] = ("mecanum_drive_controller/MecanumDriveController",)
    _wheels: MecanumWheels

    def configure(self, settings: Settings) -> None:
        ros2 = self.robot.ros2
        husarion = ros2 and settings.has("front_left_wheel_name")
        names = []
        for corner, plain in zip(_ROS2_CORNERS, _CORNERS, strict=True):
            if husarion:
                names.append(settings.text(f"{corner}_wheel_name"))
            elif ros2:
                names.append(settings.text(f"{corner}_wheel_command_joint_name"))
                settings.ignore(f"{corner}_wheel_state_joint_name")
            else:
                names.append(settings.text(f"{plain}_wheel_joint", f"{plain}_wheel_joint"))
        self._joints = [self.claim(name, "velocity") for name in names]
        names = [wheel.joint for wheel in self._joints]
        for name in names:
            check_axis(self, name, LEFT)
        description = self.part.description
        nested = ros2 and not husarion
        stated = settings.optional_number("kinematics/wheels_radius" if nested else "wheel_radius")
        radius = stated or wheel_radius(description, names[0]) or 0.0
        reach = (
            settings.optional_number("kinematics/sum_of_robot_center_projection_on_X_Y_axis")
            if nested
            else None
        )
        if not reach:
            along = [joint_place(description, name)[0] for name in names]
            across = [joint_place(description, name)[1] for name in names]
            x = settings.number("wheel_separation_x", max(along) - min(along))
            y = settings.number("wheel_separation_y", max(across) - min(across))
            if husarion:
                x *= settings.number("wheel_separation_x_multiplier", 1.0)
                y *= settings.number("wheel_separation_y_multiplier", 1.0)
            reach = (x + y) / 2
        reach *= settings.number("wheel_separation_multiplier", 1.0)
        radius *= settings.number("wheel_radius_multiplier", 1.0)
        if radius <= 0 or reach <= 0:
            raise settings.error(
                devices.CONTROLLER_PARAMETER_INVALID,
                f"the wheel radius and separations must be positive (got {radius:g} and {reach:g})",
                values={"radius": radius, "reach": reach},
            )
        offset = settings.section("kinematics/base_frame_offset")
        config = MecanumWheelsConfig(
            radius=radius,
            reach=reach,
            offset=(offset.number("x", 0.0), offset.number("y", 0.0), offset.number("theta", 0.0)),
            limits=(
                read_limits(settings.section("linear/x")),
                read_limits(settings.section("linear/y")),
                read_limits(settings.section("angular/z")),
            ),
        )
        stamped = ros2 and settings.boolean("use_stamped_vel", True)
        topic = "reference" if nested else "cmd_vel"
        if ros2 and not stamped:
            topic += "_unstamped"
        # In ROS 2, commands do not expire by default.
        limit = ("reference_timeout", 0.0) if nested else ("cmd_vel_timeout", 0.5)
        timeout = settings.number(*limit)
        self._command = TwistCommand(self, topic, timeout=timeout, stamped=stamped)
        prefix = frame_prefix(self, settings) if ros2 else ""
        self._odometry = wheel_odometry(
            self,
            settings,
            topic="odometry" if nested else "odom",
            tf_topic="tf_odometry" if nested else "/tf",
            transform=settings.boolean("enable_odom_tf", True),
            prefix=prefix,
        )
        self._frame = prefix + settings.text("odom_frame_id", "odom")
        self._state = self.advertise("controller_state", _STATE) if nested else None
        if husarion:
            # No effect: wheel positions are always measured, and their changes published as
            # odometry.
            settings.ignore("position_feedback")
            for name in ("open_loop", "publish_limited_velocity"):
                if settings.boolean(name, False):
                    self.warn(
                        devices.CONTROLLER_PARAMETER_UNKNOWN,
                        f'the parameter "{name}" has no effect',
                        values={"parameters": (name,)},
                    )
        wheels = [(joint,) for joint in self._joints]
        self._wheels = MecanumWheels(config, wheels, self.robot.push, self._odometry.reckoning)
        if self.robot.push is None and not has_rollers(description):
            self.warn(
                running.WHEELS_WITHOUT_ROLLERS,
                "the wheels do not model rollers, so the robot does not move sideways",
                hint="Load the controller's parameters before the robot is spawned: Cartwheel then "
                "moves the whole robot at the commanded velocity.",
            )

    def start(self, time_ns: int) -> None:
        super().start(time_ns)
        self._wheels.measure(0.0)

    def _drive(self, command: Vec3, time_ns: int, seconds: float) -> None:
        command = self._wheels.command(command, seconds)
        if self._state is not None and self._state.wanted:
            self._state.publish(self._state_message(time_ns, command))

    def _state_message(self, time_ns: int, command: Vec3) -> Any:
        message = zero(_STATE)
        message.header = header(time_ns, self._frame)
        for corner, wheel in zip(_CORNERS, self._joints, strict=True):
            setattr(message, f"{corner}_wheel_velocity", wheel.velocity)
        reference = message.reference_velocity
        reference.linear.x, reference.linear.y, reference.angular.z = command
        return message
