"""Publishes the descriptions of robots: ``/robot_description``."""

from __future__ import annotations

import re

from cartwheel.description.model import RobotDescription
from cartwheel.graph import Graph, Publisher
from cartwheel.messages import message_class
from cartwheel.session import Session
from cartwheel.simulation import Simulation

STRING = "std_msgs/msg/String"
NAME = "robot_description"
"""Last part of the names of all topics with descriptions."""
TOPIC = f"/{NAME}"
"""Topic of a robot without a namespace."""
_RATE = 10.0
"""Hz of simulated time at which new models are detected."""


class RobotDescriptions:
    """Publishes the expanded XML of each robot on a latched topic.

    The topic is ``robot_description`` in the robot's namespace, as ROS tools expect. Additional
    robots in the same namespace use ``/<model>/robot_description``. `hold_descriptions` provides
    the instance of a session: two instances would publish each description twice. Call all methods
    on the thread that owns the simulation.

    Args:
        simulation: The simulation that contains the models.
        graph: Graph on which the descriptions are published.
    """

    def __init__(self, simulation: Simulation, graph: Graph) -> None:
        self._simulation = simulation
        self._graph = graph
        self._published: dict[str, tuple[RobotDescription, Publisher]] = {}
        self._version = -1
        self.holders = 0
        """Number of calls of `hold_descriptions` without `release_descriptions`."""
        self.update()
        self._task = simulation.schedule(_RATE, before=self.update)

    def topic(self, name: str) -> str | None:
        """Returns the topic of a model's description; None if the model is not a robot."""
        self.update()
        entry = self._published.get(name)
        return entry[1].topic if entry else None

    def update(self) -> None:
        """Publishes new robots at once, which otherwise happens during the next run."""
        scene = self._simulation.scene
        if scene.version == self._version:
            return
        self._version = scene.version
        robots = {one.name: one.description for one in scene.models if is_robot(one.description)}
        for name in list(self._published):
            description, publisher = self._published[name]
            if robots.get(name) is not description:
                publisher.close()
                del self._published[name]
        for name, description in robots.items():
            if name not in self._published:
                self._published[name] = (description, self._publish(name, description))

    def close(self) -> None:
        """Stops publishing."""
        self._simulation.unschedule(self._task)
        for _, publisher in self._published.values():
            publisher.close()
        self._published.clear()

    def forget(self) -> None:
        """Clears the references of the tasks of a closed simulation."""
        self._task.forget()

    def _publish(self, name: str, description: RobotDescription) -> Publisher:
        taken = {publisher.topic for _, publisher in self._published.values()}
        space = self._simulation.namespace(name).strip("/")
        topic = f"/{space}{TOPIC}" if space else TOPIC
        if topic in taken:
            topic = f"/{re.sub('[^0-9A-Za-z_]', '_', name)}{TOPIC}"
        publisher = self._graph.advertise(topic, STRING, node=name, qos="latched")
        publisher.publish(message_class(STRING)(data=description.text))
        return publisher


def hold_descriptions(session: Session) -> RobotDescriptions:
    """Publishes the descriptions of a session's robots until they are released.

    Call it on the thread that owns the simulation.
    """
    held = session.descriptions
    if not isinstance(held, RobotDescriptions):
        session.descriptions = held = RobotDescriptions(session.simulation, session.graph)
    held.holders += 1
    held.update()
    return held


def release_descriptions(session: Session) -> None:
    """Ends one call of `hold_descriptions`. After the last one, nothing is published any more."""
    held = session.descriptions
    if isinstance(held, RobotDescriptions):
        held.holders -= 1
        if not held.holders:
            session.descriptions = None
            held.close()


def is_robot(description: RobotDescription) -> bool:
    """Whether a model is a robot: it is not static, and has joints, plugins or sensors."""
    if description.static or not description.text:
        return False
    sensing = any(link.sensors for link in description.links)
    return sensing or bool(description.plugins or description.joints)
