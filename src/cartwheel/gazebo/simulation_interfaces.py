"""The simulation_interfaces standard, which newer ROS 2 programs use for any simulator."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cartwheel.description.model import RobotDescription
from cartwheel.errors import DescriptionError, GraphError, one_line
from cartwheel.gazebo.entities import Entities
from cartwheel.gazebo.entity_info import EntityInfos
from cartwheel.gazebo.requests import pose, pose_message, twist_message, vector_message
from cartwheel.gazebo.resources import Resources
from cartwheel.gazebo.results import (
    FAILED,
    OK,
    PACKAGE,
    UNSUPPORTED,
    Handler,
    Refusal,
    answering,
    outcome,
)
from cartwheel.gazebo.spawning import Spawning
from cartwheel.gazebo.state import States
from cartwheel.gazebo.stepping import Stepping
from cartwheel.graph import Service
from cartwheel.graph.names import resolve_name
from cartwheel.messages import header, message_class, zero
from cartwheel.session import Session
from cartwheel.simulation import RunState

PREFIX = "/gz_server"
"""Namespace of new Gazebo's node."""
_NAME_NOT_UNIQUE, _NAME_INVALID, _NO_RESOURCE, _NAMESPACE_INVALID, _PARSE_ERROR = (
    101, 102, 104, 105, 106,
)  # fmt: skip
_INVALID_POSE_TO_SPAWN, _INVALID_POSE_TO_SET, _ALREADY, _SOME_FAILED = 109, 101, 101, 150
_STOPPED, _PLAYING, _PAUSED, _QUITTING = range(4)
_TIME, _STATE, _SPAWNED, _ALL = 1, 2, 4, 255
_NOT_THERE = frozenset(
    ("POSE_BOUNDS", "SIMULATION_RESET_TIME", "WORLD_LOADING", "WORLD_RESOURCE_STRING",
     "WORLD_TAGS", "WORLD_UNLOADING")
)  # fmt: skip
"""Unsupported features; all others in SimulatorFeatures.msg are supported."""


class SimulationInterfaces:
    """Serves simulation_interfaces 2. Every model is an entity.

    Args:
        session: The session.
        entities: Resolves model names.
        spawning: Spawns models.
        states: Gets and sets poses and velocities.
        package_path: Folders to search first for packages.
    """

    def __init__(
        self,
        session: Session,
        entities: Entities,
        spawning: Spawning,
        states: States,
        package_path: Sequence[Path],
    ) -> None:
        self._session = session
        self._simulation = session.simulation
        self._entities = entities
        self._spawning = spawning
        self._states = states
        self._infos = EntityInfos(session.simulation, entities)
        self._stepping = Stepping(session, spawning)
        self._resources = Resources(session.simulation, package_path, spawning.reach)
        self._original: frozenset[str] = frozenset()
        self._stopped = False
        """Whether the last request stopped the simulation instead of pausing it."""

    def start(self, node: str) -> list[Service]:
        """Advertises everything; the current models are restored by a reset."""
        self._original = frozenset(self._simulation.models)
        self._stepping.start(node, PREFIX)
        offers: list[tuple[str, str, Handler, bool]] = [
            ("get_simulator_features", "GetSimulatorFeatures", self._features, False),
            ("get_entity_state", "GetEntityState", self._get_state, False),
            ("get_entities_states", "GetEntitiesStates", self._get_states, False),
            ("set_entity_state", "SetEntityState", self._set_state, False),
            ("spawn_entity", "SpawnEntity", self._spawn, True),
            ("spawn_entities", "SpawnEntities", self._spawn_all, True),
            ("delete_entity", "DeleteEntity", self._delete, False),
            ("get_simulation_state", "GetSimulationState", self._get_run_state, False),
            ("set_simulation_state", "SetSimulationState", self._set_run_state, False),
            ("reset_simulation", "ResetSimulation", self._reset, False),
            *self._stepping.offers(),
            *self._infos.offers(),
            *self._resources.offers(),
        ]
        return [
            self._session.graph.serve(
                f"{PREFIX}/{name}",
                f"{PACKAGE}/srv/{kind}",
                answering(kind, handler),
                node=node,
                threaded=threaded,
            )
            for name, kind, handler, threaded in offers
        ]

    def close(self) -> None:
        """Removes the action; the caller removes the services."""
        self._stepping.close()

    # -- what there is

    def _features(self, _: Any, response: Any) -> None:
        kind = message_class(f"{PACKAGE}/msg/SimulatorFeatures")
        features = [
            number
            for name, number in vars(kind).items()
            if name.isupper() and name not in _NOT_THERE
        ]
        response.features.features = np.array(sorted(features), np.uint16)
        response.features.spawn_formats = ["urdf", "sdf"]
        response.features.custom_info = "Cartwheel"

    def _get_state(self, request: Any, response: Any) -> None:
        response.state = self._state(request.entity)

    def _get_states(self, request: Any, response: Any) -> None:
        response.entities = self._infos.filtered(request.filters)
        response.states = [self._state(name) for name in response.entities]

    def _state(self, name: str) -> Any:
        motion = self._states.model(name, "world")
        linear, angular = self._entities.model_acceleration(name)
        return message_class(f"{PACKAGE}/msg/EntityState")(
            header=header(self._simulation.time_ns, "world"),
            pose=pose_message(motion.pose),
            twist=twist_message(motion.linear, motion.angular),
            acceleration=message_class("geometry_msgs/msg/Accel")(
                linear=vector_message(linear), angular=vector_message(angular)
            ),
        )

    def _set_state(self, request: Any, _: Any) -> None:
        self._entities.model(request.entity)
        if request.set_acceleration:
            raise Refusal(UNSUPPORTED, "an acceleration cannot be set; apply a force instead")
        state, frame = request.state, request.state.header.frame_id
        if not request.set_pose or not request.set_twist:
            self._simulation.refresh()
            motion = self._entities.model_motion(request.entity)
            if request.set_pose == request.set_twist:
                return
            if not request.set_pose:
                if frame not in ("", "world"):
                    raise Refusal(UNSUPPORTED, "a twist without a pose must be in the world frame")
                state.pose = pose_message(motion.pose)
            else:
                seen = motion.seen_from(self._entities.frame(frame))
                state.twist = twist_message(seen.linear, seen.angular)
        try:
            pose(state.pose, "pose")
        except GraphError as error:
            raise Refusal(_INVALID_POSE_TO_SET, error.message) from None
        moving = any(
            (part.x, part.y, part.z) != (0.0, 0.0, 0.0)
            for part in (request.state.twist.linear, request.state.twist.angular)
        )
        if request.set_twist and moving and not self._simulation.moves(request.entity):
            raise Refusal(
                FAILED, f'"{request.entity}" is fixed to the world and cannot have a twist'
            )
        self._states.put_model(request.entity, state.pose, state.twist, frame)

    # -- in and out

    def _spawn(self, request: Any, response: Any) -> None:
        description = self._resource(request.name, request.entity_resource)
        name = request.name.strip()
        if not name and not request.allow_renaming and not description.name:
            raise Refusal(_NAME_INVALID, "the name is empty")
        if request.entity_namespace.strip(" /"):
            try:
                resolve_name(request.entity_namespace.strip())
            except GraphError as error:
                raise Refusal(_NAMESPACE_INVALID, error.message) from None
        try:
            where = pose(request.initial_pose.pose, "initial_pose")
        except GraphError as error:
            raise Refusal(_INVALID_POSE_TO_SPAWN, error.message) from None
        wanted = name or description.name
        taken = self._spawning.on_owner(lambda: wanted in self._simulation.models)
        if taken and not request.allow_renaming:
            raise Refusal(_NAME_NOT_UNIQUE, f'an entity named "{wanted}" already exists')
        response.entity_name = self._spawning.spawn(
            description,
            name=name,
            where=where,
            reference_frame=request.initial_pose.header.frame_id,
            namespace=request.entity_namespace or "/",
            rename=request.allow_renaming,
        )

    def _spawn_all(self, request: Any, response: Any) -> None:
        for each in request.spawn_requests:
            made = zero(f"{PACKAGE}/msg/SpawnResult")
            made.result.result, made.result.error_message = outcome(
                functools.partial(self._spawn, each, made)
            )
            response.results.append(made)
        failed = sum(made.result.result != OK for made in response.results)
        if failed:
            raise Refusal(
                _SOME_FAILED, f"{failed} of {len(response.results)} entities were not spawned"
            )

    def _resource(self, name: str, resource: Any) -> RobotDescription:
        found: object
        try:
            if resource.uri:
                found = self._spawning.load(resource.uri)
            elif resource.resource_string:
                found = self._spawning.read(name, resource.resource_string)
            else:
                raise Refusal(_NO_RESOURCE, "neither uri nor resource_string is set")
        except DescriptionError as error:
            raise Refusal(_PARSE_ERROR, one_line(error)) from None
        if not isinstance(found, RobotDescription):
            raise Refusal(_PARSE_ERROR, "the resource does not describe a model")
        return found

    def _delete(self, request: Any, _: Any) -> None:
        self._simulation.delete(request.entity)

    # -- time

    def _get_run_state(self, _: Any, response: Any) -> None:
        response.state.state = self._run_state()

    def _run_state(self) -> int:
        simulation = self._simulation
        at_start = simulation.run_state is RunState.PAUSED and not simulation.time_ns
        self._stopped = self._stopped and at_start
        if self._stopped:
            return _STOPPED
        states = {
            RunState.RUNNING: _PLAYING,
            RunState.PAUSED: _PAUSED,
            RunState.WAITING: _PAUSED,
            RunState.STOPPED: _QUITTING,
        }
        return states[simulation.run_state]

    def _set_run_state(self, request: Any, _: Any) -> None:
        wanted, simulation = request.state.state, self._simulation
        if wanted == self._run_state():
            raise Refusal(_ALREADY, "the simulation is already in this state")
        self._stopped = wanted == _STOPPED
        if wanted == _PLAYING:
            simulation.resume()
        elif wanted == _PAUSED:
            simulation.pause()
        elif wanted == _STOPPED:
            simulation.pause()
            self._reset_all()
        elif wanted == _QUITTING:
            simulation.stop()
        else:
            raise Refusal(UNSUPPORTED, f"a simulation cannot be set to state {wanted}")

    def _reset(self, request: Any, _: Any) -> None:
        scope = int(request.scope)
        if scope in (0, _ALL, _TIME | _STATE | _SPAWNED):
            self._reset_all()
            return
        if scope & ~(_TIME | _STATE | _SPAWNED):
            raise Refusal(UNSUPPORTED, f"scope {scope} does not exist")
        if scope & _TIME and not scope & _STATE:
            raise Refusal(UNSUPPORTED, "SCOPE_TIME requires SCOPE_STATE")
        if scope & _SPAWNED:
            self._delete_spawned()
        if scope & _STATE:
            self._simulation.reset(keep_time=not scope & _TIME)

    def _reset_all(self) -> None:
        self._delete_spawned()
        self._infos.forget()
        self._simulation.reset()

    def _delete_spawned(self) -> None:
        for name in self._simulation.models:
            if name not in self._original:
                self._simulation.delete(name)
