"""``steering_controllers_library``: ROS 2's Ackermann, bicycle and tricycle steering."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.devices.drives.steered_wheels import SteeredAxle, SteeredAxleConfig
from cartwheel.dialects.ros_control.controllers.odometry import (
    OdometryParameters,
    open_loop_parameter,
    position_feedback_parameter,
    wheel_odometry,
)
from cartwheel.dialects.ros_control.controllers.twist_command import TwistCommand
from cartwheel.dialects.ros_control.controllers.wheel_controller import WheelController
from cartwheel.dialects.ros_control.controllers.wheels import (
    LEFT,
    check_axes,
    check_steering,
    joint_axis,
    joint_place,
)
from cartwheel.dialects.ros_control.hardware import JointHardware
from cartwheel.dialects.ros_control.parameters import ignored, parameter
from cartwheel.geometry import Vec3
from cartwheel.messages import header, zero
from cartwheel.messages.store import TWIN

_STATE = f"control_msgs{TWIN}/msg/SteeringControllerStatus"
_SIDEWAYS = 0.5
"""Minimum cosine between a wheel's axis and the right of the robot at which it rolls backward."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SteeringParameters(OdometryParameters):
    front_steering: bool = parameter(
        "front_steering",
        default=True,
        role="front_steering",
        doc="The front axle is steered, and the rear axle driven; otherwise the reverse.",
    )
    traction: tuple[str, ...] = parameter(
        "traction_joints_names",
        "{driven}_wheels_names",
        role="joint",
        interface="velocity",
        doc="Joints of one or two driven wheels.",
    )
    steering: tuple[str, ...] = parameter(
        "steering_joints_names",
        "{steered}_wheels_names",
        role="joint",
        interface="position",
        doc="One or two steering joints.",
    )
    base: float = parameter(
        "wheelbase",
        unit="m",
        role="wheel_base",
        wheels=("steering", "traction"),
        positive=True,
        doc="Distance between the axles.",
    )
    driven_track: float = parameter(
        "traction_track_width",
        "wheel_track",
        "{driven}_wheel_track",
        default=0.0,
        unit="m",
        role="wheel_separation",
        wheels=("traction", "traction"),
        positive=True,
        doc="Distance between two driven wheels. Default: required for two wheels.",
    )
    steered_track: float = parameter(
        "steering_track_width",
        "wheel_track",
        "{steered}_wheel_track",
        default=0.0,
        unit="m",
        role="wheel_separation",
        wheels=("steering", "steering"),
        positive=True,
        doc="Distance between two steering joints. Default: required for two joints.",
    )
    radius: float = parameter(
        "traction_wheels_radius",
        "traction_wheel_radius",
        "wheels_radius",
        "{driven}_wheels_radius",
        "{driven}_wheel_radius",
        unit="m",
        role="wheel_radius",
        wheels=("traction",),
        positive=True,
        doc="Radius of the driven wheels.",
    )
    open_loop: bool = open_loop_parameter()
    position_feedback: bool = position_feedback_parameter(default=False)
    timeout: float = parameter(
        "reference_timeout", default=1.0, unit="s", doc="Time after which a reference expires."
    )
    stamped: bool = parameter(
        "use_stamped_vel",
        default=True,
        doc="Subscribe to TwistStamped on `reference` instead of Twist on `reference_unstamped`.",
    )
    unused: None = ignored(
        "front_wheels_radius", "rear_wheels_radius", "front_wheel_radius", "rear_wheel_radius",
        "front_wheel_track", "rear_wheel_track", "front_wheels_state_names",
        "rear_wheels_state_names", "traction_joints_state_names", "steering_joints_state_names",
        "reduce_wheel_speed_until_steering_reached",
    )  # fmt: skip


class SteeringController(WheelController):
    """Driven and steered wheels, as in ROS 2's steering_controllers_library.

    Commands arrive on ``reference`` (TwistStamped), or with ``use_stamped_vel: false`` on
    ``reference_unstamped`` (Twist). Of two wheels, the one with the larger y is the left one,
    unless the robot faces along negative x.
    Source: ackermann_steering_controller, bicycle_steering_controller,
    tricycle_steering_controller.
    """

    types: ClassVar[tuple[str, ...]] = (
        "ackermann_steering_controller/AckermannSteeringController",
        "bicycle_steering_controller/BicycleSteeringController",
        "tricycle_steering_controller/TricycleSteeringController",
    )
    _wheels: SteeredAxle

    parameters = SteeringParameters

    def configure(self, given: SteeringParameters) -> None:
        settings = self.settings
        traction, steering = given.traction, given.steering
        for names in (traction, steering):
            if len(names) not in (1, 2):
                raise settings.error(
                    devices.WHEELS_UNPAIRED,
                    f"an axle must have one or two wheels (got {len(names)})",
                    values={"wheels": len(names)},
                )
        claimed = [self.claim(name, "velocity") for name in traction]
        turned = [self.claim(name, "position") for name in steering]
        backward = self._faces_backward(traction, steering)
        self.faces_backward = backward
        driven = self._left_first(claimed, backward=backward)
        steering_joints = self._left_first(turned, backward=backward)
        # The published state has the order of the parameter lists.
        self._listed = [[self.claims[name] for name in names] for names in (traction, steering)]
        self._state = self.advertise("controller_state", _STATE)
        for joint in steering_joints:
            check_steering(self, joint.joint, traction[0], backward=backward)
        if not backward:
            check_axes(self, dict.fromkeys((joint.joint for joint in driven), LEFT))
        for name, track, wheels in (
            ("traction_track_width", given.driven_track, traction),
            ("steering_track_width", given.steered_track, steering),
        ):
            if len(wheels) == 2 and not track:
                raise settings.missing(name)
        self._by_position = given.position_feedback
        config = SteeredAxleConfig(
            wheel_base=given.base,
            driven_track=given.driven_track,
            steered_track=given.steered_track,
            radius=given.radius,
            measures=(
                "nothing" if given.open_loop else "positions" if self._by_position else "velocities"
            ),
        )
        topic = "reference" if given.stamped else "reference_unstamped"
        self._command = TwistCommand(self, topic, timeout=given.timeout, stamped=given.stamped)
        self._odometry = wheel_odometry(self, given, topic="odometry", tf_topic="tf_odometry")
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

    def _faces_backward(self, traction: Sequence[str], steering: Sequence[str]) -> bool:
        """Whether the robot faces along negative x.

        Its wheels roll there, and the wheels that are listed first, the right ones, are at the
        larger y.
        """
        description = self.part.description
        pairs = [names for names in (traction, steering) if len(names) == 2]
        return (
            bool(pairs)
            and all(float(joint_axis(description, name)[1]) < -_SIDEWAYS for name in traction)
            and all(
                joint_place(description, right)[1] > joint_place(description, left)[1]
                for right, left in pairs
            )
        )

    def _left_first(
        self, wheels: Sequence[JointHardware], *, backward: bool
    ) -> list[JointHardware]:
        """The wheels of an axle, the left one first."""
        return sorted(
            wheels,
            key=lambda joint: joint_place(self.part.description, joint.joint)[1],
            reverse=not backward,
        )
