"""The topics and services of gazebo_ros's API plugin."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.gazebo.entities import Entities
from cartwheel.gazebo.forces import Pushes
from cartwheel.gazebo.metrics import Metrics
from cartwheel.gazebo.physics import Physics
from cartwheel.gazebo.properties import Properties
from cartwheel.gazebo.reconfigure import PhysicsReconfigure
from cartwheel.gazebo.requests import Answer, Offer
from cartwheel.gazebo.spawning import Spawning
from cartwheel.gazebo.state import StateCommands, States, StateTopics
from cartwheel.graph import Service
from cartwheel.messages import zero
from cartwheel.session import Session

NODE = "gazebo"
_REMEMBERED = 200
"""Failures on topics that are told once each; further ones are not told."""


class GazeboApi:
    """Offers ``/gazebo/…`` on a session's graph, as a running Gazebo does.

    A request that cannot be met is answered with ``success`` false and the reason; it never
    changes anything by half. Source: gazebo_ros, gazebo_ros_api_plugin.

    Args:
        session: To act on.
        package_path: Folders in which the packages of spawned models are looked for first.
    """

    def __init__(self, session: Session, *, package_path: Sequence[Path] = ()) -> None:
        self._session = session
        simulation = session.simulation
        entities = Entities(simulation)
        self._states = States(simulation, entities)
        self._physics = Physics(simulation)
        self._groups = (
            Spawning(session, entities, package_path),
            self._states,
            Properties(simulation, entities),
            self._physics,
            Pushes(simulation, entities, self._tell),
        )
        self._services: list[Service] = []
        self._topics: list[StateTopics | StateCommands | Metrics | PhysicsReconfigure] = []
        self._told: set[str] = set()

    def start(self) -> None:
        """Advertises everything; on the owner's thread, or before there is one.

        Raises:
            GraphError: Something of it is offered already.
        """
        graph = self._session.graph
        try:
            for group in self._groups:
                for offer in group.offers():
                    self._services.append(
                        graph.serve(
                            f"/gazebo/{offer.name}",
                            offer.type,
                            self._answering(offer),
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
        """Takes everything off the graph."""
        for topic in self._topics:
            topic.close()
        for service in self._services:
            self._session.graph.withdraw(service)
        self._topics.clear()
        self._services.clear()

    def _answering(self, offer: Offer) -> Callable[[Any], Any]:
        """A handler that answers in any case."""
        title = "".join(word.capitalize() for word in offer.name.split("_"))
        if offer.name.startswith("spawn_"):
            title = "SpawnModel"
        response_type = f"{offer.type}_Response"

        def handle(request: Any) -> Any:
            response = zero(response_type)
            try:
                answer = offer.handler(request)
            except CartwheelError as error:
                return self._failed(response, f"{title}: {_explained(error)}")
            except Exception as error:  # noqa: BLE001 - the caller waits for an answer
                text = f"{title}: {type(error).__name__}: {error}"
                self._session.simulation.post(lambda: self._tell(text))
                return self._failed(response, text)
            return _filled(response, answer)

        return handle

    def _failed(self, response: Any, text: str) -> Any:
        if hasattr(response, "success"):
            response.success = False
            response.status_message = text
        else:
            self._session.simulation.post(lambda: self._tell(text))
        return response

    def _tell(self, message: str) -> None:
        """Reports a failure that no answer tells; each once, however often it is repeated."""
        if message in self._told or len(self._told) >= _REMEMBERED:
            return
        self._told.add(message)
        self._session.simulation.engine.report(
            Diagnostic(severity="warning", message=message.strip())
        )


def _filled(response: Any, answer: Answer) -> Any:
    for name, value in answer.fields.items():
        setattr(response, name, value)
    if hasattr(response, "success"):
        response.success = True
        response.status_message = "; ".join((answer.status, *answer.notes))
    return response


def _explained(error: CartwheelError) -> str:
    """An error in one line, with its place and what to do."""
    place = f"{error.origin}: " if error.origin else ""
    return f"{place}{error.message}{f'. {error.hint}' if error.hint else ''}"
