"""Contact sensors in gz-sim, which need no plugin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.dialects.classic.bumper import Bumper
from cartwheel.dialects.gz.sensor_tags import default_topic
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class GzContactParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the ContactsState messages. Default: the topic in `<contact>`, or "
        "else `/world/<world>/model/<model>/link/<link>/sensor/<sensor>/contact`.",
    )


class GzContact(Bumper):
    """Publishes the contacts of a sensor's collisions as gazebo_msgs/ContactsState.

    Messages are also published without contact. The field ``states`` is then empty. Original
    plugin: ``Contact`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = GzContactParameters
    serves: ClassVar[tuple[str, ...]] = ("contact",)

    def configure(self) -> None:
        assert self.sensor is not None
        config = self.config
        assert isinstance(config, GzContactParameters)
        topic = (
            config.topic or self.sensor.topic or default_topic(self.part, self.sensor, "contact")
        )
        self.publish_on("/" + topic.lstrip("/"), frame="world", rate=self.sensor.update_rate)
