"""The topics and services of gazebo_ros's API plugin."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from cartwheel.errors import CartwheelError
from cartwheel.gazebo.entities import Entities
from cartwheel.gazebo.forces import Pushes
from cartwheel.gazebo.metrics import Metrics
from cartwheel.gazebo.physics import Physics
from cartwheel.gazebo.properties import Properties
from cartwheel.gazebo.reconfigure import PhysicsReconfigure
from cartwheel.gazebo.requests import REPORTED, answering, camel
from cartwheel.gazebo.spawning import Spawning
from cartwheel.gazebo.state import StateCommands, States, StateTopics
from cartwheel.graph import Service
from cartwheel.reporting import Reporter
from cartwheel.session import Session

NODE = "gazebo"


class GazeboApi:
    """Advertises ``/gazebo/…`` on a session's graph, as Gazebo does.

    A failed request returns ``success`` false with the reason, and never has partial effects.
    Source: gazebo_ros, gazebo_ros_api_plugin.

    Args:
        session: The session.
        package_path: Folders to search first for packages of spawned models.
    """

    def __init__(self, session: Session, *, package_path: Sequence[Path] = ()) -> None:
        self._session = session
        simulation = session.simulation
        self._tell = Reporter(simulation.report, REPORTED)
        entities = Entities(simulation)
        self._states = States(simulation, entities)
        self._physics = Physics(simulation)
        self._groups = (
            Spawning(session, entities, package_path),
            self._states,
            Properties(simulation, entities),
            self._physics,
            Pushes(simulation, entities),
        )
        self._services: list[Service] = []
        self._topics: list[StateTopics | StateCommands | Metrics | PhysicsReconfigure] = []

    def start(self) -> None:
        """Advertises all topics and services. Call it on the owner's thread, or before there is an
        owner.

        Raises:
            GraphError: A service already exists.
        """
        graph = self._session.graph
        try:
            for group in self._groups:
                for offer in group.offers():
                    self._services.append(
                        graph.serve(
                            f"/gazebo/{offer.name}",
                            offer.type,
                            answering(offer, self._tell, title=_title(offer.name)),
                            node=NODE,
                            threaded=offer.threaded,
                        )
                    )
            self._topics.append(StateTopics(self._session.simulation, graph, NODE))
            self._topics.append(StateCommands(self._states, graph, NODE, self._tell))
            self._topics.append(Metrics(self._session.simulation, graph, NODE))
            self._topics.append(PhysicsReconfigure(self._physics, graph, NODE, self._tell))
        except CartwheelError:
            self.close()
            raise

    def close(self) -> None:
        """Removes all topics and services."""
        for topic in self._topics:
            topic.close()
        for service in self._services:
            self._session.graph.withdraw(service)
        self._topics.clear()
        self._services.clear()


def _title(name: str) -> str:
    """The start of Gazebo's status messages."""
    if name.startswith("spawn_"):
        return "SpawnModel"
    return camel(name)
