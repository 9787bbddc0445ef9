"""What each robot is, for those who show it: ``/robot_description``."""

from __future__ import annotations

import re

from cartwheel.description.model import RobotDescription
from cartwheel.graph import Graph, Publisher
from cartwheel.messages import message_class
from cartwheel.simulation import Simulation

STRING = "std_msgs/msg/String"
TOPIC = "/robot_description"
"""Of a robot without a namespace."""
_RATE = 10.0
"""Hz of simulated time at which new models are looked for."""


class RobotDescriptions:
    """Publishes the expanded XML of each model that is a robot, latched.

    A topic is ``robot_description`` in the robot's namespace, as ROS's tools expect it; that of
    a further robot there is ``/<model>/robot_description``. One of these does for all who show
    robots: two would publish each of them twice. For the owner's thread.

    Args:
        simulation: Whose models.
        graph: To publish on.
    """

    def __init__(self, simulation: Simulation, graph: Graph) -> None:
        self._simulation = simulation
        self._graph = graph
        self._published: dict[str, tuple[RobotDescription, Publisher]] = {}
        self._version = -1
        self._look()
        self._task = simulation.schedule(_RATE, before=self._look)

    def topic(self, name: str) -> str | None:
        """Where a model is described; None where that is no robot."""
        self._look()
        found = self._published.get(name)
        return found[1].topic if found else None

    def close(self) -> None:
        """Takes them off the graph."""
        self._simulation.unschedule(self._task)
        for _, publisher in self._published.values():
            publisher.close()
        self._published.clear()

    def _look(self) -> None:
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

    def _publish(self, name: str, description: RobotDescription) -> Publisher:
        taken = {publisher.topic for _, publisher in self._published.values()}
        space = self._simulation.namespace(name).strip("/")
        topic = f"/{space}{TOPIC}" if space else TOPIC
        if topic in taken:
            topic = f"/{re.sub('[^0-9A-Za-z_]', '_', name)}{TOPIC}"
        publisher = self._graph.advertise(topic, STRING, node=name, qos="latched")
        publisher.publish(message_class(STRING)(data=description.text))
        return publisher


def is_robot(description: RobotDescription) -> bool:
    """Whether a model is more than a thing: it can move, and has joints, plugins or sensors."""
    if description.static or not description.text:
        return False
    sensing = any(link.sensors for link in description.links)
    return sensing or bool(description.plugins or description.joints)
