"""``steering_controllers_library``: ROS 2's Ackermann, bicycle and tricycle steering."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.devices.drives.steered_wheels import SteeredAxle, SteeredAxleConfig
from cartwheel.dialects.ros_control.controllers.odometry import wheel_odometry
from cartwheel.dialects.ros_control.controllers.twist_command import TwistCommand
from cartwheel.dialects.ros_control.controllers.wheel_controller import WheelController
from cartwheel.dialects.ros_control.controllers.wheels import (
    LEFT,
    UP,
    check_axis,
    joint_place,
)
from cartwheel.dialects.ros_control.hardware import JointHardware
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.geometry import Vec3
from cartwheel.messages import header, zero
from cartwheel.messages.store import TWIN

_STATE = f"control_msgs{TWIN}/msg/SteeringControllerStatus"


class SteeringController(WheelController):
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
    _wheels: SteeredAxle

    def configure(self, settings: Settings) -> None:
        front = settings.boolean("front_steering", True)
        driven_axle, steered_axle = ("rear", "front") if front else ("front", "rear")
        traction = settings.texts("traction_joints_names", []) or settings.texts(
            f"{driven_axle}_wheels_names"
        )
        steering = settings.texts("steering_joints_names", []) or settings.texts(
            f"{steered_axle}_wheels_names"
        )
        for names in (traction, steering):
            if len(names) not in (1, 2):
                raise settings.error(
                    devices.WHEELS_UNPAIRED,
                    f"an axle must have one or two wheels (got {len(names)})",
                    values={"wheels": len(names)},
                )
        driven = self._axle(traction, "velocity")
        steering_joints = self._axle(steering, "position")
        # The published state has the order of the parameter lists.
        self._listed = [[self.claims[name] for name in names] for names in (traction, steering)]
        self._state = self.advertise("controller_state", _STATE)
        for joint in steering_joints:
            check_axis(self, joint.joint, UP)
        for joint in driven:
            check_axis(self, joint.joint, LEFT)
        base = _positive(settings, "wheelbase")
        tracks = ("traction_track_width", "wheel_track", f"{driven_axle}_wheel_track")
        driven_track = _first(settings, tracks, len(traction) == 2)
        tracks = ("steering_track_width", "wheel_track", f"{steered_axle}_wheel_track")
        steered_track = _first(settings, tracks, len(steering) == 2)
        radii = (
            "traction_wheels_radius", "traction_wheel_radius", "wheels_radius",
            f"{driven_axle}_wheels_radius", f"{driven_axle}_wheel_radius",
        )  # fmt: skip
        radius = _first(settings, radii, True)
        settings.ignore(
            "front_wheels_radius", "rear_wheels_radius", "front_wheel_radius", "rear_wheel_radius",
            "front_wheel_track", "rear_wheel_track", "front_wheels_state_names",
            "rear_wheels_state_names", "traction_joints_state_names", "steering_joints_state_names",
            "reduce_wheel_speed_until_steering_reached",
        )  # fmt: skip
        open_loop = settings.boolean("open_loop", False)
        self._by_position = settings.boolean("position_feedback", False)
        config = SteeredAxleConfig(
            wheel_base=base,
            driven_track=driven_track,
            steered_track=steered_track,
            radius=radius,
            measures=(
                "nothing" if open_loop else "positions" if self._by_position else "velocities"
            ),
        )
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
        self._wheels = SteeredAxle(config, driven, steering_joints, self._odometry.reckoning)

    def _drive(self, command: Vec3, time_ns: int, seconds: float) -> None:  # noqa: ARG002
        forward, _, turn = command
        self._wheels.command(forward, turn)
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

    def _axle(self, names: Sequence[str], interface: str) -> list[JointHardware]:
        """Claims the wheels of an axle; returns the left one first."""
        claimed = [self.claim(name, interface) for name in names]
        return sorted(
            claimed, key=lambda joint: -joint_place(self.part.description, joint.joint)[1]
        )


def _positive(settings: Settings, name: str) -> float:
    value = settings.number(name)
    if value <= 0:
        raise settings.invalid(name, value, "positive")
    return value


def _first(settings: Settings, names: Sequence[str], needed: bool) -> float:
    """Returns the first of several parameters that is stated; 0 if none is, and none is needed."""
    for name in names:
        if settings.has(name):
            return _positive(settings, name)
    if needed:
        raise settings.missing(names[0])
    return 0.0
