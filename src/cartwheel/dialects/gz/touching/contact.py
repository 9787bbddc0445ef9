"""Contact sensors in gz-sim, which need no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.contact.bumper import Bumper, BumperConfig
from cartwheel.dialects.gz.bridge_file import gz_spelling
from cartwheel.dialects.gz.sensor_tags import GzSensor
from cartwheel.dialects.sdf.contact import read_collisions
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class GzContactParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the ContactsState messages. Default: the topic in `<contact>`, or "
        "else `/world/<world>/model/<model>/link/<link>/sensor/<sensor>/contact`.",
    )


class GzContact(GzSensor[GzContactParameters]):
    """Publishes the contacts of a sensor's collisions as gazebo_msgs/ContactsState messages.

    Messages are also published while there is no contact. Their field ``states`` is then empty.
    Original plugin: ``Contact`` in gz-sim.
    """

    serves: ClassVar[tuple[str, ...]] = ("contact",)

    def configure(self) -> None:
        sensor = self.sensor
        topic = self.config.topic or sensor.topic or self.topic("contact")
        device = BumperConfig(
            collisions=read_collisions(self, sensor),
            topic=gz_spelling(topic),
            frame="world",
            rate=sensor.update_rate,
        )
        self.add(Bumper(self.scope, device))
