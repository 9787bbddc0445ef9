"""``libgazebo_ros_bumper.so``: contacts of collisions, with positions and forces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.description.model import Sensor
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import meant, suggestion
from cartwheel.geometry import Array
from cartwheel.messages import header, message_class
from cartwheel.simulation import Contact
from cartwheel.world.entry import scoped


@dataclass(frozen=True, kw_only=True, slots=True)
class BumperParameters:
    topic: str = tag(
        "bumperTopicName",
        "bumper_topic_name",
        default="bumper_states",
        doc="Topic of the ContactsState messages.",
    )
    frame: str = tag(
        "frameName",
        "frame_name",
        default="world",
        doc="Frame ID of the messages. The values are always in the world frame, as in Gazebo.",
    )
    update_rate: float = tag(
        "updateRate",
        "update_rate",
        default=0.0,
        unit="Hz",
        doc="Publish rate. 0: the sensor's `<update_rate>`.",
    )


class Bumper(Plugin[Any]):
    """Publishes the contacts of a sensor's collisions as ContactsState messages.

    Messages are also published without contact. The field ``states`` is then empty. Original
    plugin: ``gazebo_ros_bumper`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_bumper.so",)
    parameters: ClassVar[type] = BumperParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "contact"

    def configure(self) -> None:
        assert self.sensor is not None
        config: BumperParameters = self.config
        rate = config.update_rate or self.sensor.update_rate
        self.publish_on(config.topic, frame=config.frame, rate=rate)

    def publish_on(self, topic: str, *, frame: str, rate: float) -> None:
        """Resolves the collisions, advertises the topic and schedules the publisher.

        Args:
            topic: Name as in `advertise`.
            frame: Frame ID of the messages.
            rate: Hz; 0 publishes at every step.
        """
        assert self.sensor is not None
        self._collisions = watched_collisions(self, self.sensor)
        self._frame = self.frame(frame)
        self._ContactsState = message_class("gazebo_msgs/msg/ContactsState")
        self._ContactState = message_class("gazebo_msgs/msg/ContactState")
        self._Wrench = message_class("geometry_msgs/msg/Wrench")
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._publisher = self.advertise(topic, "gazebo_msgs/msg/ContactsState", rate=rate or None)
        self.part.schedule(rate, after=self._publish, active=lambda: self._publisher.wanted)

    def _publish(self) -> None:
        pairs: dict[tuple[str, str], list[Contact]] = {}
        for contact in self.part.contacts(self._collisions):
            pairs.setdefault((contact.first, contact.second), []).append(contact)
        states = [
            self._state(first, second, pairs[first, second]) for first, second in sorted(pairs)
        ]
        self._publisher.publish(
            self._ContactsState(header=header(self.part.time_ns, self._frame), states=states)
        )

    def _state(self, first: str, second: str, contacts: list[Contact]) -> Any:
        force = np.sum([contact.force for contact in contacts], axis=0)
        torque = np.sum([contact.torque for contact in contacts], axis=0)
        return self._ContactState(
            info=f"{first} touches {second} at {self.part.seconds:.6f} s",
            collision1_name=first,
            collision2_name=second,
            wrenches=[self._wrench(contact.force, contact.torque) for contact in contacts],
            total_wrench=self._wrench(force, torque),
            contact_positions=[self._vector(contact.position) for contact in contacts],
            contact_normals=[self._vector(contact.normal) for contact in contacts],
            depths=np.array([contact.depth for contact in contacts]),
        )

    def _wrench(self, force: Array, torque: Array) -> Any:
        return self._Wrench(force=self._vector(force), torque=self._vector(torque))

    def _vector(self, values: Array) -> Any:
        x, y, z = values.tolist()
        return self._Vector3(x=x, y=y, z=z)


def watched_collisions(plugin: Plugin[Any], sensor: Sensor) -> set[str]:
    """Returns ``link::collision`` for each collision of a contact sensor.

    All of Gazebo's spellings are accepted. Unknown names are reported.
    """
    spellings: dict[str, str] = {}
    for link in plugin.part.description.links:
        for collision in link.collisions:
            for name in (*collision.aliases, collision.name):
                spellings[name] = scoped(link.name, collision.name)
            spellings[scoped(link.name, collision.name)] = scoped(link.name, collision.name)
    collisions = set()
    for wanted in sensor.collisions:
        name = wanted.strip()
        bare = name.rsplit("::", 1)[-1]
        if name in spellings or bare in spellings:
            collisions.add(spellings.get(name) or spellings[bare])
        else:
            plugin.warn(
                devices.CONTACT_COLLISION_UNKNOWN,
                f'the collision "{name}" of contact sensor "{sensor.name}" does not exist, so its '
                "contacts are not reported",
                hint=suggestion(name, spellings),
                values={
                    "sensor": sensor.name,
                    "collision": name,
                    "meant": meant(name, spellings),
                },
            )
    if not sensor.collisions:
        plugin.warn(
            devices.SENSOR_INCOMPLETE,
            f'contact sensor "{sensor.name}" has no <collision>, so it never reports a contact',
            values={"sensor": sensor.name, "missing": "collision"},
        )
    return collisions
