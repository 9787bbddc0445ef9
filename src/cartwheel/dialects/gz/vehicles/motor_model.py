"""``gz-sim-multicopter-motor-model-system``: a propeller."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.description.model import Element
from cartwheel.devices.air.propeller import GZ_ACTUATORS
from cartwheel.dialects.gz.bridge_file import namespaced
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.propeller_tags import PropellerTags, add_propeller, max_speed_tag
from cartwheel.dialects.tags import tag
from cartwheel.simulation import Part


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


def motor_topic(part: Part, plugin: Element, topic: str) -> str:
    """Returns a topic of a motor, or of what controls motors.

    It is in the plugin's ``<robotNamespace>``, which is in the namespace in which the model was
    spawned. Without a ``<robotNamespace>``, it is in the latter or, without a namespace, in one
    with the model's name.

    Args:
        part: The model.
        plugin: The element of the plugin.
        topic: Last part of the topic; may be empty.
    """
    element = plugin.find("robotNamespace")
    stated = "" if element is None else element.text.strip()
    spawned = part.namespace.strip("/")
    space = stated or f"/{spawned or part.name}"
    return namespaced(f"{space}/{topic.strip()}".rstrip("/"), spawned)


class GzMotorModel(Plugin[GzMotorParameters]):
    """Simulates the thrust, drag and rolling moment of a propeller.

    The thrust is proportional to the square of the propeller's speed. Original plugin:
    ``MulticopterMotorModel`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-multicopter-motor-model-system",)

    def configure(self) -> None:
        topic = motor_topic(self.part, self.tag.element, self.config.topic)
        add_propeller(self, topic=topic, message=GZ_ACTUATORS)
