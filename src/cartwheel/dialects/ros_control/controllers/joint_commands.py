"""Controllers that forward commands to joints, directly or through a PID controller."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import running
from cartwheel.devices.joints.pid import PidGains
from cartwheel.devices.joints.pid_joint import PidJoint, PidJointConfig
from cartwheel.dialects.ros_control.controller import NEVER_NS, Controller
from cartwheel.dialects.ros_control.gains import GAINS, read_gains
from cartwheel.dialects.ros_control.hardware import JointHardware
from cartwheel.dialects.ros_control.parameters import OWN, ignored, parameter, ros2_parameter
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.messages import header, message_class, zero

_FLOAT = "std_msgs/msg/Float64"


@dataclass(frozen=True, kw_only=True, slots=True)
class JointCommandParameters:
    joint: str = parameter("joint", role="joint", interface=OWN, doc="Joint.")


@dataclass(frozen=True, kw_only=True, slots=True)
class JointPidParameters(JointCommandParameters):
    gains: PidGains = parameter("pid", read=read_gains, role="gains", doc=GAINS)
    unused: None = ignored("pid")


@dataclass(frozen=True, kw_only=True, slots=True)
class JointGroupParameters:
    joints: tuple[str, ...] = parameter(
        "joints", "joint", role="joint", interface=OWN, doc="Joints, in the order of the commands."
    )
    interfaces: tuple[str, ...] = parameter(
        "interface_name",
        "interface_names",
        default=(),
        role="interface",
        doc="Interface of the commands, for types whose name contains none.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class JointGroupPidParameters(JointGroupParameters):
    gains: None = ignored("{joint}/pid", ros2=(), role="gains", doc=GAINS)
    ros2_gains: None = ros2_parameter("gains/{joint}", "{joint}/pid", default=None, doc=GAINS)


class JointCommand(Controller):
    """Forwards ``command`` (Float64) of one joint to the interface in the type's name.

    Source: forward_command_controller, ForwardCommandController.
    """

    types: ClassVar[tuple[str, ...]] = (
        "effort_controllers/JointEffortController",
        "velocity_controllers/JointVelocityController",
        "position_controllers/JointPositionController",
    )

    parameters = JointCommandParameters

    def configure(self, given: JointCommandParameters) -> None:
        interface = self.type.partition("_")[0]
        self._joint = self.claim(given.joint, interface)
        self.holds = interface != "effort"
        self._command = 0.0
        self.subscribe("command", _FLOAT, self._on_command)
        if interface == "position":
            self.accept_positions(lambda wanted, _: _publish_target(self, wanted))

    def start(self, time_ns: int) -> None:  # noqa: ARG002
        self._command = self._joint.command
        self.next_ns = 0

    def update(self, time_ns: int, seconds: float) -> None:  # noqa: ARG002
        self._joint.command = self._command
        self.next_ns = NEVER_NS

    def _on_command(self, message: Any) -> None:
        if math.isfinite(message.data):
            self._command = float(message.data)
            self.next_ns = 0


class JointPid(Controller):
    """Controls one joint with a PID whose output is an effort or a velocity.

    The topic ``command`` (Float64) sets the target; ``state`` is published. Source:
    effort_controllers and velocity_controllers.
    """

    types: ClassVar[tuple[str, ...]] = (
        "effort_controllers/JointPositionController",
        "effort_controllers/JointVelocityController",
        "velocity_controllers/JointPositionController",
    )

    parameters = JointPidParameters

    def configure(self, given: JointPidParameters) -> None:
        interface = self.type.partition("_")[0]
        by_position = self.type.endswith("JointPositionController")
        self._loop = PidJoint(
            self.claim(given.joint, interface),
            PidJointConfig(
                gains=given.gains,
                quantity="position" if by_position else "velocity",
                commands_effort=interface == "effort",
            ),
        )
        self.subscribe("command", _FLOAT, self._on_command)
        if by_position:
            self.accept_positions(lambda wanted, _: _publish_target(self, wanted))
        self._publisher = self.advertise("state", "control_msgs/msg/JointControllerState")
        self._count = 0
        self._State = message_class("control_msgs/msg/JointControllerState")

    def start(self, time_ns: int) -> None:  # noqa: ARG002
        self._loop.start()

    def update(self, time_ns: int, seconds: float) -> None:
        error, output = self._loop.update(seconds)
        self._count += 1
        # As in ros_control, every tenth update.
        if self._publisher.wanted and self._count % 10 == 1:
            joint, config = self._loop.joint, self._loop.config
            gains, by_position = config.gains, config.quantity == "position"
            self._publisher.publish(
                self._State(
                    header=header(time_ns, ""),
                    set_point=self._loop.target,
                    process_value=joint.position if by_position else joint.velocity,
                    process_value_dot=joint.velocity if by_position else 0.0,
                    error=error,
                    time_step=seconds,
                    command=output,
                    p=gains.p,
                    i=gains.i,
                    d=gains.d,
                    i_clamp=gains.i_max,
                    antiwindup=gains.stored == "limited error",
                )
            )

    def _on_command(self, message: Any) -> None:
        if math.isfinite(message.data):
            self._loop.target = float(message.data)


class JointGroup(Controller):
    """Forwards a Float64MultiArray to several joints: ``command``, or ``commands`` in ROS 2.

    Source: forward_command_controller.
    """

    types: ClassVar[tuple[str, ...]] = (
        "effort_controllers/JointGroupEffortController",
        "velocity_controllers/JointGroupVelocityController",
        "position_controllers/JointGroupPositionController",
        "forward_command_controller/ForwardCommandController",
        "forward_command_controller/MultiInterfaceForwardCommandController",
    )
    parameters: ClassVar[type] = JointGroupParameters

    def configure(self, given: Any) -> None:
        settings, names = self.settings, given.joints
        interface = self.type.partition("_")[0]
        if interface == "forward":
            if len(given.interfaces) != 1:
                raise settings.invalid(
                    "interface_names", list(given.interfaces), "a list of one interface"
                )
            interface = given.interfaces[0]
        if not names:
            raise settings.invalid("joints", names, "a list of at least one joint")
        self._joints: list[JointHardware] = [self.claim(name, interface) for name in names]
        self._loops = self.read_loops(settings)
        self.holds = interface != "effort" or bool(self._loops)
        self._commands: list[float] | None = None
        topic = "commands" if self.robot.ros2 else "command"
        self.subscribe(topic, "std_msgs/msg/Float64MultiArray", self._on_commands)
        if interface == "position" or self._loops:
            self.accept_positions(lambda wanted, _: self._publish_targets(topic, wanted))

    def read_loops(self, settings: Settings) -> list[PidJoint]:  # noqa: ARG002
        """Returns a PID controller for each joint; none if commands are forwarded."""
        return []

    def start(self, time_ns: int) -> None:  # noqa: ARG002
        self._commands = None
        self.next_ns = 0
        for loop in self._loops:
            loop.start()

    def update(self, time_ns: int, seconds: float) -> None:  # noqa: ARG002
        if self._loops:
            for loop in self._loops:
                loop.update(seconds)
            return
        if self._commands is not None:
            for joint, command in zip(self._joints, self._commands, strict=True):
                joint.command = command
        self.next_ns = NEVER_NS

    def _publish_targets(self, topic: str, wanted: Mapping[str, float]) -> None:
        values = np.array([wanted[joint.joint] for joint in self._joints])
        layout = zero("std_msgs/msg/MultiArrayLayout")
        self.publish_command(topic, "std_msgs/msg/Float64MultiArray", layout=layout, data=values)

    def _on_commands(self, message: Any) -> None:
        values = [float(value) for value in message.data]
        if len(values) != len(self._joints):
            self.warn(
                running.COMMAND_IGNORED,
                f"a command is ignored because it has {len(values)} values for "
                f"{len(self._joints)} joints",
                values={"got": len(values), "joints": len(self._joints)},
            )
        elif all(math.isfinite(value) for value in values):
            self._commands = values
            self.next_ns = 0
            for loop, value in zip(self._loops, values, strict=False):
                loop.target = value


class JointGroupPid(JointGroup):
    """Controls the positions of several joints with a PID for each. ``commands`` in ROS 2.

    Source: effort_controllers/JointGroupPositionController.
    """

    types = ("effort_controllers/JointGroupPositionController",)
    parameters = JointGroupPidParameters

    def read_loops(self, settings: Settings) -> list[PidJoint]:
        # ROS 2 files have the gains under the same key as for trajectory controllers.
        path = "gains/{}" if self.robot.ros2 and settings.raw("gains") else "{}/pid"
        sections = [settings.section(path.format(joint.name)) for joint in self._joints]
        settings.ignore("gains", *(joint.name for joint in self._joints))
        return [
            PidJoint(joint, PidJointConfig(gains=read_gains(section), quantity="position"))
            for joint, section in zip(self._joints, sections, strict=True)
        ]


def _publish_target(controller: Controller, wanted: Mapping[str, float]) -> None:
    """Commands the controller's only joint on its topic."""
    (value,) = wanted.values()
    controller.publish_command("command", _FLOAT, data=float(value))
