"""Plugins from rotors_simulator for multicopters: command relay and motor states."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.air.propeller_states import (
    PropellerStates,
    PropellerStatesConfig,
    SpeedRelay,
    SpeedRelayConfig,
)
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.propeller_tags import SLOWDOWN
from cartwheel.dialects.tags import SMALLEST, tag

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
    """Republishes the motor speed commands on the topic to which the motors subscribe.

    Original plugin: ``gazebo_controller_interface`` in the package ``rotors_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librotors_gazebo_controller_interface.so",)

    def configure(self) -> None:
        config = SpeedRelayConfig(
            command_topic=self.config.command_topic, output_topic=self.config.motor_topic
        )
        self.add(SpeedRelay(self.scope, config))


@dataclass(frozen=True, kw_only=True, slots=True)
class RotorsBaseParameters:
    link: str = tag("linkName", role="link", doc="Link that carries the propellers.")
    topic: str = tag(
        "motorPubTopic", default="motor_speed", doc="Topic of the propellers' speeds (Actuators)."
    )
    joint_topic: str = tag(
        "jointStatePubTopic",
        default="joint_states",
        doc="Topic of the propeller joints' angles (JointState).",
    )
    slowdown: float = tag(
        "rotorVelocitySlowdownSim",
        default=SLOWDOWN,
        least=SMALLEST,
        doc="Speed of the propellers divided by the speed of their joints.",
    )


class RotorsBase(Plugin[RotorsBaseParameters]):
    """Publishes the speeds and angles of the propellers at every simulation step.

    A link is a propeller if its name ends with ``rotor_<number>`` and a movable joint connects it
    to ``<linkName>``. Original plugin: ``gazebo_multirotor_base_plugin`` in the package
    ``rotors_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librotors_gazebo_multirotor_base_plugin.so",)

    def configure(self) -> None:
        config, part = self.config, self.part
        part.link(config.link, origin=self.origin)
        joints = {}
        for joint in part.description.joints:
            _, mark, number = joint.child.partition(_ROTOR)
            if mark and number.isdigit() and joint.parent == config.link and joint.drivable:
                joints[int(number)] = joint.name
        device = PropellerStatesConfig(
            joints=[joints[number] for number in sorted(joints)],
            speed_topic=config.topic,
            joint_topic=config.joint_topic,
            frame=config.link,
            slowdown=config.slowdown,
        )
        self.add(PropellerStates(self.scope, device))
