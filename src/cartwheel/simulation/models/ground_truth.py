"""The exact state of the models in a simulation: motion, joints and contacts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cartwheel.codes import running
from cartwheel.codes import world as world_codes
from cartwheel.description.model import RobotDescription
from cartwheel.errors import SimulationError, UnknownNameError
from cartwheel.geometry import Quat, Vec3, cross
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.handles import JointHandle, LinkHandle
from cartwheel.simulation.limits import STRONGEST, number, numbers
from cartwheel.simulation.models.forces import Forces
from cartwheel.simulation.models.joint_limits import JointLimits
from cartwheel.simulation.models.placement import push_off, with_mimics
from cartwheel.simulation.models.population import Population
from cartwheel.simulation.models.shape_queries import ShapeQueries
from cartwheel.simulation.models.touches import Place, Touch, Touches
from cartwheel.world.entry import CameraMount
from cartwheel.world.motion import Motion

_STILL: Vec3 = (0.0, 0.0, 0.0)


class GroundTruth:
    """Reads and sets the state by names. Use it only on the simulation's thread.

    Reading changes no later state, and computes nothing twice for one state.

    Args:
        engine: The engine that simulates the models.
        population: The models.
        forces: Forces on links and joints.
    """

    def __init__(self, engine: Engine, population: Population, forces: Forces) -> None:
        self._engine = engine
        self._population = population
        self._forces = forces
        self._touches = Touches(engine)
        self.limits = JointLimits(engine, population)
        self.shapes = ShapeQueries(
            engine, lambda: [each.entry for each in population.residents.values()]
        )
        self._links: dict[tuple[str, str], LinkHandle] = {}
        self._joints: dict[tuple[str, str], JointHandle] = {}
        self._model: object = None
        """The compiled model to which the handles are bound."""

    def description(self, model: str) -> RobotDescription:
        """The description of a model, with all changes so far.

        Raises:
            UnknownNameError: The model does not exist.
        """
        return self._population.resident(model).entry.description

    # -- links

    def link(self, model: str, link: str) -> LinkHandle:
        """A handle to a link, valid until the next compilation.

        Raises:
            UnknownNameError: The model or link does not exist.
        """
        description = self.description(model)
        if description.link(link) is None:
            known = [each.name for each in description.links]
            raise UnknownNameError("link", link, known, code=running.UNKNOWN_LINK)
        self._bind()
        handle = self._links.get((model, link))
        if handle is None:
            handle = self._links[model, link] = LinkHandle(model, link)
            handle.bind(self._engine.model, self._engine.data)
        return handle

    def locate(self, *, velocities: bool = True) -> None:
        """Updates poses to the current state.

        Args:
            velocities: Update velocities as well.
        """
        if velocities:
            self._engine.refresh_motion()
        else:
            self._engine.refresh_poses()

    def place(self, model: str) -> tuple[Vec3, Quat]:
        """Position and orientation of a model's frame in the world in the current state, as plain
        tuples for high-rate access.

        Raises:
            UnknownNameError: The model does not exist.
        """
        return self._engine.current_place(self._population.resident(model).entry)

    def acceleration(self, model: str, link: str) -> tuple[Vec3, Vec3]:
        """Linear and angular acceleration of a link's origin, m/s² and rad/s², in world axes.

        Raises:
            UnknownNameError: The model or link does not exist.
        """
        handle = self.link(model, link)
        tree = int(self._engine.model.body_treeid[handle.id])
        if tree < 0 or self._engine.data.tree_asleep[tree] >= 0:
            return _STILL, _STILL
        self._engine.refresh()
        return handle.acceleration()

    def cameras(self, model: str) -> tuple[CameraMount, ...]:
        """The cameras of a model.

        Raises:
            UnknownNameError: The model does not exist.
        """
        return tuple(self._population.resident(model).entry.cameras)

    def velocity(self, model: str) -> tuple[Vec3, Vec3]:
        """Linear and angular velocity of a model's frame, m/s and rad/s, in world axes.

        Raises:
            UnknownNameError: The model does not exist.
        """
        entry = self._population.resident(model).entry
        if entry.motion is not None:
            return entry.motion.linear, entry.motion.angular
        handle = self.link(model, entry.description.canonical_link)
        self.locate()
        return handle.motion_at(self._engine.model_pose(entry).position)

    def set_velocity(self, model: str, linear: Vec3, angular: Vec3) -> None:
        """Sets the velocity of a model as a rigid body; its joints stop.

        A model that is fixed to the world keeps the velocity until it is set again.

        Args:
            model: Model name.
            linear: Velocity of the frame's origin, m/s, in world axes.
            angular: rad/s, in world axes.

        Raises:
            UnknownNameError: The model does not exist.
            SimulationError: The model is fixed to the world, and joints depend on it.
            CartwheelError: A number is not finite or too large.
        """
        entry = self._population.resident(model).entry
        numbers((*linear, *angular), f'the velocity of model "{model}"')
        if not self._engine.is_free(model, entry.description.canonical_link):
            motions = self._population.motions
            if not motions.can_move(entry):
                error = _fixed(model)
                error.hint = "A model moves at a velocity if no joint depends on its links."
                raise error
            self._engine.commanded += 1
            moves = any((*linear, *angular))
            motion = Motion(
                pose=entry.pose, time_ns=self._engine.time_ns, linear=linear, angular=angular
            )
            motions.set(entry, motion if moves else None)
            return
        self._engine.commanded += 1
        self.locate()
        push_off(self._engine, entry, linear, angular)
        self._engine.note_change()

    def push(
        self,
        model: str,
        link: str,
        *,
        force: Vec3,
        torque: Vec3,
        at: Vec3 | None,
        duration_ns: int | None,
    ) -> None:
        """Pushes a link from now on.

        Args:
            model: Model name.
            link: Link name.
            force: N, in world axes.
            torque: N m, in world axes.
            at: Point of application in the world, m; None for the centre of mass. Its distance
                from the centre of mass is that at the start of the push.
            duration_ns: None for no end, 0 for one step.

        Raises:
            UnknownNameError: The model or link does not exist.
            SimulationError: The link is fixed to the world.
            CartwheelError: A number is not finite or too large.
        """
        handle = self.link(model, link)
        if not handle.moves:
            raise _fixed(model, link)
        numbers((*force, *torque), f'the push on link "{link}"', most=STRONGEST)
        if at is not None:
            numbers(at, "the point of application")
            self.locate()
            arm = np.subtract(at, self._engine.data.xipos[handle.id])
            x, y, z = np.add(torque, cross(arm, force)).tolist()
            torque = (x, y, z)
        self._forces.wrench(model, link, force=force, torque=torque, duration_ns=duration_ns)
        self._apply_forces()

    def end_pushes(self, model: str, link: str) -> None:
        """Ends all pushes on a link.

        Raises:
            UnknownNameError: The model or link does not exist.
        """
        self.link(model, link)
        self._forces.clear_wrenches(model, link)
        self._apply_forces()

    def _apply_forces(self) -> None:
        # At once, so that a push by a callback acts in the step of the callback.
        self._forces.serve()
        self._engine.note_change()

    # -- joints

    def joints(self, model: str) -> tuple[str, ...]:
        """Names of a model's joints with one degree of freedom, in the description's order.

        Raises:
            UnknownNameError: The model does not exist.
        """
        description = self.description(model)
        if description.static:
            return ()
        return tuple(joint.name for joint in description.joints if joint.drivable)

    def joint(self, model: str, joint: str) -> JointHandle:
        """A handle to a joint, valid until the next compilation.

        Raises:
            UnknownNameError: The model or joint does not exist, or the joint cannot move.
        """
        self._bind()
        handle = self._joints.get((model, joint))
        if handle is None:
            known = self.joints(model)
            if joint not in known:
                raise UnknownNameError("joint", joint, known, code=world_codes.UNKNOWN_JOINT)
            handle = self._joints[model, joint] = JointHandle(model, joint)
            handle.bind(self._engine.model, self._engine.data)
        return handle

    def effort(self, model: str, joint: str) -> float:
        """Effort on a joint by its drive and by `set_efforts`, N m or N.

        Raises:
            UnknownNameError: The model or joint does not exist, or the joint cannot move.
        """
        handle = self.joint(model, joint)
        self._engine.refresh()
        return handle.effort + self._forces.effort_on(model, joint)

    def set_joint_velocities(self, model: str, velocities: Mapping[str, float]) -> None:
        """Sets the velocities of joints, rad/s or m/s. Joints that mimic them follow.

        Raises:
            UnknownNameError: The model or a joint does not exist, or a joint cannot move.
            CartwheelError: A number is not finite or too large.
        """
        for joint, velocity in velocities.items():
            self.joint(model, joint)
            number(velocity, f'the velocity of joint "{joint}"')
        self._engine.commanded += 1
        all_velocities = with_mimics(self.description(model), velocities, offsets=False)
        for joint, velocity in all_velocities.items():
            self.joint(model, joint).velocity = velocity
        self._engine.note_change()

    def set_efforts(self, model: str, efforts: Mapping[str, float]) -> None:
        """Applies efforts to joints, N m or N, until they are set again.

        They are added to the efforts of the joints' drives.

        Raises:
            UnknownNameError: The model or a joint does not exist, or a joint cannot move.
            CartwheelError: A number is not finite or too large.
        """
        for joint, effort in efforts.items():
            self.joint(model, joint)
            number(effort, f'the effort on joint "{joint}"', most=STRONGEST)
        for joint, effort in efforts.items():
            self._forces.clear_efforts(model, joint)
            if effort:
                self._forces.effort(model, joint, effort)
        self._apply_forces()

    def gains(self, model: str, joint: str) -> Any:
        """The gains of a joint's PID controller; None without one.

        Raises:
            UnknownNameError: The model or joint does not exist, or the joint cannot move.
        """
        self.joint(model, joint)
        tuned = self._population.resident(model).part.tuned
        return next((each.gains for name, each in reversed(tuned) if name == joint), None)

    def set_gains(self, model: str, joint: str, gains: Mapping[str, float]) -> bool:
        """Changes gains of a joint's PID controllers; returns whether it has one.

        Raises:
            UnknownNameError: The model or joint does not exist, or the joint cannot move.
        """
        self.joint(model, joint)
        tuned = self._population.resident(model).part.tuned
        controllers = [each for name, each in tuned if name == joint]
        for each in controllers:
            each.gains = replace(each.gains, **gains)
        return bool(controllers)

    # -- contacts

    def contacts(self, counts: Callable[[Place, Place], bool] | None = None) -> Sequence[Touch]:
        """The contacts between models and between links, in the current state.

        Args:
            counts: Whether a contact of two collisions is returned; None returns all.
        """
        entries = [each.entry for each in self._population.residents.values()]
        return self._touches.read(entries, counts)

    def _bind(self) -> None:
        """Forgets the handles after a compilation."""
        if self._model is not self._engine.model:
            self._model = self._engine.model
            self._links, self._joints = {}, {}


def _fixed(model: str, link: str = "") -> SimulationError:
    what = f'link "{link}" of model "{model}"' if link else f'model "{model}"'
    return SimulationError(
        f"{what} is fixed to the world",
        code=world_codes.FIXED_TO_WORLD,
        values={"model": model, "link": link},
    )
