"""``mecanum_drive_controller``: four wheels with rollers, for motion in all directions."""

from __future__ import annotations

import math
from typing import Any, ClassVar

from cartwheel.codes import devices, running
from cartwheel.devices.drives.limiter import Limiter
from cartwheel.devices.drives.rollers import has_rollers
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
from cartwheel.geometry import Vec3
from cartwheel.messages import header, zero
from cartwheel.messages.store import TWIN

_CORNERS = ("front_left", "front_right", "back_left", "back_right")
_ROS2_CORNERS = ("front_left", "front_right", "rear_left", "rear_right")
_STATE = f"control_msgs{TWIN}/msg/MecanumDriveControllerState"
_SIDEWAYS = (-1.0, 1.0, 1.0, -1.0)
_AROUND = (-1.0, 1.0, -1.0, 1.0)


class MecanumDriveController(Controller):
    """Turns four mecanum wheels as Twist commands require, and publishes odometry.

    If the wheels model rollers, friction moves the robot; see `has_rollers`. Otherwise a servo
    pushes it, as for gz-sim-mecanum-drive-system, provided that the controller's parameters are
    known when the robot is spawned. ROS 1 uses the topic ``cmd_vel``, ROS 2 ``reference``.
    Husarion's controller with the same name has different parameters and uses ``cmd_vel``. Source:
    mecanum_drive_controller; husarion_controllers.
    """

    types: ClassVar[tuple[str, ...]] = ("mecanum_drive_controller/MecanumDriveController",)

    def configure(self, settings: Settings) -> None:
        ros2 = self.rig.ros2
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
        self._wheels = [self.claim(name, "velocity") for name in names]
        names = [wheel.joint for wheel in self._wheels]
        for name in names:
            check_axis(self, name, LEFT)
        description = self.part.description
        nested = ros2 and not husarion
        radius = settings.optional_number("kinematics/wheels_radius" if nested else "wheel_radius")
        self._radius = radius or wheel_radius(description, names[0]) or 0.0
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
        self._reach = reach * settings.number("wheel_separation_multiplier", 1.0)
        self._radius *= settings.number("wheel_radius_multiplier", 1.0)
        if self._radius <= 0 or self._reach <= 0:
            raise settings.error(
                devices.CONTROLLER_PARAMETER_INVALID,
                "the wheel radius and separations must be positive "
                f"(got {self._radius:g} and {self._reach:g})",
                values={"radius": self._radius, "reach": self._reach},
            )
        offset = settings.section("kinematics/base_frame_offset")
        self._offset = tuple(offset.number(axis, 0.0) for axis in ("x", "y", "theta"))
        self._limiters = [
            Limiter(read_limits(settings.section(name)))
            for name in ("linear/x", "linear/y", "angular/z")
        ]
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
        self._turned = [0.0] * 4
        if self.rig.push is None and not has_rollers(description):
            self.warn(
                running.WHEELS_WITHOUT_ROLLERS,
                "the wheels do not model rollers, so the robot does not move sideways",
                hint="To push the robot with a servo instead, pass the controller's parameters "
                "when the robot is spawned.",
            )

    def start(self, time_ns: int) -> None:
        self._command.stop()
        for limiter in self._limiters:
            limiter.reset()
        self._odometry.start(time_ns)
        self._turned = [wheel.position for wheel in self._wheels]

    def update(self, time_ns: int, seconds: float) -> None:
        turned = [wheel.position for wheel in self._wheels]
        ways = [(new - old) * self._radius for new, old in zip(turned, self._turned, strict=True)]
        self._turned = turned
        across = sum(sign * way for sign, way in zip(_SIDEWAYS, ways, strict=True)) / 4
        around = sum(sign * way for sign, way in zip(_AROUND, ways, strict=True)) / 4
        self._reckon(sum(ways) / 4, across, around / self._reach, seconds)
        self._odometry.publish(time_ns)
        command = self._limited(self._command.at(time_ns), seconds)
        forward, sideways, turn = self._at_centre(command)
        for wheel, side, round_ in zip(self._wheels, _SIDEWAYS, _AROUND, strict=True):
            speed = forward + side * sideways + round_ * self._reach * turn
            wheel.command = speed / self._radius
        if self.rig.push is not None:
            forward, sideways, turn = command
            self.rig.push.command((forward, sideways, None), (None, None, turn))
        if self._state is not None and self._state.wanted:
            self._state.publish(self._state_message(time_ns, command))

    def _state_message(self, time_ns: int, command: Vec3) -> Any:
        message = zero(_STATE)
        message.header = header(time_ns, self._frame)
        for corner, wheel in zip(_CORNERS, self._wheels, strict=True):
            setattr(message, f"{corner}_wheel_velocity", wheel.velocity)
        reference = message.reference_velocity
        reference.linear.x, reference.linear.y, reference.angular.z = command
        return message

    def _limited(self, wanted: tuple[float, float, float], seconds: float) -> Vec3:
        x, y, turn = (
            limiter.step(command, seconds)
            for limiter, command in zip(self._limiters, wanted, strict=True)
        )
        return x, y, turn

    def _at_centre(self, command: Vec3) -> Vec3:
        """Returns the motion of the wheels' centre for a commanded motion of the base frame."""
        x, y, theta = self._offset
        forward, sideways, turn = command
        cos, sin = math.cos(theta), math.sin(theta)
        return (
            cos * forward - sin * sideways + y * turn,
            sin * forward + cos * sideways - x * turn,
            turn,
        )

    def _reckon(self, forward: float, sideways: float, turn: float, seconds: float) -> None:
        """Updates the odometry of the base frame from the motion of the wheels' centre."""
        x, y, theta = self._offset
        forward, sideways = forward - y * turn, sideways + x * turn
        cos, sin = math.cos(theta), math.sin(theta)
        self._odometry.reckoning.go(
            cos * forward + sin * sideways, turn, seconds, sideways=cos * sideways - sin * forward
        )

    def stop(self, time_ns: int) -> None:  # noqa: ARG002
        for wheel in self._wheels:
            wheel.command = 0.0
        if self.rig.push is not None:
            self.rig.push.command((0.0, 0.0, None), (None, None, 0.0))
