"""The topics and services of gazebo_ros's ROS 2 branch."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from cartwheel.errors import CartwheelError, Diagnostic, UnknownNameError
from cartwheel.gazebo.entities import Entities
from cartwheel.gazebo.physics import Physics
from cartwheel.gazebo.requests import Answer, Offer
from cartwheel.gazebo.simulation_interfaces import SimulationInterfaces
from cartwheel.gazebo.spawning import Spawning
from cartwheel.gazebo.state import States, StateTopics
from cartwheel.graph import Service
from cartwheel.messages import header, message_class, zero
from cartwheel.session import Session

NODE = "gazebo"
_REMEMBERED = 200
"""Failures that no answer tells and that are told once each."""


class Ros2Api:
    """Offers what Gazebo offers in ROS 2, and simulation_interfaces.

    A request that cannot be met is answered with ``success`` false and, where the response has
    room for it, the reason; it never changes anything by half. Source: gazebo_ros 3,
    gazebo_ros_init, gazebo_ros_factory, gazebo_ros_state.

    Args:
        session: To act on.
        package_path: Folders in which the packages of spawned models are looked for first.
    """

    def __init__(self, session: Session, *, package_path: Sequence[Path] = ()) -> None:
        self._session = session
        self._simulation = session.simulation
        self._entities = Entities(session.simulation)
        self._spawning = Spawning(session, self._entities, package_path)
        self._states = States(session.simulation, self._entities)
        self._interfaces = SimulationInterfaces(
            session, self._entities, self._spawning, self._states, package_path
        )
        self._services: list[Service] = []
        self._topics: StateTopics | None = None
        self._told: set[str] = set()

    def start(self) -> None:
        """Advertises everything; on the owner's thread, or before there is one.

        Raises:
            GraphError: Something of it is offered already.
        """
        graph = self._session.graph
        try:
            for offer in self._offers():
                self._services.append(
                    graph.serve(
                        offer.name,
                        offer.type,
                        self._answering(offer),
                        node=NODE,
                        threaded=offer.threaded,
                    )
                )
            self._services += self._interfaces.start(NODE)
            self._topics = StateTopics(self._simulation, graph, NODE, prefix="")
        except CartwheelError:
            self.close()
            raise

    def close(self) -> None:
        """Takes everything off the graph."""
        if self._topics is not None:
            self._topics.close()
            self._topics = None
        self._interfaces.close()
        for service in self._services:
            self._session.graph.withdraw(service)
        self._services.clear()

    def _offers(self) -> list[Offer]:
        own = ("pause_physics", "unpause_physics", "reset_simulation", "reset_world")
        physics = [
            Offer(f"/{offer.name}", offer.type, offer.handler)
            for offer in Physics(self._simulation).offers()
            if offer.name in own
        ]
        package = "gazebo_msgs/srv"
        # gazebo_ros_state is loaded with a namespace by some worlds and without by others.
        states = [
            offer
            for prefix in ("", "/gazebo")
            for offer in (
                Offer(f"{prefix}/get_entity_state", f"{package}/GetEntityState", self._get_state),
                Offer(f"{prefix}/set_entity_state", f"{package}/SetEntityState", self._set_state),
            )
        ]
        return [
            *physics,
            Offer("/spawn_entity", f"{package}/SpawnEntity", self._spawn, threaded=True),
            Offer("/delete_entity", f"{package}/DeleteEntity", self._delete),
            Offer("/get_model_list", f"{package}/GetModelList", self._list_models),
            *states,
        ]

    def _spawn(self, request: Any) -> Answer:
        self._spawning.spawn_model(
            SimpleNamespace(
                model_name=request.name,
                model_xml=request.xml,
                robot_namespace=request.robot_namespace,
                initial_pose=request.initial_pose,
                reference_frame=request.reference_frame,
            )
        )
        return Answer(f"SpawnEntity: Successfully spawned entity [{request.name}]")

    def _delete(self, request: Any) -> Answer:
        try:
            self._spawning.delete_model(SimpleNamespace(model_name=request.name))
        except UnknownNameError:
            if not any(light.name == request.name for light in self._simulation.world.lights):
                raise
            self._spawning.delete_light(SimpleNamespace(light_name=request.name))
        return Answer(f"DeleteEntity: Successfully deleted entity [{request.name}]")

    def _list_models(self, _: Any) -> Answer:
        fields = {
            "header": header(self._simulation.time_ns, "world"),
            "model_names": [placed.name for placed in self._entities.placed],
        }
        return Answer(fields=fields)

    def _get_state(self, request: Any) -> Answer:
        if self._is_model(request.name):
            answer = self._states.get_model_state(
                SimpleNamespace(
                    model_name=request.name, relative_entity_name=request.reference_frame
                )
            ).fields
            pose, twist = answer["pose"], answer["twist"]
        else:
            state = self._states.get_link_state(
                SimpleNamespace(link_name=request.name, reference_frame=request.reference_frame)
            ).fields["link_state"]
            pose, twist = state.pose, state.twist
        told = message_class("gazebo_msgs/msg/EntityState")(
            request.name, pose, twist, request.reference_frame
        )
        frame = request.reference_frame or "world"
        return Answer(fields={"header": header(self._simulation.time_ns, frame), "state": told})

    def _set_state(self, request: Any) -> Answer:
        state = request.state
        named = SimpleNamespace(
            pose=state.pose, twist=state.twist, reference_frame=state.reference_frame
        )
        if self._is_model(state.name):
            named.model_name = state.name
            return self._states.set_model_state(SimpleNamespace(model_state=named))
        named.link_name = state.name
        return self._states.set_link_state(SimpleNamespace(link_state=named))

    def _is_model(self, name: str) -> bool:
        if any(placed.name == name for placed in self._entities.placed):
            return True
        if "::" in name:
            return False
        try:
            self._entities.link(name)
        except UnknownNameError:
            # The error is to name models.
            return True
        except CartwheelError:
            return False
        return False

    def _answering(self, offer: Offer) -> Callable[[Any], Any]:
        """A handler that answers in any case."""
        response_type = f"{offer.type}_Response"

        def handle(request: Any) -> Any:
            response = zero(response_type)
            try:
                answer = offer.handler(request)
            except Exception as error:  # noqa: BLE001 - the caller waits for an answer
                self._explain(offer.name, response, error)
                return response
            for name, value in answer.fields.items():
                setattr(response, name, value)
            if hasattr(response, "success"):
                response.success = True
            if hasattr(response, "status_message"):
                response.status_message = "; ".join((answer.status, *answer.notes))
            return response

        return handle

    def _explain(self, name: str, response: Any, error: Exception) -> None:
        text = explained(error)
        if hasattr(response, "status_message"):
            response.status_message = text
        elif text not in self._told and len(self._told) < _REMEMBERED:
            self._told.add(text)
            found = Diagnostic(severity="warning", message=f"{name}: {text}")
            self._simulation.report(found)


def explained(error: Exception) -> str:
    """An error in one line, with its place and what to do."""
    if not isinstance(error, CartwheelError):
        return f"{type(error).__name__}: {error}"
    place = f"{error.origin}: " if error.origin else ""
    return f"{place}{error.message}{f'. {error.hint}' if error.hint else ''}"
