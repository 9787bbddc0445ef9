"""Steering drives: Ackermann, bicycle and tricycle, with the parameters of ROS 1 and ROS 2."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.devices.drives.limiter import Limiter
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.controllers.limits import read_limits
from cartwheel.dialects.ros_control.controllers.odometry import wheel_odometry
from cartwheel.dialects.ros_control.controllers.twist_command import TwistCommand
from cartwheel.dialects.ros_control.controllers.wheels import (
    LEFT,
    UP,
    check_axis,
    joint_place,
    wheel_radius,
)
from cartwheel.dialects.ros_control.hardware import JointHardware
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.messages import header, zero
from cartwheel.messages.store import TWIN

_STATE = f"control_msgs{TWIN}/msg/SteeringControllerStatus"


class SingleSteering(Controller):
    """One driven wheel and one steered joint, as in ROS 1.

    ``linear.x`` on ``cmd_vel`` is the speed, ``angular.z`` the steering angle. Source:
    ackermann_steering_controller and steer_drive_controller of ROS 1.
    """

    types: ClassVar[tuple[str, ...]] = ("steer_drive_controller/SteerDriveController",)

    def configure(self, settings: Settings) -> None:
        wheel = settings.text("rear_wheel", "rear_wheel_joint")
        steer = settings.text("front_steer", "front_steer_joint")
        self._wheel = self.claim(wheel, "velocity")
        self._steer = self.claim(steer, "position")
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
        self._base = base * settings.number("wheel_separation_h_multiplier", 1.0)
        self._radius = radius * settings.number("wheel_radius_multiplier", 1.0)
        angle = settings.number("steer_pos_multiplier", 1.0)
        self._angle = angle
        self._linear = Limiter(read_limits(settings.section("linear/x")))
        self._angular = Limiter(read_limits(settings.section("angular/z")))
        settings.ignore("allow_multiple_cmd_vel_publishers")
        self._open_loop = settings.boolean("open_loop", False)
        self._command = TwistCommand(
            self, "cmd_vel", timeout=settings.number("cmd_vel_timeout", 0.5)
        )
        self._odometry = wheel_odometry(
            self, settings, transform=settings.boolean("enable_odom_tf", True)
        )
        self._turned = 0.0

    def start(self, time_ns: int) -> None:
        self._command.stop()
        self._odometry.start(time_ns)
        self._linear.reset()
        self._angular.reset()
        self._turned = self._wheel.position

    def update(self, time_ns: int, seconds: float) -> None:
        angle = self._steer.position * self._angle
        turned = self._wheel.position
        way = (turned - self._turned) * self._radius
        self._turned = turned
        if self._open_loop:
            way, angle = self._linear.value * seconds, self._angular.value
        self._odometry.reckoning.go(way, way * math.tan(angle) / self._base, seconds)
        self._odometry.publish(time_ns)
        forward, _, steer = self._command.at(time_ns)
        forward = self._linear.step(forward, seconds)
        steer = self._angular.step(steer, seconds)
        self._wheel.command = forward / self._radius
        self._steer.command = steer

    def stop(self, time_ns: int) -> None:  # noqa: ARG002
        self._wheel.command = 0.0


class SteeringController(Controller):
    """Driven and steered wheels, as in ROS 2's steering_controllers_library.

    Commands arrive on ``reference`` (TwistStamped), or with ``use_stamped_vel: false`` on
    ``reference_unstamped`` (Twist). Of two wheels, the one with the larger y is the left one.
    Source: ackermann_steering_controller, bicycle_steering_controller,
    tricycle_steering_controller.
    """

    types: ClassVar[tuple[str, ...]] = (
        "ackermann_steering_controller/AckermannSteeringController",
        "bicycle_steering_controller/BicycleSteeringController",
        "tricycle_steering_controller/TricycleSteeringController",
    )

    def configure(self, settings: Settings) -> None:
        front = settings.boolean("front_steering", True)
        driven, steered = ("rear", "front") if front else ("front", "rear")
        traction = settings.texts("traction_joints_names", []) or settings.texts(
            f"{driven}_wheels_names"
        )
        steering = settings.texts("steering_joints_names", []) or settings.texts(
            f"{steered}_wheels_names"
        )
        for names in (traction, steering):
            if len(names) not in (1, 2):
                raise settings.error(
                    devices.WHEELS_UNPAIRED,
                    f"an axle must have one or two wheels (got {len(names)})",
                    values={"wheels": len(names)},
                )
        self._traction = self._axle(traction, "velocity")
        self._steering = self._axle(steering, "position")
        # The published state has the order of the parameter lists.
        self._listed = [[self.claims[name] for name in names] for names in (traction, steering)]
        self._state = self.advertise("controller_state", _STATE)
        for joint in self._steering:
            check_axis(self, joint.joint, UP)
        for joint in self._traction:
            check_axis(self, joint.joint, LEFT)
        self._base = self._positive(settings, "wheelbase")
        tracks = ("traction_track_width", "wheel_track", f"{driven}_wheel_track")
        self._traction_track = self._first(settings, tracks, len(traction) == 2)
        tracks = ("steering_track_width", "wheel_track", f"{steered}_wheel_track")
        self._steering_track = self._first(settings, tracks, len(steering) == 2)
        radii = (
            "traction_wheels_radius", "traction_wheel_radius", "wheels_radius",
            f"{driven}_wheels_radius", f"{driven}_wheel_radius",
        )  # fmt: skip
        self._radius = self._first(settings, radii, True)
        settings.ignore(
            "front_wheels_radius", "rear_wheels_radius", "front_wheel_radius", "rear_wheel_radius",
            "front_wheel_track", "rear_wheel_track", "front_wheels_state_names",
            "rear_wheels_state_names", "traction_joints_state_names", "steering_joints_state_names",
            "reduce_wheel_speed_until_steering_reached",
        )  # fmt: skip
        self._open_loop = settings.boolean("open_loop", False)
        self._by_position = settings.boolean("position_feedback", False)
        timeout = settings.number("reference_timeout", 1.0)
        stamped = settings.boolean("use_stamped_vel", True)
        topic = "reference" if stamped else "reference_unstamped"
        self._command = TwistCommand(self, topic, timeout=timeout, stamped=stamped)
        self._odometry = wheel_odometry(
            self,
            settings,
            topic="odometry",
            tf_topic="tf_odometry",
            transform=settings.boolean("enable_odom_tf", True),
        )
        self._commanded = (0.0, 0.0)
        self._turned = 0.0

    def start(self, time_ns: int) -> None:
        self._command.stop()
        self._odometry.start(time_ns)
        self._turned = self._rolled()
        self._commanded = (0.0, 0.0)

    def update(self, time_ns: int, seconds: float) -> None:
        self._reckon(seconds)
        self._odometry.publish(time_ns)
        forward, _, turn = self._command.at(time_ns)
        self._commanded = (forward, turn)
        angle = _steering_angle(forward, turn, self._base)
        speed = forward / self._radius
        if forward == 0 and turn != 0:
            speed = abs(turn) * self._base / self._radius
        self._steer(angle)
        self._drive(speed, angle)
        if self._state.wanted:
            self._state.publish(self._state_message(time_ns))

    def _state_message(self, time_ns: int) -> Any:
        """Returns positions or velocities of the wheels, depending on ``position_feedback``."""
        traction, steering = self._listed
        message = zero(_STATE)
        message.header = header(time_ns, "")
        if self._by_position:
            message.traction_wheels_position = np.array([each.position for each in traction])
        else:
            message.traction_wheels_velocity = np.array([each.velocity for each in traction])
        message.steer_positions = np.array([each.position for each in steering])
        message.linear_velocity_command = np.array([each.command for each in traction])
        message.steering_angle_command = np.array([each.command for each in steering])
        return message

    def stop(self, time_ns: int) -> None:  # noqa: ARG002
        for joint in self._traction:
            joint.command = 0.0

    def _axle(self, names: Sequence[str], interface: str) -> list[JointHardware]:
        """Claims the wheels of an axle; returns the left one first."""
        claimed = [self.claim(name, interface) for name in names]
        return sorted(
            claimed, key=lambda joint: -joint_place(self.part.description, joint.joint)[1]
        )

    def _steer(self, angle: float) -> None:
        if len(self._steering) == 1:
            self._steering[0].command = angle
            return
        sin, cos, half = math.sin(angle), math.cos(angle), self._steering_track / 2
        left, right = self._steering
        left.command = math.atan2(self._base * sin, self._base * cos - half * sin)
        right.command = math.atan2(self._base * sin, self._base * cos + half * sin)

    def _drive(self, speed: float, angle: float) -> None:
        # Speed difference of a wheel from the middle of the axle, as a fraction of the speed there.
        share = self._traction_track / 2 * math.tan(angle) / self._base
        if abs(math.cos(angle)) < 1e-6:
            share = 0.0
        if len(self._traction) == 1:
            self._traction[0].command = speed
            return
        left, right = self._traction
        left.command = speed * (1 - share)
        right.command = speed * (1 + share)

    def _reckon(self, seconds: float) -> None:
        if self._open_loop:
            forward, turn = self._commanded
            self._odometry.reckoning.go(forward * seconds, turn * seconds, seconds)
            return
        rolled = self._rolled()
        way = (rolled - self._turned) * self._radius
        self._turned = rolled
        if not self._by_position:
            mean = sum(joint.velocity for joint in self._traction) / len(self._traction)
            way = mean * self._radius * seconds
        tangent = sum(math.tan(self._middle(joint, side)) for side, joint in self._sides())
        self._odometry.reckoning.go(way, way * tangent / len(self._steering) / self._base, seconds)

    def _sides(self) -> list[tuple[float, JointHardware]]:
        if len(self._steering) == 1:
            return [(0.0, self._steering[0])]
        return [(-1.0, self._steering[0]), (1.0, self._steering[1])]

    def _middle(self, joint: JointHardware, side: float) -> float:
        """Converts a wheel's steering angle to that of a virtual wheel midway between them."""
        tangent = math.tan(joint.position)
        return math.atan(
            tangent * self._base / (self._base - side * tangent * self._steering_track / 2)
        )

    def _rolled(self) -> float:
        return sum(joint.position for joint in self._traction) / len(self._traction)

    @staticmethod
    def _positive(settings: Settings, name: str) -> float:
        value = settings.number(name)
        if value <= 0:
            raise settings.invalid(name, value, "positive")
        return value

    def _first(self, settings: Settings, names: Sequence[str], needed: bool) -> float:
        for name in names:
            if settings.has(name):
                return self._positive(settings, name)
        if needed:
            raise settings.missing(names[0])
        return 0.0


class TricycleController(Controller):
    """A front wheel that is driven and steered. Source: tricycle_controller."""

    types: ClassVar[tuple[str, ...]] = ("tricycle_controller/TricycleController",)

    def configure(self, settings: Settings) -> None:
        self._traction = self.claim(settings.text("traction_joint_name"), "velocity")
        self._steer = self.claim(settings.text("steering_joint_name"), "position")
        check_axis(self, self._traction.joint, LEFT)
        check_axis(self, self._steer.joint, UP)
        self._base = settings.number("wheelbase")
        self._radius = settings.number("wheel_radius")
        for name, value in (("wheelbase", self._base), ("wheel_radius", self._radius)):
            if value <= 0:
                raise settings.invalid(name, value, "positive")
        self._open_loop = settings.boolean("open_loop", False)
        traction, steering = settings.section("traction"), settings.section("steering")
        self._traction_limiter = Limiter(read_limits(traction))
        self._steering_rate = steering.number("max_velocity", math.inf)
        self._steering_range = (
            steering.number("min_position", -math.inf),
            steering.number("max_position", math.inf),
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
        self._angle = 0.0
        self._commanded = (0.0, 0.0)

    def start(self, time_ns: int) -> None:
        self._command.stop()
        self._odometry.start(time_ns)
        self._traction_limiter.reset()
        self._angle = self._steer.position
        self._turned = self._traction.position
        self._commanded = (0.0, 0.0)

    def update(self, time_ns: int, seconds: float) -> None:
        turned = self._traction.position
        rim = (turned - self._turned) * self._radius
        self._turned = turned
        angle = self._steer.position
        if self._open_loop:
            self._odometry.reckoning.go(
                self._commanded[0] * seconds, self._commanded[1] * seconds, seconds
            )
        else:
            self._odometry.reckoning.go(
                rim * math.cos(angle), rim * math.sin(angle) / self._base, seconds
            )
        self._odometry.publish(time_ns)
        forward, _, turn = self._command.at(time_ns)
        self._commanded = (forward, turn)
        wanted = _steering_angle(forward, turn, self._base)
        wanted = min(max(wanted, self._steering_range[0]), self._steering_range[1])
        if forward == 0:
            speed = abs(turn) * self._base / self._radius
        else:
            speed = forward / (self._radius * math.cos(wanted))
        # The speed is reduced while the wheel does not yet have the steering angle.
        off = abs(wanted - angle)
        speed *= 1.0 if off < math.pi / 6 else 0.01 if off > math.pi / 2 else math.cos(off)
        speed = self._traction_limiter.step(speed, seconds)
        most = self._steering_rate * seconds
        self._angle += min(max(wanted - self._angle, -most), most)
        self._traction.command = speed
        self._steer.command = self._angle

    def stop(self, time_ns: int) -> None:  # noqa: ARG002
        self._traction.command = 0.0


def _steering_angle(forward: float, turn: float, base: float) -> float:
    """Returns the steering angle of a single wheel in the middle, rad."""
    if forward == 0:
        return math.copysign(math.pi / 2, turn) if turn else 0.0
    return math.atan(turn * base / forward)
