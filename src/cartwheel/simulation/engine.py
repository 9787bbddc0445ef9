"""The compiled model, its state and its time: what the simulation's thread owns."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import Any

import mujoco

from cartwheel.codes import world as world_codes
from cartwheel.description.model import WorldDescription
from cartwheel.errors import Diagnostic, SimulationError
from cartwheel.geometry import Pose, Vec3, from_wxyz, quat_conjugate, rotate, to_wxyz
from cartwheel.simulation.bouncing import Bounces
from cartwheel.simulation.clock import Task, to_ns
from cartwheel.simulation.directions import Directions
from cartwheel.simulation.rendering import Renderer
from cartwheel.world.build import step_of
from cartwheel.world.contact import Bounce
from cartwheel.world.entry import ModelEntry, scoped
from cartwheel.world.pairs import Alignment

_OBJ = mujoco.mjtObj
_STILL: Vec3 = (0.0, 0.0, 0.0)
# By number: numpy's integers equal the enumeration's, yet do not find them in a mapping.
_STATE_SIZES = {mujoco.mjtJoint.mjJNT_FREE.value: (7, 6), mujoco.mjtJoint.mjJNT_BALL.value: (4, 3)}


class Engine:
    """MuJoCo's model and data with integer time.

    Args:
        world: Its step length counts.
        seed: Of all noise.
    """

    def __init__(self, world: WorldDescription, seed: int) -> None:
        self.world = world
        self.seed = seed
        self.step_ns = to_ns(step_of(world))
        self.time_ns = 0
        """Simulation time."""
        self.step = 0
        """Steps made since `origin_ns`."""
        self.origin_ns = 0
        """When the present length of a step began to count; time zero at first."""
        self.commanded = 0
        """How often something from outside moved, pushed or drove anything."""
        self.rewinds = 0
        """How often time went back to zero."""
        self.model: Any = None
        self.data: Any = None
        self.renderer = Renderer()
        self.diagnostics: list[Diagnostic] = list(world.diagnostics)
        self.on_diagnostic: list[Callable[[Diagnostic], None]] = []
        self.on_fault: Callable[[object, Exception], None] = _raise
        """Called with a plugin that failed, and its error."""
        self.on_tasks: list[Callable[[], None]] = []
        """Called after a task was changed for another."""
        self.on_entries: list[Callable[[], None]] = []
        """Called after something more was asked to be built into a model that stands already."""
        self.entries: Sequence[ModelEntry] = ()
        """The models that stand in the world."""
        self._orders = itertools.count()

    def close(self) -> None:
        """Frees what drawing holds; calls nobody any more."""
        self.renderer.close()
        self.on_fault = _raise
        for listeners in (self.on_diagnostic, self.on_tasks, self.on_entries):
            listeners.clear()

    def steps_until(self, time_ns: int) -> int:
        """Steps that bring time to `time_ns`, or just beyond it."""
        return -((self.time_ns - time_ns) // self.step_ns)

    def set_step(self, step_ns: int) -> None:
        """Makes steps of another length from now on; the model must be compiled for it."""
        self.origin_ns, self.step, self.step_ns = self.time_ns, 0, step_ns

    def task(
        self,
        rate: float,
        *,
        before: Callable[[], None] | None,
        after: Callable[[], None] | None,
        active: Callable[[], bool],
    ) -> Task:
        """A task that runs after all that were made before it; see `Task`."""
        return Task(
            rate=rate,
            before=before,
            after=after,
            active=active,
            order=next(self._orders),
        )

    def report(self, diagnostic: Diagnostic) -> None:
        """Keeps a diagnostic, and passes it to all callbacks."""
        self.diagnostics.append(diagnostic)
        for callback in self.on_diagnostic:
            callback(diagnostic)

    def replace(
        self, model: Any, alignments: Sequence[Alignment] = (), bounces: Sequence[Bounce] = ()
    ) -> None:
        """Goes on with another model, with the state of every joint that both have.

        Args:
            model: MuJoCo's.
            alignments: In which directions friction counts.
            bounces: The surfaces that bounce.
        """
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
        data = mujoco.MjData(model)
        if self.model is not None:
            _carry_over(self.model, self.data, model, data)
        self.model, self.data = model, data
        try:
            self._directions = Directions(model, data, alignments)
        except SimulationError as error:
            self.report(error.diagnostic("warning"))
        self._bounces = Bounces(model, bounces) if len(bounces) > 1 else None
        self.renderer.bind(model)

    def forward(self) -> None:
        """Makes poses, contacts and forces those of the present state; changes no state.

        Raises:
            SimulationError: The contacts need more memory than there is.
        """
        try:
            mujoco.mj_forward(self.model, self.data)
        except mujoco.FatalError as error:
            raise self._exhausted(error) from None

    def locate(self) -> None:
        """Makes poses and velocities those of the present state, and nothing else."""
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_comVel(self.model, self.data)

    def advance(self, count: int, *, forwarded: bool) -> None:
        """Makes steps.

        Args:
            count: At least 1.
            forwarded: The forward pass of the present state is done: of the first step only
                the integration is missing. Both ways give the same bits.
        """
        self.step += count
        self.time_ns += count * self.step_ns
        if self._bounces is not None:
            for each in range(count):
                if each or not forwarded:
                    self.forward()
                if self._bounces.apply(self.model, self.data):
                    self.forward()
                mujoco.mj_Euler(self.model, self.data)
            return
        try:
            if forwarded:
                mujoco.mj_Euler(self.model, self.data)
                count -= 1
            if count:
                mujoco.mj_step(self.model, self.data, count)
        except mujoco.FatalError as error:
            raise self._exhausted(error) from None

    def _exhausted(self, error: Exception) -> SimulationError:
        return SimulationError(
            f"the simulation cannot continue with {self.data.ncon} contacts: "
            f"{str(error).splitlines()[0]}",
            code=world_codes.TOO_MANY_CONTACTS,
            hint="Check whether models overlap.",
            values={"contacts": int(self.data.ncon)},
        )

    def rewind(self, *, keep_time: bool = False) -> None:
        """Everything where it was placed, and time zero unless it shall go on."""
        time = self.data.time
        mujoco.mj_resetData(self.model, self.data)
        if keep_time:
            self.data.time = time
        else:
            self.time_ns = self.step = self.origin_ns = 0
            self.rewinds += 1
        self.forward()

    def body_id(self, model: str, link: str) -> int:
        """The index of a link."""
        return int(mujoco.mj_name2id(self.model, _OBJ.mjOBJ_BODY, scoped(model, link)))

    def joint_id(self, model: str, joint: str) -> int:
        """The index of a joint, or -1; a free model's root has one of its link's name."""
        return int(mujoco.mj_name2id(self.model, _OBJ.mjOBJ_JOINT, scoped(model, joint)))

    def link_pose(self, model: str, link: str) -> Pose:
        """A link's frame in the world, as of the last forward pass."""
        body = self.body_id(model, link)
        x, y, z = self.data.xpos[body].tolist()
        return Pose((x, y, z), from_wxyz(self.data.xquat[body].tolist()))

    def model_pose(self, entry: ModelEntry) -> Pose:
        """A model's frame in the world: it goes with its canonical link, a URDF's root."""
        link = self.link_pose(entry.name, entry.description.canonical_link)
        return link @ entry.description.canonical_pose.inverse()

    def free_joint(self, model: str, link: str) -> int:
        """The index of the joint that leaves a link free in the world, or -1."""
        joint = self.joint_id(model, link)
        free = joint >= 0 and self.model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE
        return joint if free else -1

    def place(self, joint: int, pose: Pose, linear: Vec3 = _STILL, angular: Vec3 = _STILL) -> None:
        """Moves the body of a free joint, and sets the motion of its frame.

        Args:
            joint: Index.
            pose: In the world.
            linear: m/s, in the world's axes.
            angular: rad/s, in the world's axes.
        """
        position, velocity = self.model.jnt_qposadr[joint], self.model.jnt_dofadr[joint]
        self.data.qpos[position : position + 3] = pose.position
        self.data.qpos[position + 3 : position + 7] = to_wxyz(pose.orientation)
        self.data.qvel[velocity : velocity + 3] = linear
        # MuJoCo keeps a free body's turning in the body's own axes.
        turning = rotate(quat_conjugate(pose.orientation), angular)
        self.data.qvel[velocity + 3 : velocity + 6] = turning
        self.forward()

    def set_joint(self, joint: int, position: float) -> None:
        """Turns a joint of one degree of freedom, and stops it."""
        self.data.qpos[self.model.jnt_qposadr[joint]] = position
        self.data.qvel[self.model.jnt_dofadr[joint]] = 0.0

    def joint_state(self, model: str, joint: str) -> tuple[list[float], list[float]]:
        """Positions in rad or m and rates of a joint's axes; none where it turns about no axis."""
        positions, rates = [], []
        for name in (joint, f"{joint}::axis2"):
            index = self.joint_id(model, name)
            if index >= 0 and int(self.model.jnt_type[index]) not in _STATE_SIZES:
                positions.append(self.joint_position(index))
                rates.append(float(self.data.qvel[self.model.jnt_dofadr[index]]))
        return positions, rates

    def joint_position(self, joint: int) -> float:
        """Of a joint of one degree of freedom, rad or m."""
        return float(self.data.qpos[self.model.jnt_qposadr[joint]])


def _raise(_: object, error: Exception) -> None:
    raise error


def _carry_over(old_model: Any, old: Any, model: Any, data: Any) -> None:
    """Copies the state of every joint that both models have, by name."""
    data.time = old.time
    for index in range(model.njnt):
        name = mujoco.mj_id2name(model, _OBJ.mjOBJ_JOINT, index)
        before = mujoco.mj_name2id(old_model, _OBJ.mjOBJ_JOINT, name)
        if before < 0 or model.jnt_type[index] != old_model.jnt_type[before]:
            continue
        positions, velocities = _STATE_SIZES.get(int(model.jnt_type[index]), (1, 1))
        a, b = model.jnt_qposadr[index], old_model.jnt_qposadr[before]
        data.qpos[a : a + positions] = old.qpos[b : b + positions]
        a, b = model.jnt_dofadr[index], old_model.jnt_dofadr[before]
        for field in ("qvel", "qacc_warmstart"):
            getattr(data, field)[a : a + velocities] = getattr(old, field)[b : b + velocities]
