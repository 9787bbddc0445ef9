"""``libgazebo_ros_bumper.so``: contacts of collisions, with positions and forces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.contact import bumper
from cartwheel.dialects.plugin import SensorPlugin
from cartwheel.dialects.sdf.contact import read_collisions
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class BumperParameters:
    topic: str = tag(
        "bumperTopicName",
        "bumper_topic_name",
        default="bumper_states",
        role="topic",
        doc="Topic of the ContactsState messages.",
    )
    frame: str = tag(
        "frameName",
        "frame_name",
        default="world",
        role="frame",
        doc="Frame ID of the messages. The values are always in the world frame, as in Gazebo.",
    )
    update_rate: float = tag(
        "updateRate",
        "update_rate",
        default=0.0,
        unit="Hz",
        doc="Publish rate. If 0, the sensor's `<update_rate>` applies.",
    )


class Bumper(SensorPlugin[BumperParameters]):
    """Publishes the contacts of a sensor's collisions as ContactsState messages.

    Messages are also published while there is no contact. Their field ``states`` is then empty.
    Original plugin: ``gazebo_ros_bumper`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_bumper.so",)
    sensor_type: ClassVar[str] = "contact"

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        device = bumper.BumperConfig(
            collisions=read_collisions(self, sensor),
            topic=config.topic,
            frame=config.frame,
            rate=config.update_rate or sensor.update_rate,
        )
        self.add(bumper.Bumper(self.scope, device))
