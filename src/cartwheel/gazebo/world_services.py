"""New Gazebo's world services as ros_gz_bridge exposes them in ROS 2: ``/world/<name>/…``."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

from cartwheel.codes.graph import (
    REQUEST_INVALID,
    REQUEST_UNSUPPORTED,
    SERVICE_FAILED,
    SPAWN_INVALID,
)
from cartwheel.description.model import Light, RobotDescription
from cartwheel.errors import GraphError
from cartwheel.gazebo.entities import Entities
from cartwheel.gazebo.requests import Answer, Offer, pose
from cartwheel.gazebo.spawning import Spawning
from cartwheel.geometry import Pose
from cartwheel.messages.times import nanoseconds
from cartwheel.reporting import Reporter
from cartwheel.simulation import Simulation

_PACKAGE = "ros_gz_interfaces/srv"
_ANY, _LIGHT, _MODEL = range(3)
"""Values in Entity.msg."""
_NO_PART_OF_A_NAME = re.compile(r"[^A-Za-z0-9_]|\A(?=[0-9])")


class WorldServices:
    """create, remove, set_pose and control of the world.

    Their responses contain only success, so reasons and warnings are reported to the user. Source:
    gz-sim, UserCommands and SimulationRunner; ros_gz_bridge for the types.

    Args:
        simulation: The simulation.
        entities: Resolves model names.
        spawning: Spawns models.
        tell: Reports failures that the response cannot contain.
    """

    def __init__(
        self, simulation: Simulation, entities: Entities, spawning: Spawning, tell: Reporter
    ) -> None:
        self._simulation = simulation
        self._entities = entities
        self._spawning = spawning
        self._tell = tell

    def offers(self) -> list[Offer]:
        """The services, under the world's name as a valid ROS name."""
        world = f"/world/{_NO_PART_OF_A_NAME.sub('_', self._simulation.world.name)}"
        return [
            Offer(f"{world}/create", f"{_PACKAGE}/SpawnEntity", self._create, threaded=True),
            Offer(f"{world}/remove", f"{_PACKAGE}/DeleteEntity", self._remove),
            Offer(f"{world}/set_pose", f"{_PACKAGE}/SetEntityPose", self._set_pose),
            Offer(f"{world}/control", f"{_PACKAGE}/ControlWorld", self._control),
        ]

    def _create(self, request: Any) -> Answer:
        asked = request.entity_factory
        name, where = asked.name.strip(), pose(asked.pose, "pose")
        # The request's pose replaces the description's.
        found = dataclasses.replace(self._wanted(asked, name), pose=Pose())
        if isinstance(found, Light):
            self._spawning.add_light(found, name, where, asked.relative_to)
        else:
            self._spawning.spawn(
                found,
                name=name,
                where=where,
                reference_frame=asked.relative_to,
                namespace="/",
                rename=asked.allow_renaming,
            )
        return Answer()

    def _wanted(self, asked: Any, name: str) -> RobotDescription | Light:
        """The description in a request, in one of its three forms."""
        ways = [way for way in ("sdf", "sdf_filename", "clone_name") if getattr(asked, way)]
        if len(ways) != 1:
            raise GraphError(
                "exactly one of sdf, sdf_filename and clone_name must be set", code=REQUEST_INVALID
            )
        if asked.sdf:
            return self._spawning.read(name, asked.sdf)
        if asked.sdf_filename:
            found = self._spawning.load(asked.sdf_filename)
            if not isinstance(found, RobotDescription):
                raise GraphError(
                    "the file in sdf_filename describes a world, not a model", code=SPAWN_INVALID
                )
            return found
        return self._spawning.on_owner(lambda: self._entities.model(asked.clone_name))

    def _remove(self, request: Any) -> Answer:
        name, kind = request.entity.name, request.entity.type
        lights = [light.name for light in self._simulation.world.lights]
        if kind == _LIGHT or (kind == _ANY and name in lights):
            self._spawning.remove_light(name)
        else:
            self._require_model(kind, "removed")
            self._simulation.delete(name)
        return Answer()

    def _set_pose(self, request: Any) -> Answer:
        name, simulation = request.entity.name, self._simulation
        self._require_model(request.entity.type, "moved")
        self._entities.model(name)
        simulation.refresh()
        motion = self._entities.model_motion(name)
        where = pose(request.pose, "pose")
        simulation.set_state(name, where, linear=motion.linear, angular=motion.angular)
        return Answer()

    @staticmethod
    def _require_model(kind: int, done: str) -> None:
        if kind not in (_ANY, _MODEL):
            raise GraphError(
                f"only models can be {done}, not entities of type {kind}",
                code=REQUEST_UNSUPPORTED,
                values={"type": kind},
            )

    def _control(self, request: Any) -> Answer:
        asked, simulation = request.world_control, self._simulation
        if asked.reset.time_only:
            raise GraphError(
                "time_only is not supported: time can only be reset together with the models",
                code=REQUEST_UNSUPPORTED,
            )
        if asked.seed:
            self._tell(
                SERVICE_FAILED.diagnostic(
                    "control: the seed cannot be changed after startup",
                    values={"field": "seed"},
                )
            )
        if asked.pause:
            simulation.pause()
        else:
            simulation.resume()
        if asked.reset.all or asked.reset.model_only:
            simulation.reset(keep_time=not asked.reset.all)
        steps = asked.multi_step or int(asked.step)
        left = nanoseconds(asked.run_to_sim_time) - simulation.time_ns
        if left > 0:
            simulation.step(-(-left // simulation.step_ns))
        elif steps and asked.pause:
            simulation.step(steps)
        return Answer()
