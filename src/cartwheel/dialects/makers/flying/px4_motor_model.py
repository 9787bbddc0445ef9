"""``libgazebo_motor_model.so``: a propeller of PX4."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.air.propeller import ACTUATORS
from cartwheel.dialects.gz.bridge_file import gz_topic
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.propeller_tags import PropellerTags, add_propeller
from cartwheel.dialects.tags import SMALLEST, tag


@dataclass(frozen=True, kw_only=True, slots=True)
class Px4MotorParameters(PropellerTags):
    number: int = tag(
        "motorNumber",
        default=0,
        least=0,
        doc="Zero-based index of the motor in the command message.",
    )
    topic: str = tag(
        "commandSubTopic",
        default="/gazebo/command/motor_speed",
        doc="Topic of the Actuators commands, with speeds in rad/s. The model's name is prepended.",
    )
    fastest: float = tag(
        "maxRotVelocity",
        default=838.0,
        unit="rad/s",
        least=SMALLEST,
        doc="Maximum speed of the propeller.",
    )
    airspeed: float = tag(
        "maxRelativeAirspeed",
        default=25.0,
        unit="m/s",
        least=SMALLEST,
        doc="Axial airspeed at which the thrust becomes 0.",
    )
    reversible: bool = tag("reversible", default=False, doc="Whether the thrust can be negative.")


class Px4MotorModel(Plugin[Px4MotorParameters]):
    """Simulates a propeller for PX4, whose thrust decreases with the airspeed.

    Commands are received as mav_msgs/Actuators messages instead of through PX4's own protocol.
    Original plugin: ``gazebo_motor_model`` in ``PX4-SITL_gazebo-classic``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_motor_model.so",)

    def configure(self) -> None:
        config = self.config
        add_propeller(
            self,
            topic=gz_topic(f"{self.part.name}/{config.topic.strip('/')}"),
            message=ACTUATORS,
            # The direction of rotation changes the sign of the rolling moment, not of the thrust.
            thrust_sign="joint" if config.reversible else "up",
            max_airspeed=config.airspeed,
            signed_rolling=True,
        )
