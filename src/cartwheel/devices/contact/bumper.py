"""Contact sensors that publish all contacts of their collisions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.component import Scope
from cartwheel.devices.topic_sensor import TopicSensor
from cartwheel.geometry import Array
from cartwheel.messages import Form, header, message_class
from cartwheel.simulation import Contact


@dataclass(frozen=True, kw_only=True, slots=True)
class BumperConfig:
    collisions: frozenset[str]
    """Collisions whose contacts are published, ``link::collision``."""
    topic: str
    """Topic of the ContactsState messages."""
    frame: str
    """Frame ID of the messages, without the robot's prefix. All values are in the world frame."""
    rate: float
    """Publish rate, Hz; 0: every step."""


class Bumper(TopicSensor):
    """Publishes the contacts of collisions, grouped by pairs of collisions.

    Messages are also published without contact. The field ``states`` is then empty.

    Args:
        scope: The model and its names.
        config: Collisions and topic.
    """

    def __init__(self, scope: Scope, config: BumperConfig) -> None:
        super().__init__(scope, config.frame, config.rate)
        self._collisions = config.collisions
        self._ContactsState = message_class("gazebo_msgs/msg/ContactsState")
        self._ContactState = message_class("gazebo_msgs/msg/ContactState")
        self._Wrench = message_class("geometry_msgs/msg/Wrench")
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._publisher = self._offer(config.topic, "gazebo_msgs/msg/ContactsState", qos="default")

        self._untouched = Form(self._template, "header.stamp")
        """Messages without contacts."""

    def _template(self) -> Any:
        return self._ContactsState(header=header(0, self._frame))

    def _measure(self) -> None:
        contacts = self.part.contacts(self._collisions)
        if not contacts:
            self._publisher.publish_values(self._untouched, (self.part.time_ns,))
            return
        pairs: dict[tuple[str, str], list[Contact]] = {}
        for contact in contacts:
            pairs.setdefault((contact.first, contact.second), []).append(contact)
        states = [
            self._state(first, second, pairs[first, second]) for first, second in sorted(pairs)
        ]
        self._publisher.publish(self._ContactsState(header=self._header(), states=states))

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
