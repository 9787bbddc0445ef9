"""A joint with effort, velocity or position commands."""

from __future__ import annotations

import math
from typing import Any, Literal

import mujoco

from cartwheel.world.entry import ROTOR, Motor, scoped

_OBJ = mujoco.mjtObj
Mode = Literal["idle", "effort", "velocity", "position"]

POSITION_BANDWIDTH = 50.0
"""1/s; a position error decreases to 1/e in 20 ms."""
_BRAKING = 0.5
"""Fraction of the effort that is used to plan braking far from the target position."""


class ServoHandle:
    """Applies an effort, or holds a velocity or position with limited effort.

    Velocities and positions are held by dry friction with a rotor, as in a `MotorHandle`: exact
    below the effort limit, whatever the load.

    A drive plugin may drive the same joint. As in Gazebo, the joint then has one motor plus
    efforts: the drive uses the motor while no velocity or position is commanded here.
    """

    shared = False
    """Whether a drive plugin also drives the joint."""

    def __init__(self, model: str, motor: Motor) -> None:
        self.model_name = model
        self.motor = motor
        self.mode: Mode = "idle"
        self._law = (0.0, 0.0)
        self._turning = 0.0
        self._target = self._rate = 0.0
        self._fastest = self._limit = math.inf

    def bind(self, model: Any, data: Any) -> None:
        """Resolves the name in a compiled model."""
        name = scoped(self.model_name, self.motor.joint)
        rotor = scoped(self.model_name, self.motor.joint, ROTOR)
        self.id = mujoco.mj_name2id(model, _OBJ.mjOBJ_ACTUATOR, name)
        joint = mujoco.mj_name2id(model, _OBJ.mjOBJ_JOINT, name)
        self._qpos, self._position = data.qpos, int(model.jnt_qposadr[joint])
        self._qvel = data.qvel
        self._step = float(model.opt.timestep)
        turned = mujoco.mj_name2id(model, _OBJ.mjOBJ_JOINT, rotor)
        self._rotor = int(model.jnt_dofadr[turned])
        self._ctrl = data.ctrl
        self._bias = model.actuator_biasprm[self.id]
        self._grip = model.tendon_frictionloss
        self._tendon = mujoco.mj_name2id(model, _OBJ.mjOBJ_TENDON, rotor)
        self._strength = float(self._grip[self._tendon])
        inertia = float(model.dof_M0[int(model.jnt_dofadr[joint])])
        self._braking = _BRAKING * self._strength / max(inertia, 1e-9)
        self._apply()

    def release(self) -> None:
        """Lets the joint move freely."""
        self._give("idle", 0.0, 0.0)

    def command_effort(self, effort: float, *, damping: float = 0.0) -> None:
        """Applies an effort in N m or N, minus the damping in N m s/rad or N s/m times the
        velocity.
        """
        self._give("effort", effort, damping)

    def command_velocity(self, velocity: float) -> None:
        """Holds a velocity in rad/s or m/s."""
        self._limit = math.inf
        self._turn("velocity", velocity)

    def command_position(
        self,
        position: float,
        *,
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
        self._target, self._rate = position, velocity
        self._fastest, self._limit = max_velocity, max_effort
        self._lead()

    @property
    def turns(self) -> bool:
        """Whether it applies an effort or drives the joint."""
        return self.mode != "idle" and (self._law[0] != 0.0 or self._turning != 0.0)

    @property
    def follows(self) -> bool:
        """Whether `follow` must be called."""
        return self.mode == "position"

    def follow(self) -> None:
        """Moves the joint toward its target position; called at every step."""
        self._target += self._rate * self._step
        self._lead()

    def _lead(self) -> None:
        error = self._target - float(self._qpos[self._position])
        speed = min(POSITION_BANDWIDTH * abs(error), math.sqrt(2 * self._braking * abs(error)))
        wanted = self._rate + math.copysign(speed, error)
        self._turn("position", min(max(wanted, -self._fastest), self._fastest))

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
        self._ctrl[self.id] = effort
        self._bias[2] = -damping
        holds = self.mode in ("velocity", "position")
        if holds:
            self._grip[self._tendon] = min(self._strength, self._limit)
        else:
            self._grip[self._tendon] = self._strength if self.shared else 0.0
        if holds or not self.shared:
            self._qvel[self._rotor] = self._turning
