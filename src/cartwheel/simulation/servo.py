"""A joint that is driven by effort, velocity or position, whichever is commanded."""

from __future__ import annotations

import math
from typing import Any, Literal

import mujoco

from cartwheel.world.entry import ROTOR, Motor, scoped

_OBJ = mujoco.mjtObj
Mode = Literal["idle", "effort", "velocity", "position"]

POSITION_BANDWIDTH = 50.0
"""1/s: an error of position falls to 1/e in 20 ms."""
_BRAKING = 0.5
"""Of the effort, what a joint that is far from its position plans to brake with."""


class ServoHandle:
    """Gives an effort, or holds a velocity or a position with limited effort.

    Velocities and positions are held by dry friction with a rotor, as by a `MotorHandle`: exact
    below the limit, whatever the joint bears.

    A drive may turn the same joint, as in Gazebo, where each joint has one motor and takes efforts
    beside it: then the motor is the drive's as long as no velocity or position is commanded here.
    """

    shared = False
    """Whether a drive turns the joint as well."""

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
        """Gives N m or N, less what a damping in N m s/rad or N s/m takes."""
        self._give("effort", effort, damping)

    def command_velocity(self, velocity: float) -> None:
        """Holds rad/s or m/s."""
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
        """Goes to rad or m, and stays there.

        Args:
            position: Where to.
            velocity: By which the position goes on to change, rad/s or m/s.
            max_velocity: Of the joint, rad/s or m/s.
            max_effort: N m or N, where it is to be less than the motor's.
        """
        self._target, self._rate = position, velocity
        self._fastest, self._limit = max_velocity, max_effort
        self._lead()

    @property
    def turns(self) -> bool:
        """Whether it gives an effort or turns the joint."""
        return self.mode != "idle" and (self._law[0] != 0.0 or self._turning != 0.0)

    @property
    def follows(self) -> bool:
        """Whether `follow` has anything to do."""
        return self.mode == "position"

    def follow(self) -> None:
        """Leads the joint on to its position; called at every step."""
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
