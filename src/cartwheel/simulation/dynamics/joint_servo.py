"""A joint with effort, velocity or position commands."""

from __future__ import annotations

import math
from collections.abc import Callable
from math import sqrt
from typing import Any, Literal

import mujoco

from cartwheel.world.entry import ROTOR, Motor, scoped

_OBJ = mujoco.mjtObj
Mode = Literal["idle", "effort", "velocity", "position"]
Efforts = Literal["set", "added"]
"""How a plugin that commands nothing but efforts combines them with those of another one."""
_Command = tuple[Mode, tuple[float, float], float, float, float, float, float]
"""Mode, law, velocity of the rotor, target, its rate, maximum velocity and effort."""

POSITION_BANDWIDTH = 50.0
"""1/s; a position error decreases to 1/e in 20 ms."""
_BRAKING = 0.5
"""Fraction of the effort that is used to plan braking far from the target position."""


def _stay_awake() -> None:
    """The default of `ServoHandle.wake`."""


def ends_of(model: Any, joint: int) -> tuple[float, float] | None:
    """Returns the limits of a joint, rad or m; None without limits.

    Args:
        model: The compiled model.
        joint: Index of the joint.
    """
    lower, upper = model.jnt_range[joint].tolist()
    return (lower, upper) if model.jnt_limited[joint] else None


def inside(velocity: float, position: float, ends: tuple[float, float]) -> float:
    """Returns the velocity nearest to a commanded one that does not move a joint beyond its limits.

    Close to a limit, the joint approaches it as a target position. Beyond it, the joint returns.

    Args:
        velocity: Commanded velocity, rad/s or m/s.
        position: Position of the joint, rad or m.
        ends: Limits, rad or m.
    """
    lowest = POSITION_BANDWIDTH * (ends[0] - position)
    highest = POSITION_BANDWIDTH * (ends[1] - position)
    return min(max(velocity, lowest), highest)


class ServoHandle:
    """Applies an effort, or holds a velocity or position with limited effort.

    Velocities and positions are held by dry friction with a rotor, as in a `MotorHandle`: exact
    below the effort limit, whatever the load. A velocity does not move a joint beyond its limits,
    as in Gazebo: close to a limit, the joint approaches it as a target position.

    A drive plugin may drive the same joint. As in Gazebo, the joint then has one motor plus
    efforts: the drive uses the motor while no velocity or position is commanded here.
    """

    # They are read at every step: an object with so many attributes would keep them in a table.
    __slots__ = (
        "_applied", "_awake", "_bias", "_braking", "_commanded_again", "_ctrl", "_ends",
        "_fastest", "_first", "_grip", "_joint", "_joint_dof", "_law", "_limit", "_near",
        "_position", "_qpos", "_qvel", "_rate", "_rotor", "_step", "_strength", "_target",
        "_tendon", "_turning", "added", "alone", "efforts", "id", "mode", "model_name", "motor",
        "period", "rivalled", "shared", "wake", "yields",
    )  # fmt: skip

    def __init__(
        self, model: str, motor: Motor, *, yields: bool = False, efforts: Efforts | None = None
    ) -> None:
        self.model_name = model
        self.motor = motor
        self.efforts = efforts
        """How its efforts combine with those of another one; None if it commands more than efforts.
        """
        self.added = 0.0
        """The effort that another plugin adds, N m or N; see `add`."""
        self.shared = False
        """Whether a drive plugin also drives the joint."""
        self.alone = True
        """Whether no other handle drives the joint, so that the actuator keeps what was applied."""
        self.rivalled = False
        """Whether another handle, which does not yield, drives the joint."""
        self.period = math.inf
        """Time between two commands while a position is commanded, s; unlimited if unknown."""
        self.wake: Callable[[], None] = _stay_awake
        """Called when `follow` has to be called at every step from now on."""
        self.yields = yields
        """Whether the owner of the handle leaves the joint to others while it has no command."""
        self.mode: Mode = "idle"
        self._applied: Mode = "idle"
        """The mode in which `_apply` set the actuator; idle if it must be set again."""
        self._law = (0.0, 0.0)
        """The effort and its damping; see `command_effort`."""
        self._awake = False
        self._ends: tuple[float, float] | None = None
        """The joint's limits, rad or m; None without limits."""
        self._turning = 0.0
        self._target = self._rate = 0.0
        self._fastest = self._limit = math.inf
        self._first: _Command | None = None
        """The command that it had when the model was spawned."""

    def bind(self, model: Any, data: Any) -> None:
        """Resolves the name in a compiled model."""
        name = scoped(self.model_name, self.motor.joint)
        rotor = scoped(self.model_name, self.motor.joint, ROTOR)
        self.id = mujoco.mj_name2id(model, _OBJ.mjOBJ_ACTUATOR, name)
        joint = mujoco.mj_name2id(model, _OBJ.mjOBJ_JOINT, name)
        # Memory views contain Python floats, and are cheaper than arrays.
        self._qpos: Any = memoryview(data.qpos)
        self._qvel: Any = memoryview(data.qvel)
        self._position = int(model.jnt_qposadr[joint])
        self._step = float(model.opt.timestep)
        turned = mujoco.mj_name2id(model, _OBJ.mjOBJ_JOINT, rotor)
        self._rotor = int(model.jnt_dofadr[turned])
        self._ctrl: Any = memoryview(data.ctrl)
        self._bias = model.actuator_biasprm[self.id]
        self._grip = model.tendon_frictionloss
        self._tendon = mujoco.mj_name2id(model, _OBJ.mjOBJ_TENDON, rotor)
        self._strength = float(self._grip[self._tendon])
        self._joint_dof = int(model.jnt_dofadr[joint])
        self._joint = joint
        self._ends = ends_of(model, joint)
        self.weigh(model)
        self._commanded_again = self.period <= self._step
        if self._first is None:
            place = (self._target, self._rate, self._fastest, self._limit)
            self._first = (self.mode, self._law, self._turning, *place)
        if self._awake or (self.mode == "position" and not self._commanded_again):
            self._rouse()
        self._apply()

    def weigh(self, model: Any) -> None:
        """Reads the inertia that the joint moves, from a model in which masses have changed."""
        inertia = float(model.dof_M0[self._joint_dof])
        self._braking = 2 * (_BRAKING * self._strength / max(inertia, 1e-9))
        # Nearer to the target, `_braked` changes nothing. The margin exceeds all rounding errors,
        # and the product in `_braked` is not rounded to zero.
        near = self._braking / POSITION_BANDWIDTH**2 * (1.0 - 1e-9)
        self._near = near if self._braking >= 1.0 else 0.0

    def refresh(self, model: Any) -> None:
        """Reads the inertia and the limits of the joint, which may have changed."""
        self.weigh(model)
        velocity = self._turning if self._ends is None else self._rate
        self._ends = ends_of(model, self._joint)
        if self.mode == "velocity":
            self.command_velocity(velocity)

    def strengthen(self, model: Any, strength: float) -> None:
        """Continues with another maximum effort, N m or N."""
        self._strength = strength
        self.weigh(model)
        self._apply()

    def rewind(self) -> None:
        """Returns to the command that it had when the model was spawned, mostly none."""
        assert self._first is not None
        self.mode, self._law, self._turning = self._first[:3]
        self._target, self._rate, self._fastest, self._limit = self._first[3:]
        self._apply()

    def release(self) -> None:
        """Lets the joint move freely."""
        self._give("idle", 0.0, 0.0)

    def command_effort(self, effort: float, damping: float = 0.0) -> None:
        """Applies an effort in N m or N, minus the damping in N m s/rad or N s/m times the
        velocity.
        """
        if self._applied == "effort" and damping == self._law[1]:
            self._law = (effort, damping)
            self._ctrl[self.id] = effort + self.added
            self._qvel[self._rotor] = 0.0
        else:
            self._give("effort", effort, damping)

    def add(self, effort: float) -> None:
        """Adds an effort in N m or N to all that are commanded, until the next call."""
        self.added = effort
        self._apply()

    def command_velocity(self, velocity: float) -> None:
        """Holds a velocity in rad/s or m/s, but stops at the joint's limits."""
        if self._ends is not None:
            self._rate = velocity
            if not self._awake:
                self._rouse()
            velocity = inside(velocity, self._qpos[self._position], self._ends)
        if self._applied == "velocity":
            self._turning = self._qvel[self._rotor] = velocity
        else:
            self._limit = math.inf
            self._turn("velocity", velocity)

    def command_position(
        self,
        position: float,
        velocity: float = 0.0,
        max_velocity: float = math.inf,
        max_effort: float = math.inf,
    ) -> None:
        """Moves to a position in rad or m and holds it.

        Args:
            position: Target position.
            velocity: Velocity of the target itself, rad/s or m/s.
            max_velocity: Maximum joint velocity, rad/s or m/s.
            max_effort: N m or N, if lower than the motor's limit.
        """
        self._target, self._rate, self._fastest = position, velocity, max_velocity
        if max_effort != self._limit:
            self._limit = max_effort
            self._applied = "idle"
        if not (self._awake or self._commanded_again):
            self._rouse()
        # Comparisons take a quarter of the time of `abs`, `copysign`, `min` and `max`.
        error, near = position - self._qpos[self._position], self._near
        change = POSITION_BANDWIDTH * error
        if not -near < error < near:
            change = self._braked(error, change)
        wanted = velocity + change
        if -max_velocity > wanted:  # noqa: PLR1730
            wanted = -max_velocity
        if max_velocity < wanted:  # noqa: PLR1730
            wanted = max_velocity
        if self._applied == "position":
            self._turning = self._qvel[self._rotor] = wanted
        else:
            self._turn("position", wanted)

    @property
    def turns(self) -> bool:
        """Whether it applies an effort or drives the joint."""
        return self.mode != "idle" and (self._law[0] != 0.0 or self._turning != 0.0)

    def follow(self) -> None:
        """Moves the joint toward its target position, or stops it at a limit; called at every
        step.
        """
        if self.mode == "position":
            target = self._target + self._rate * self._step
            self.command_position(target, self._rate, self._fastest, self._limit)
        elif self.mode == "velocity" and self._ends is not None:
            self.command_velocity(self._rate)

    def _braked(self, error: float, velocity: float) -> float:
        """The velocity at a distance from the target, from which the motor can still brake."""
        if error < 0.0:
            return -min(-velocity, sqrt(self._braking * -error))
        return min(velocity, sqrt(self._braking * error))

    def _rouse(self) -> None:
        self._awake = True
        self.wake()

    def _give(self, mode: Mode, effort: float, damping: float) -> None:
        self.mode = mode
        self._law = (effort, damping)
        self._turning = 0.0
        self._apply()

    def _turn(self, mode: Mode, velocity: float) -> None:
        self.mode = mode
        self._law = (0.0, 0.0)
        self._turning = velocity
        self._apply()

    def _apply(self) -> None:
        effort, damping = self._law
        self._ctrl[self.id] = effort + self.added
        self._bias[2] = -damping
        holds = self.mode in ("velocity", "position")
        if holds:
            self._grip[self._tendon] = min(self._strength, self._limit)
        else:
            self._grip[self._tendon] = self._strength if self.shared else 0.0
        if holds or not self.shared:
            self._qvel[self._rotor] = self._turning
        self._applied = self.mode if self.alone else "idle"
