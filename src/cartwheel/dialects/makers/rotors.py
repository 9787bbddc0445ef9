"""Plugins from rotors_simulator for multicopters: command relay and motor states."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.dialects.makers.motor_model import ACTUATORS, SLOWDOWN
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.messages import header, message_class

_ROTOR = "rotor_"


@dataclass(frozen=True, kw_only=True, slots=True)
class RotorsControllerParameters:
    command_topic: str = tag(
        "commandMotorSpeedSubTopic",
        default="command/motor_speed",
        doc="Topic of the Actuators commands, with the speeds of all motors.",
    )
    motor_topic: str = tag(
        "motorSpeedCommandPubTopic",
        default="gazebo/command/motor_speed",
        doc="Topic on which commands are relayed to the motors.",
    )
    attitude_topic: str = tag(
        "commandAttitudeThrustSubTopic",
        default="",
        doc="No effect, as in Gazebo: the plugin does not subscribe to this topic.",
    )
    rate_topic: str = tag(
        "commandRateThrustSubTopic",
        default="",
        doc="No effect, as in Gazebo: the plugin does not subscribe to this topic.",
    )
    imu_topic: str = tag(
        "imuSubTopic",
        default="",
        doc="No effect, as in Gazebo: the plugin does not subscribe to this topic.",
    )


class RotorsController(Plugin[RotorsControllerParameters]):
    """Relays motor speed commands to the motors.

    Original plugin: ``gazebo_controller_interface`` in the package ``rotors_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librotors_gazebo_controller_interface.so",)
    parameters: ClassVar[type] = RotorsControllerParameters

    def configure(self) -> None:
        self._Actuators = message_class(ACTUATORS)
        self._motors = self.advertise(self.config.motor_topic, ACTUATORS)
        self.subscribe(self.config.command_topic, ACTUATORS, self._on_command)

    def _on_command(self, message: Any) -> None:
        none = np.zeros(0)
        moment = header(self.part.time_ns, "")
        self._motors.publish(self._Actuators(moment, none, message.angular_velocities, none))


@dataclass(frozen=True, kw_only=True, slots=True)
class RotorsBaseParameters:
    link: str = tag("linkName", doc="Link that carries the propellers.")
    topic: str = tag(
        "motorPubTopic", default="motor_speed", doc="Topic of the speeds of the propellers."
    )
    joint_topic: str = tag(
        "jointStatePubTopic", default="joint_states", doc="Topic of the propeller joints' angles."
    )
    slowdown: float = tag(
        "rotorVelocitySlowdownSim",
        default=SLOWDOWN,
        doc="Speed of the propellers divided by the speed of their joints.",
    )


class RotorsBase(Plugin[RotorsBaseParameters]):
    """Publishes the speeds and angles of the propellers at every step.

    Propellers are the links named ``…rotor_<number>`` at movable joints of ``<linkName>``. Original
    plugin: ``gazebo_multirotor_base_plugin`` in the package ``rotors_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librotors_gazebo_multirotor_base_plugin.so",)
    parameters: ClassVar[type] = RotorsBaseParameters

    def configure(self) -> None:
        config, part, origin = self.config, self.part, self.tag.origin
        self.check_above_zero(rotorVelocitySlowdownSim=config.slowdown)
        part.link(config.link, origin=origin)
        joints = {}
        for joint in part.description.joints:
            _, mark, number = joint.child.partition(_ROTOR)
            if mark and number.isdigit() and joint.parent == config.link and joint.drivable:
                joints[int(number)] = part.joint(joint.name, origin=origin)
        self._joints = [joints[number] for number in sorted(joints)]
        self._frame = self.frame(config.link)
        self._Actuators = message_class(ACTUATORS)
        self._JointState = message_class("sensor_msgs/msg/JointState")
        self._speeds = self.advertise(config.topic, ACTUATORS)
        self._states = self.advertise(config.joint_topic, "sensor_msgs/msg/JointState")
        part.schedule(
            0, after=self._publish, active=lambda: self._speeds.wanted or self._states.wanted
        )

    def _publish(self) -> None:
        moment, none = header(self.part.time_ns, self._frame), np.zeros(0)
        if self._speeds.wanted:
            speeds = np.array([joint.velocity * self.config.slowdown for joint in self._joints])
            self._speeds.publish(self._Actuators(moment, none, speeds, none))
        if self._states.wanted:
            names = [joint.name for joint in self._joints]
            angles = np.array([joint.position for joint in self._joints])
            self._states.publish(self._JointState(moment, names, angles, none, none))
