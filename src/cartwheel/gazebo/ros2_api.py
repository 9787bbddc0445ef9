"""The topics and services of gazebo_ros's ROS 2 branch."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cartwheel.dialects.catalogue import short_name
from cartwheel.errors import CartwheelError, UnknownNameError
from cartwheel.gazebo.entities import Entities
from cartwheel.gazebo.forces import Pushes
from cartwheel.gazebo.metrics import Metrics
from cartwheel.gazebo.physics import Physics
from cartwheel.gazebo.properties import Properties
from cartwheel.gazebo.requests import (
    REPORTED,
    Answer,
    Offer,
    answering,
    pose,
    pose_message,
    twist_message,
)
from cartwheel.gazebo.simulation_interfaces import SimulationInterfaces
from cartwheel.gazebo.spawning import Spawning
from cartwheel.gazebo.state import States, StateTopics
from cartwheel.gazebo.world_services import WorldServices
from cartwheel.graph import Service
from cartwheel.messages import header, message_class
from cartwheel.reporting import Reporter
from cartwheel.session import Session

NODE = "gazebo"


class Ros2Api:
    """Advertises the ROS 2 interfaces of Gazebo Classic, new Gazebo and simulation_interfaces.

    A failed request returns ``success`` false with the reason, if the response has a field for it,
    and never has partial effects. Services that Gazebo gets from world plugins exist without these
    plugins; the plugins add their namespaces. Source: gazebo_ros 3, gazebo_ros_init,
    gazebo_ros_factory, gazebo_ros_force_system, gazebo_ros_state, gazebo_ros_properties.

    Args:
        session: The session.
        package_path: Folders to search first for packages of spawned models.
    """

    def __init__(self, session: Session, *, package_path: Sequence[Path] = ()) -> None:
        self._session = session
        self._simulation = session.simulation
        self._tell = Reporter(session.simulation.report, REPORTED)
        self._entities = Entities(session.simulation)
        self._spawning = Spawning(session, self._entities, package_path)
        self._states = States(session.simulation, self._entities)
        self._properties = Properties(session.simulation, self._entities)
        self._pushes = Pushes(session.simulation, self._entities)
        self._world = WorldServices(session.simulation, self._entities, self._spawning, self._tell)
        self._interfaces = SimulationInterfaces(
            session, self._entities, self._spawning, self._states, package_path
        )
        self._services: list[Service] = []
        self._topics: list[StateTopics | Metrics] = []

    def start(self) -> None:
        """Advertises all topics and services. Call it on the owner's thread, or before there is an
        owner.

        Raises:
            GraphError: A service already exists.
        """
        graph = self._session.graph
        try:
            for offer in self._offers():
                self._services.append(
                    graph.serve(
                        offer.name,
                        offer.type,
                        answering(offer, self._tell),
                        node=NODE,
                        threaded=offer.threaded,
                    )
                )
            self._services += self._interfaces.start(NODE)
            for prefix in self._namespaces("gazebo_ros_state"):
                self._topics.append(StateTopics(self._simulation, graph, NODE, prefix=prefix))
            self._topics.append(Metrics(self._simulation, graph, NODE, prefix=""))
        except CartwheelError:
            self.close()
            raise

    def close(self) -> None:
        """Removes all topics and services."""
        for topic in self._topics:
            topic.close()
        self._topics.clear()
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
        states = [
            offer
            # The namespace in most worlds.
            for prefix in dict.fromkeys((*self._namespaces("gazebo_ros_state"), "/gazebo"))
            for offer in (
                Offer(f"{prefix}/get_entity_state", f"{package}/GetEntityState", self._get_state),
                Offer(f"{prefix}/set_entity_state", f"{package}/SetEntityState", self._set_state),
            )
        ]
        properties = [
            Offer(f"{prefix}/{offer.name}", offer.type, offer.handler)
            for prefix in self._namespaces("gazebo_ros_properties")
            for offer in self._properties.ros2_offers()
        ]
        pushes = [
            Offer(f"/{offer.name}", offer.type, offer.handler)
            for offer in self._pushes.ros2_offers()
        ]
        return [
            *physics,
            *pushes,
            *properties,
            Offer("/spawn_entity", f"{package}/SpawnEntity", self._spawn, threaded=True),
            Offer("/delete_entity", f"{package}/DeleteEntity", self._delete),
            Offer("/get_model_list", f"{package}/GetModelList", self._list_models),
            *states,
            *self._world.offers(),
        ]

    def _namespaces(self, plugin: str) -> list[str]:
        """The root, and the namespaces of this plugin in the world."""
        found = [""]
        for tag in self._simulation.world.plugins:
            stated = tag.element.find("ros/namespace")
            if short_name(tag.filename) == plugin and stated is not None:
                found.append(f"/{stated.text.strip().strip('/')}".rstrip("/"))
        return list(dict.fromkeys(found))

    def _spawn(self, request: Any) -> Answer:
        self._spawning.spawn_text(
            request.xml,
            name=request.name,
            where=pose(request.initial_pose, "initial_pose"),
            reference_frame=request.reference_frame,
            # Without a namespace, a ROS 2 node is at the root, whatever its model's name.
            namespace=request.robot_namespace or "/",
        )
        return Answer(f"SpawnEntity: Successfully spawned entity [{request.name}]")

    def _delete(self, request: Any) -> Answer:
        try:
            self._simulation.delete(request.name)
        except UnknownNameError:
            if not any(light.name == request.name for light in self._simulation.world.lights):
                raise
            self._spawning.remove_light(request.name)
        return Answer(f"DeleteEntity: Successfully deleted entity [{request.name}]")

    def _list_models(self, _: Any) -> Answer:
        fields = {
            "header": header(self._simulation.time_ns, "world"),
            "model_names": [placed.name for placed in self._entities.placed],
        }
        return Answer(fields=fields)

    def _get_state(self, request: Any) -> Answer:
        read = self._states.model if self._is_model(request.name) else self._states.link
        seen = read(request.name, request.reference_frame)
        reported = message_class("gazebo_msgs/msg/EntityState")(
            request.name,
            pose_message(seen.pose),
            twist_message(seen.linear, seen.angular),
            request.reference_frame,
        )
        frame = request.reference_frame or "world"
        return Answer(fields={"header": header(self._simulation.time_ns, frame), "state": reported})

    def _set_state(self, request: Any) -> Answer:
        state = request.state
        put = self._states.put_model if self._is_model(state.name) else self._states.put_link
        return Answer(notes=put(state.name, state.pose, state.twist, state.reference_frame))

    def _is_model(self, name: str) -> bool:
        if any(placed.name == name for placed in self._entities.placed):
            return True
        if "::" in name:
            return False
        try:
            self._entities.link(name)
        except UnknownNameError:
            # The error should list models.
            return True
        except CartwheelError:
            return False
        return False
