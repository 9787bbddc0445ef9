"""``gz-sim-touchplugin-system``: reports that a model has touched another one for some time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.devices.contact.touch import Touch, TouchConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.contact import read_collisions
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class TouchParameters:
    target: str = tag(
        "target",
        doc="Part of the name `model::link::collision` of the collision that must be touched, such "
        "as the name of a model.",
    )
    seconds: float = tag(
        "time",
        unit="s",
        least=0.0,
        doc="Time for which the target must be touched without a pause.",
    )
    space: str = tag(
        "namespace",
        doc="Namespace of the topic `/<namespace>/touched` and of the service "
        "`/<namespace>/enable`.",
    )
    enabled: bool = tag(
        "enabled", default=False, doc="Whether the plugin is enabled when the simulation starts."
    )


class TouchPlugin(Plugin[TouchParameters]):
    """Publishes `true` once when the model has touched a target for some time.

    The contacts are those of the model's contact sensors. Afterwards, the plugin is disabled until
    the service enables it again. Original plugin: ``TouchPlugin`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-touchplugin-system",)

    def configure(self) -> None:
        config = self.config
        collisions: frozenset[str] = frozenset()
        for link in self.part.description.links:
            for sensor in link.sensors:
                if sensor.type == "contact":
                    collisions |= read_collisions(self, sensor)
        if not collisions:
            self.warn(
                devices.PLUGIN_IDLE,
                "the model has no contact sensor, so it notices no contact",
                at=self.tag.origin,
            )
        space = f"/{config.space.strip().strip('/')}"
        self.add(
            Touch(
                self.scope,
                TouchConfig(
                    collisions=collisions,
                    target=config.target.strip(),
                    seconds=config.seconds,
                    topic=f"{space}/touched",
                    service=f"{space}/enable",
                    enabled=config.enabled,
                ),
            )
        )
