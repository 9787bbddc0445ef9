"""The compiled model with its state and time, owned by the simulation's thread."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from typing import Any

import mujoco
import numpy as np

from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.errors import Diagnostic, SimulationError
from cartwheel.geometry import Array, Pose, Quat, Vec3, from_wxyz, quat_conjugate, rotate, to_wxyz
from cartwheel.simulation.carried_state import STATE_SIZES, carry_over
from cartwheel.simulation.clock import Task, Topic, to_ns
from cartwheel.simulation.computed import Computed
from cartwheel.simulation.dynamics.carried import LOOK
from cartwheel.simulation.dynamics.friction_directions import Directions
from cartwheel.simulation.dynamics.stepping import Stepping
from cartwheel.simulation.sensing.embree_rays import SharedRayScenes
from cartwheel.simulation.sensing.rendering import Renderer
from cartwheel.simulation.sensing.visual_model import VisualModel
from cartwheel.world.additions import Addition
from cartwheel.world.build import step_of
from cartwheel.world.contact import Bounce
from cartwheel.world.entry import ModelEntry, scoped
from cartwheel.world.pairs import Alignment

_OBJ = mujoco.mjtObj
_UNIT = mujoco.mjMINVAL / 2
"""Difference of a quaternion's length from 1 up to which MuJoCo surely takes it as it is."""
_STILL: Vec3 = (0.0, 0.0, 0.0)


class Engine(Computed):
    """MuJoCo's model and data with integer time.

    Args:
        world: The world; sets the time step.
        seed: Seed for all noise.
        without: Additions to the descriptions that are omitted.
    """

    def __init__(
        self, world: WorldDescription, seed: int, without: Collection[Addition] = ()
    ) -> None:
        super().__init__()
        self.world = world
        self.seed = seed
        self.without = without
        self.step_ns = to_ns(step_of(world))
        self.time_ns = 0
        """Simulation time."""
        self.step = 0
        """Steps since `origin_ns`."""
        self.origin_ns = 0
        """The time of the last change of the step length; initially zero."""
        self.commanded = 0
        """Number of external actions: moves, pushes and drive commands."""
        self.rewinds = 0
        """Number of time resets."""
        self.served_ns = -1
        """The last time at which the due tasks ran before the step that starts there; see
        `Simulation.complete`."""
        self.served_tasks = 0
        """Number of tasks that had been created then."""
        self.tasks_created = 0
        """Number of tasks created so far, which is the order of the next one."""
        self.visuals = VisualModel()
        self.ray_scenes = SharedRayScenes()
        self.renderer = Renderer(self.visuals)
        self.diagnostics: list[Diagnostic] = list(world.diagnostics)
        self.on_diagnostic: list[Callable[[Diagnostic], None]] = []
        self.on_fault: Callable[[object, BaseException], None] = _raise
        """Called with a failed plugin and its error."""
        self.on_tasks: list[Callable[[], None]] = []
        """Called after a task was replaced."""
        self.on_entries: list[Callable[[], None]] = []
        """Called after an addition to a model that is already compiled."""
        self.directions: Directions | None = None
        self.revisions = 0
        """Changes of the model alone."""
        self._places: dict[tuple[str, str], tuple[Array, Array]] = {}
        """Positions and orientations of links in the data, by model and link."""
        self._free: dict[tuple[str, str], Array | None] = {}
        """Coordinates of links with a free joint in the data, shape (7,); None for other links."""
        self._inverses: dict[str, tuple[RobotDescription, Pose | None]] = {}
        """The description of each model, and the inverse of the pose of its canonical link; None
        for the identity, as in a URDF."""
        self.entries: Sequence[ModelEntry] = ()
        """The models in the world."""

    def close(self) -> None:
        """Frees rendering resources and removes all callbacks."""
        self.renderer.close()
        self.visuals.forget()
        self.on_fault = _raise
        for listeners in (self.on_diagnostic, self.on_tasks, self.on_entries):
            listeners.clear()

    def steps_until(self, time_ns: int) -> int:
        """Number of steps until `time_ns` is reached or just exceeded."""
        return -((self.time_ns - time_ns) // self.step_ns)

    def set_step(self, step_ns: int) -> None:
        """Changes the step length; the model must be compiled for it."""
        self.origin_ns, self.step, self.step_ns = self.time_ns, 0, step_ns

    def task(
        self,
        rate: float,
        *,
        before: Callable[[], None] | None,
        after: Callable[[], None] | None,
        active: Callable[[], bool],
        topics: Collection[Topic] | None,
        idle: Callable[[], bool] | None = None,
    ) -> Task:
        """Creates a task that runs after all earlier tasks; see `Task`."""
        self.tasks_created += 1
        return Task(
            rate=rate,
            before=before,
            after=after,
            active=active,
            topics=topics,
            idle=idle,
            order=self.tasks_created - 1,
        )

    def wake(self, task: Task) -> None:
        """Makes a task due from the next step on."""
        task.asleep = False
        for callback in self.on_tasks:
            callback()

    def report(self, diagnostic: Diagnostic) -> None:
        """Stores a diagnostic and passes it to all callbacks."""
        self.diagnostics.append(diagnostic)
        for callback in self.on_diagnostic:
            callback(diagnostic)

    def replace(
        self,
        model: Any,
        alignments: Sequence[Alignment] = (),
        bounces: Sequence[Bounce] = (),
        compile_visuals: Callable[[], Any] | None = None,
    ) -> None:
        """Replaces the model and keeps the state of every joint that exists in both models.

        Args:
            model: The MuJoCo model.
            alignments: Friction directions.
            bounces: Surfaces with restitution.
            compile_visuals: See `VisualModel.bind`.
        """
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        data = mujoco.MjData(model)
        if self.model is not None:
            carry_over(self.model, self.data, model, data)
        self.model, self.data = model, data
        self.align(alignments)
        self._bind(Stepping(model, data, bounces))
        # Otherwise nothing would look for such bodies again, and each step would take longer.
        self.carries = self.carries and self.stepping.carried is not None
        self.visuals.bind(model, data, compile_visuals)
        self._places.clear()
        self._free.clear()
        self._inverses.clear()

    def save(self) -> dict[str, Any]:
        """The engine's own numbers, without model and data, for `restore`."""
        return {
            name: value
            for name, value in vars(self).items()
            if isinstance(value, int | float | bytes) and name != "rewinds"
        }

    def restore(self, saved: dict[str, Any]) -> None:
        """Sets the saved numbers, after the model and the data were restored."""
        # Signatures of before must not return for other states.
        changes, before = self.changes + 1, saved["changes"].to_bytes(8)
        vars(self).update(saved, changes=changes, revisions=self.revisions + 1)
        now = self.signature()
        for name in ("_posed", "_located", "refreshed"):
            if saved[name] == now.removesuffix(changes.to_bytes(8)) + before:
                setattr(self, name, now)

    def align(self, alignments: Sequence[Alignment]) -> None:
        """Sets the friction directions of the model."""
        try:
            self.directions = Directions(self.model, alignments)
        except SimulationError as error:
            self.report(error.diagnostic("warning"))

    def advance(self, count: int, forwarded: bool) -> None:
        """Runs simulation steps.

        Args:
            count: At least 1.
            forwarded: Whether the forward pass of the current state is done, so that the first step
                only integrates. The results are bit-identical in both cases.
        """
        self.refreshed = b""
        looking = self.stepping.carried
        if looking is None:
            self.step += count
            self.time_ns += count * self.step_ns
            self.stepping.run(count, forwarded, self.carries)
            return
        while count:
            piece = min(count, LOOK - self.step % LOOK)
            self.step += piece
            self.time_ns += piece * self.step_ns
            self.stepping.run(piece, forwarded, self.carries)
            count, forwarded = count - piece, False
            # At the same steps however a run is divided, which therefore has the same bits.
            if self.step % LOOK == 0:
                self.carries = looking.any_turn(self.data)

    def rewind(self, *, keep_time: bool = False, prepare: Callable[[], None]) -> None:
        """Resets all joints to their initial state, and time to zero.

        Args:
            keep_time: Do not reset time.
            prepare: If time is reset, called before the forces of the initial state are computed.
        """
        time = self.data.time
        self.changes += 1
        self.carries = False
        mujoco.mj_resetData(self.model, self.data)
        if keep_time:
            self.data.time = time
        else:
            self.time_ns = self.step = self.origin_ns = 0
            self.served_ns = -1
            self.rewinds += 1
            prepare()
        self.forward()

    def body_id(self, model: str, link: str) -> int:
        """The index of a link's body."""
        return int(mujoco.mj_name2id(self.model, _OBJ.mjOBJ_BODY, scoped(model, link)))

    def joint_id(self, model: str, joint: str) -> int:
        """The index of a joint, or -1; the free joint of a model's root is named after its link."""
        return int(mujoco.mj_name2id(self.model, _OBJ.mjOBJ_JOINT, scoped(model, joint)))

    def link_pose(self, model: str, link: str) -> Pose:
        """A link's frame in the world, from the last forward pass."""
        place = self._places.get((model, link))
        if place is None:
            body = self.body_id(model, link)
            place = self._places[model, link] = self.data.xpos[body], self.data.xquat[body]
        x, y, z = place[0].tolist()
        qw, qx, qy, qz = place[1].tolist()
        return Pose((x, y, z), (qx, qy, qz, qw))

    def model_pose(self, entry: ModelEntry) -> Pose:
        """A model's frame in the world, fixed to its canonical link (the root link in URDF)."""
        link = self.link_pose(entry.name, entry.description.canonical_link)
        inverse = self._inverse(entry)
        return link if inverse is None else link @ inverse

    def current_place(self, entry: ModelEntry) -> tuple[Vec3, Quat]:
        """A model's frame in the world in the current state, as plain tuples for high-rate access.

        It has the same bits as `model_pose` after `refresh_poses`. If the canonical link has a free
        joint, as those of all robots that are not fixed, no other pose is computed.
        """
        name, link = entry.name, entry.description.canonical_link
        try:
            free = self._free[name, link]
        except KeyError:
            free = self._free[name, link] = self._coordinates(name, link)
        if free is None:
            self.refresh_poses()
            pose = self.model_pose(entry)
            return pose.position, pose.orientation
        x, y, z, qw, qx, qy, qz = free.tolist()
        length = math.sqrt(qw * qw + qx * qx + qy * qy + qz * qz)
        # MuJoCo does not change a unit quaternion. Its length there may differ by rounding.
        if not -_UNIT < length - 1.0 < _UNIT:
            turned = np.array([qw, qx, qy, qz])
            mujoco.mju_normalize4(turned)
            qw, qx, qy, qz = turned.tolist()
        inverse = self._inverse(entry)
        if inverse is None:
            return (x, y, z), (qx, qy, qz, qw)
        pose = Pose((x, y, z), (qx, qy, qz, qw)) @ inverse
        return pose.position, pose.orientation

    def _inverse(self, entry: ModelEntry) -> Pose | None:
        """The inverse of the pose of a model's canonical link; None for the identity."""
        description = entry.description
        known = self._inverses.get(entry.name)
        if known is None or known[0] is not description:
            pose = description.canonical_pose
            known = description, None if pose == Pose() else pose.inverse()
            self._inverses[entry.name] = known
        return known[1]

    def _coordinates(self, model: str, link: str) -> Array | None:
        """The position and the quaternion of a link's free joint in the data; None without one."""
        joint = self.free_joint(model, link)
        if joint < 0:
            return None
        first = int(self.model.jnt_qposadr[joint])
        found: Array = self.data.qpos[first : first + 7]
        return found

    def free_joint(self, model: str, link: str) -> int:
        """The index of the free joint of a link, or -1."""
        joint = self.joint_id(model, link)
        free = joint >= 0 and self.model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE
        return joint if free else -1

    def is_free(self, model: str, link: str) -> bool:
        """Whether a link moves with a free joint, which may be that of a link to which it is fixed
        or jointed: the first link of an SDF model need not be the root of its joints.
        """
        body = self.body_id(model, link)
        if body < 0:
            return False
        joint = self.model.body_jntadr[self.model.body_rootid[body]]
        return bool(joint >= 0 and self.model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE)

    def place(self, joint: int, pose: Pose, linear: Vec3 = _STILL, angular: Vec3 = _STILL) -> None:
        """Moves the body of a free joint and sets its frame's velocity.

        Args:
            joint: Joint index.
            pose: Pose in the world.
            linear: m/s, in world axes.
            angular: rad/s, in world axes.
        """
        position = self.model.jnt_qposadr[joint]
        self.data.qpos[position : position + 3] = pose.position
        self.data.qpos[position + 3 : position + 7] = to_wxyz(pose.orientation)
        self.set_velocity(joint, linear, angular)
        self.forward()

    def set_velocity(self, joint: int, linear: Vec3, angular: Vec3) -> None:
        """Sets the velocity of a free joint's frame, in m/s and rad/s, in world axes."""
        position, velocity = self.model.jnt_qposadr[joint], self.model.jnt_dofadr[joint]
        self.data.qvel[velocity : velocity + 3] = linear
        # MuJoCo uses body axes for a free body's angular velocity.
        turned = from_wxyz(self.data.qpos[position + 3 : position + 7].tolist())
        self.data.qvel[velocity + 3 : velocity + 6] = rotate(quat_conjugate(turned), angular)

    def set_joint(self, joint: int, position: float) -> None:
        """Sets the position of a joint with one degree of freedom and stops the joint."""
        self.data.qpos[self.model.jnt_qposadr[joint]] = position
        self.data.qvel[self.model.jnt_dofadr[joint]] = 0.0

    def joint_state(self, model: str, joint: str) -> tuple[list[float], list[float]]:
        """Positions in rad or m and velocities of a joint's axes; empty for joints without hinge
        axes.
        """
        positions, rates = [], []
        for name in (joint, f"{joint}::axis2"):
            index = self.joint_id(model, name)
            if index >= 0 and int(self.model.jnt_type[index]) not in STATE_SIZES:
                positions.append(self.joint_position(index))
                rates.append(float(self.data.qvel[self.model.jnt_dofadr[index]]))
        return positions, rates

    def joint_position(self, joint: int) -> float:
        """Position of a joint with one degree of freedom, rad or m."""
        return float(self.data.qpos[self.model.jnt_qposadr[joint]])


def _raise(_: object, error: BaseException) -> None:
    raise error
