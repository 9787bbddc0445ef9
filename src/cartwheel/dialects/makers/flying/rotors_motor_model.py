"""``librotors_gazebo_motor_model.so``: a propeller of rotors_simulator."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.air.propeller import ACTUATORS
from cartwheel.devices.air.propeller_states import PropellerJointState, PropellerJointStateConfig
from cartwheel.dialects.gz.bridge_file import gz_topic
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.propeller_tags import PropellerTags, add_propeller, max_speed_tag
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class RotorsMotorParameters(PropellerTags):
    number: int = tag(
        "motorNumber",
        default=0,
        least=0,
        doc="Zero-based index of the motor in the command message.",
    )
    topic: str = tag(
        "commandSubTopic",
        default="command/motor_speed",
        doc="Topic of the Actuators commands, with speeds in rad/s.",
    )
    speed_topic: str = tag(
        "motorSpeedPubTopic",
        default="motor_speed",
        doc="Topic of the joint's velocity in rad/s. The propeller's velocity is "
        "`<rotorVelocitySlowdownSim>` times larger.",
    )
    position_topic: str = tag(
        "motorPositionPubTopic",
        default="",
        doc="Topic of the joint's angle in rad. Not published if empty.",
    )
    fastest: float = max_speed_tag()


class RotorsMotorModel(Plugin[RotorsMotorParameters]):
    """Simulates the thrust, drag and rolling moment of a propeller.

    The thrust is proportional to the square of the propeller's speed. Wind is not simulated.
    Original plugin: ``gazebo_motor_model`` in the package ``rotors_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librotors_gazebo_motor_model.so",)

    def configure(self) -> None:
        config = self.config
        add_propeller(self, topic=config.topic, message=ACTUATORS)
        states = PropellerJointStateConfig(
            joint=config.joint,
            velocity_topic=self._state_topic(config.speed_topic),
            position_topic=self._state_topic(config.position_topic),
        )
        self.add(PropellerJointState(self.scope, states))

    def _state_topic(self, topic: str) -> str | None:
        # The topic ends with the motor's number, which is not a valid name in ROS 2.
        return gz_topic(f"{self.namespace}/{topic}") if topic else None
