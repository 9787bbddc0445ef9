"""``gz-sim-multicopter-motor-model-system``: a propeller."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.air.propeller import GZ_ACTUATORS
from cartwheel.dialects.gz.bridge_file import gz_topic
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.propeller_tags import PropellerTags, add_propeller, max_speed_tag
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class GzMotorParameters(PropellerTags):
    number: int = tag(
        "actuator_number",
        "motorNumber",
        least=0,
        doc="Zero-based index of the motor in the command message.",
    )
    topic: str = tag(
        "commandSubTopic",
        default="",
        doc="Topic of the Actuators commands, with speeds in rad/s. Its namespace is "
        "`<robotNamespace>`, or else the model's name.",
    )
    fastest: float = max_speed_tag()


def motor_topic(namespace: str, topic: str) -> str:
    """Returns the topic of a motor's commands.

    Args:
        namespace: ``<robotNamespace>``, or the model's name.
        topic: ``<commandSubTopic>``; may be empty.
    """
    return gz_topic(f"{namespace}/{topic.strip()}".rstrip("/"))


class GzMotorModel(Plugin[GzMotorParameters]):
    """Simulates the thrust, drag and rolling moment of a propeller.

    The thrust is proportional to the square of the propeller's speed. Original plugin:
    ``MulticopterMotorModel`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-multicopter-motor-model-system",)

    def configure(self) -> None:
        topic = motor_topic(self.namespace or self.part.name, self.config.topic)
        add_propeller(self, topic=topic, message=GZ_ACTUATORS)
