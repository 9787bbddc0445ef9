"""What newer ROS 2 programs steer any simulator by: simulation_interfaces."""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from cartwheel.description import load
from cartwheel.description.model import RobotDescription
from cartwheel.errors import (
    CartwheelError,
    DescriptionError,
    GraphError,
    UnknownNameError,
    one_line,
)
from cartwheel.gazebo.entities import Entities
from cartwheel.gazebo.requests import pose, pose_message, twist_message
from cartwheel.gazebo.spawning import Spawning
from cartwheel.gazebo.state import States
from cartwheel.graph import Action, Goal, Service
from cartwheel.messages import header, message_class, zero
from cartwheel.session import Session
from cartwheel.simulation import RunState

PREFIX = "/gz_server"
"""Where new Gazebo's node offers them."""
_PACKAGE = "simulation_interfaces"
_UNSUPPORTED, _OK, _NOT_FOUND, _INCORRECT_STATE, _FAILED = range(5)
_NAME_NOT_UNIQUE, _NAME_INVALID, _NO_RESOURCE, _PARSE_ERROR = 101, 102, 104, 106
_INVALID_POSE_TO_SPAWN, _INVALID_POSE_TO_SET, _ALREADY = 109, 101, 101
_STOPPED, _PLAYING, _PAUSED, _QUITTING = range(4)
_TIME, _STATE, _SPAWNED, _ALL = 1, 2, 4, 255
_FEATURES = (0, 1, 9, 10, 11, 20, 22, 23, 24, 25, 26, 31, 32, 33)
"""SPAWNING, DELETING, SPAWNING_RESOURCE_STRING, ENTITY_STATE_GETTING and SETTING, SIMULATION_RESET,
RESET_STATE, RESET_SPAWNED, STATE_GETTING, SETTING and PAUSE, STEP_SIMULATION_SINGLE, MULTIPLE and
ACTION."""
_LOOK = 0.002
"""s between two looks whether steps were made."""
_INTERRUPTED = "something else let the simulation go on, or reset it"
_AT_A_TIME = 20
"""Steps of an action between two looks at whether it goes on."""


class _Refusal(Exception):  # noqa: N818 - it is an answer
    """A result that is none of success."""

    def __init__(self, result: int, text: str) -> None:
        super().__init__(text)
        self.result = result


class SimulationInterfaces:
    """Serves simulation_interfaces 2. Every model is an entity.

    Args:
        session: To act on.
        entities: Finds models.
        spawning: Puts models into the world.
        states: Gets and sets where they are.
        package_path: Where models look for packages first.
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
        self._package_path = tuple(package_path)
        self._original: frozenset[str] = frozenset()
        self._action: Action | None = None
        self._stepping = False
        self._stopped = False
        """Whether it was stopped and not paused since, as far as requests say."""

    def start(self, node: str) -> list[Service]:
        """Offers everything; what stands in the world now is what a reset leaves there."""
        self._original = frozenset(self._simulation.models)
        self._action = Action(
            self._session.graph,
            f"{PREFIX}/simulate_steps",
            f"{_PACKAGE}/action/SimulateSteps",
            node=node,
            time_ns=lambda: self._simulation.time_ns,
            on_goal=self._simulate_steps,
            on_cancel=lambda goal: goal.cancel(_ended(_FAILED, "it was called off")),
        )
        offers: list[tuple[str, str, Callable[[Any, Any], None], bool]] = [
            ("get_simulator_features", "GetSimulatorFeatures", self._features, False),
            ("get_entities", "GetEntities", self._list, False),
            ("get_entity_state", "GetEntityState", self._get_state, False),
            ("get_entities_states", "GetEntitiesStates", self._get_states, False),
            ("set_entity_state", "SetEntityState", self._set_state, False),
            ("spawn_entity", "SpawnEntity", self._spawn, True),
            ("delete_entity", "DeleteEntity", self._delete, False),
            ("get_simulation_state", "GetSimulationState", self._get_run_state, False),
            ("set_simulation_state", "SetSimulationState", self._set_run_state, False),
            ("step_simulation", "StepSimulation", self._step, True),
            ("reset_simulation", "ResetSimulation", self._reset, False),
        ]
        return [
            self._session.graph.serve(
                f"{PREFIX}/{name}",
                f"{_PACKAGE}/srv/{kind}",
                self._answering(kind, handler),
                node=node,
                threaded=threaded,
            )
            for name, kind, handler, threaded in offers
        ]

    def close(self) -> None:
        """Takes the action off the graph; the services are the caller's."""
        if self._action is not None:
            self._action.close()
            self._action = None

    @staticmethod
    def _answering(kind: str, handler: Callable[[Any, Any], None]) -> Callable[[Any], Any]:
        def handle(request: Any) -> Any:
            response = zero(f"{_PACKAGE}/srv/{kind}_Response")
            result, text = _OK, ""
            try:
                handler(request, response)
            except _Refusal as refusal:
                result, text = refusal.result, str(refusal)
            except UnknownNameError as error:
                result, text = _NOT_FOUND, one_line(error)
            except Exception as error:  # noqa: BLE001 - the caller waits for an answer
                result, text = _FAILED, one_line(error)
            if hasattr(response, "result"):
                response.result.result = result
                response.result.error_message = text
            return response

        return handle

    # -- what there is

    def _features(self, _: Any, response: Any) -> None:
        response.features.features = np.array(_FEATURES, np.uint16)
        response.features.spawn_formats = ["urdf", "sdf"]
        response.features.custom_info = "Cartwheel"

    def _list(self, request: Any, response: Any) -> None:
        response.entities = self._filtered(request.filters)

    def _filtered(self, filters: Any) -> list[str]:
        if len(filters.categories) or len(filters.tags.tags) or filters.bounds.type:
            raise _Refusal(_UNSUPPORTED, "entities have no categories, tags or bounds here")
        names = [placed.name for placed in self._entities.placed]
        if not filters.filter:
            return names
        try:
            pattern = re.compile(filters.filter)
        except re.error as error:
            raise _Refusal(
                _FAILED, f'"{filters.filter}" is no regular expression: {error}'
            ) from None
        return [name for name in names if pattern.fullmatch(name)]

    def _get_state(self, request: Any, response: Any) -> None:
        response.state = self._state(request.entity)

    def _get_states(self, request: Any, response: Any) -> None:
        response.entities = self._filtered(request.filters)
        response.states = [self._state(name) for name in response.entities]

    def _state(self, name: str) -> Any:
        motion = self._states.model(name, "world")
        return message_class(f"{_PACKAGE}/msg/EntityState")(
            header=header(self._simulation.time_ns, "world"),
            pose=pose_message(motion.pose),
            twist=twist_message(motion.linear, motion.angular),
            acceleration=zero("geometry_msgs/msg/Accel"),
        )

    def _set_state(self, request: Any, _: Any) -> None:
        self._entities.model(request.entity)
        if request.set_acceleration:
            raise _Refusal(_UNSUPPORTED, "an acceleration cannot be set; push with a force")
        state, frame = request.state, request.state.header.frame_id
        if not request.set_pose or not request.set_twist:
            self._simulation.refresh()
            motion = self._entities.model_motion(request.entity)
            if request.set_pose == request.set_twist:
                return
            if not request.set_pose:
                if frame not in ("", "world"):
                    raise _Refusal(_UNSUPPORTED, "a twist alone is set in the world's frame")
                state.pose = pose_message(motion.pose)
            else:
                seen = motion.seen_from(self._entities.frame(frame))
                state.twist = twist_message(seen.linear, seen.angular)
        try:
            pose(state.pose, "pose")
        except GraphError as error:
            raise _Refusal(_INVALID_POSE_TO_SET, error.message) from None
        self._states.put_model(request.entity, state.pose, state.twist, frame)

    # -- in and out

    def _spawn(self, request: Any, response: Any) -> None:
        description = self._resource(request.name, request.entity_resource)
        name = request.name.strip()
        if not name and not request.allow_renaming and not description.name:
            raise _Refusal(_NAME_INVALID, "the name is empty")
        try:
            where = pose(request.initial_pose.pose, "initial_pose")
        except GraphError as error:
            raise _Refusal(_INVALID_POSE_TO_SPAWN, error.message) from None
        wanted = name or description.name
        taken = self._spawning.on_owner(lambda: wanted in self._simulation.models)
        if taken and not request.allow_renaming:
            raise _Refusal(_NAME_NOT_UNIQUE, f'an entity "{wanted}" is there already')
        response.entity_name = self._spawning.spawn(
            description,
            name=name,
            where=where,
            reference_frame=request.initial_pose.header.frame_id,
            namespace=request.entity_namespace,
            rename=request.allow_renaming,
        )

    def _resource(self, name: str, resource: Any) -> RobotDescription:
        found: object
        try:
            if resource.uri:
                found = load(resource.uri.removeprefix("file://"), package_path=self._package_path)
            elif resource.resource_string:
                found = self._spawning.read(name, resource.resource_string)
            else:
                raise _Refusal(_NO_RESOURCE, "neither uri nor resource_string says what to spawn")
        except DescriptionError as error:
            raise _Refusal(_PARSE_ERROR, one_line(error)) from None
        if not isinstance(found, RobotDescription):
            raise _Refusal(_PARSE_ERROR, "the resource describes no model")
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
            RunState.STOPPED: _QUITTING,
        }
        return states[simulation.run_state]

    def _set_run_state(self, request: Any, _: Any) -> None:
        wanted, simulation = request.state.state, self._simulation
        if wanted == self._run_state():
            raise _Refusal(_ALREADY, "it is in that state already")
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
            raise _Refusal(_UNSUPPORTED, f"a simulation cannot be set to state {wanted}")

    def _step(self, request: Any, _: Any) -> None:
        steps, simulation = int(request.steps), self._simulation

        def begin() -> int:
            if simulation.run_state is not RunState.PAUSED:
                raise _Refusal(_INCORRECT_STATE, "steps are made while the simulation is paused")
            simulation.step(steps)
            return simulation.current_step + steps

        if steps < 1:
            return
        target = self._spawning.on_owner(begin)
        while not self._spawning.on_owner(lambda: self._reached(target)):
            time.sleep(_LOOK)

    def _simulate_steps(self, goal: Goal) -> None:
        """Takes a goal of the action; on the owner's thread."""
        goal.accept()
        if self._simulation.run_state is not RunState.PAUSED:
            goal.abort(_ended(_FAILED, "steps are made while the simulation is paused"))
        elif self._stepping:
            goal.abort(_ended(_FAILED, "steps of another goal are being made"))
        else:
            self._stepping = True
            threading.Thread(
                target=self._make_steps, args=(goal,), name="simulate_steps", daemon=True
            ).start()

    def _make_steps(self, goal: Goal) -> None:
        """Makes the steps of a goal, some at a time; on a thread of its own."""
        total, made, simulation = int(goal.goal.steps), 0, self._simulation
        on_owner = self._spawning.on_owner

        def allow(count: int, begin: int | None) -> int | None:
            if goal.done:
                return None
            moved = begin is not None and simulation.current_step != begin
            if moved or simulation.run_state is not RunState.PAUSED:
                raise _Refusal(_FAILED, _INTERRUPTED)
            simulation.step(count)
            return simulation.current_step + count

        def tell(first: int, last: int) -> None:
            for done in range(first, last + 1):
                if goal.done:
                    return
                goal.feedback(
                    message_class(f"{_PACKAGE}/action/SimulateSteps_Feedback")(
                        completed_steps=done, remaining_steps=total - done
                    )
                )

        def end() -> None:
            self._stepping = False
            if not goal.done:
                (goal.succeed if result == _OK else goal.abort)(_ended(result, text))

        result, text = _OK, ""
        target: int | None = None
        try:
            while made < total:
                count = min(_AT_A_TIME, total - made)
                target = on_owner(partial(allow, count, target))
                if target is None:
                    break
                while not on_owner(partial(self._reached, target)):
                    time.sleep(_LOOK)
                on_owner(partial(tell, made + 1, made + count))
                made += count
        except _Refusal as refusal:
            result, text = refusal.result, str(refusal)
        except CartwheelError as error:
            result, text = _FAILED, one_line(error)
        self._session.graph.post(end)

    def _reached(self, step: int) -> bool:
        """Whether a step was made; between steps, on the owner's thread."""
        simulation = self._simulation
        if simulation.current_step == step:
            return True
        if simulation.run_state is not RunState.PAUSED or not simulation.steps_allowed:
            raise _Refusal(_FAILED, _INTERRUPTED)
        return False

    def _reset(self, request: Any, _: Any) -> None:
        scope = int(request.scope)
        if scope in (0, _ALL, _TIME | _STATE | _SPAWNED):
            self._reset_all()
            return
        if scope & ~(_TIME | _STATE | _SPAWNED) or (scope & _TIME and not scope & _STATE):
            raise _Refusal(_UNSUPPORTED, "time is not reset without the state")
        if scope & _SPAWNED:
            self._delete_spawned()
        if scope & _STATE:
            self._simulation.reset(keep_time=not scope & _TIME)

    def _reset_all(self) -> None:
        self._delete_spawned()
        self._simulation.reset()

    def _delete_spawned(self) -> None:
        for name in self._simulation.models:
            if name not in self._original:
                self._simulation.delete(name)


def _ended(result: int, text: str) -> Any:
    """What came of an action."""
    made = zero(f"{_PACKAGE}/action/SimulateSteps_Result")
    made.result.result, made.result.error_message = result, text
    return made
