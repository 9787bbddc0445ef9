"""``gz-sim-spacecraft-thruster-model-system``: a thruster of a spacecraft."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.air.pulsed_thruster import PulsedThruster, PulsedThrusterConfig
from cartwheel.dialects.gz.bridge_file import namespaced
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class SpacecraftThrusterParameters:
    link: str = tag(
        "link_name",
        role="link",
        doc="Link of the nozzle. The thrust acts at its centre of mass, along its z axis.",
    )
    number: int = tag(
        "actuator_number",
        default=0,
        least=0,
        doc="Zero-based index of the thruster in the command message.",
    )
    thrust: float = tag("max_thrust", default=0.0, unit="N", doc="Thrust while the valve is open.")
    frequency: float = tag(
        "duty_cycle_frequency", default=10.0, unit="Hz", doc="Number of pulses in a second."
    )
    topic: str = tag(
        "topic", default="", doc="Namespace of the commands. Default: the name of the model."
    )
    sub_topic: str = tag(
        "sub_topic",
        default="",
        doc="Topic of the commands (Actuators) in `<topic>`, which is the topic without it. "
        "`normalized` contains the duty cycles of all thrusters, from 0 to 1.",
    )


def valve_topic(model: str, namespace: str, config: SpacecraftThrusterParameters) -> str:
    """Returns the topic of the commands.

    Args:
        model: Name of the model.
        namespace: Namespace in which the model was spawned.
        config: The tags.
    """
    spawned = namespace.strip("/")
    space = config.topic.strip().strip("/") or spawned or model
    topic = f"/{space}/{config.sub_topic.strip().strip('/')}".rstrip("/")
    return namespaced(topic, spawned)


class SpacecraftThrusterSystem(Plugin[SpacecraftThrusterParameters]):
    """Applies the thrust of a valve that opens for a part of each cycle.

    Original plugin: ``SpacecraftThrusterModel`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-spacecraft-thruster-model-system",)

    def configure(self) -> None:
        config = self.config
        self.check_above_zero(duty_cycle_frequency=config.frequency)
        self.add(
            PulsedThruster(
                self.scope,
                PulsedThrusterConfig(
                    link=config.link.strip(),
                    topic=valve_topic(self.part.name, self.part.namespace, config),
                    number=config.number,
                    thrust=config.thrust,
                    frequency=config.frequency,
                ),
            )
        )
