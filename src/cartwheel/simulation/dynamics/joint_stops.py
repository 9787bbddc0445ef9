"""The limits of joints that velocity motors drive."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import mujoco

from cartwheel.simulation.dynamics.joint_servo import ServoHandle, ends_of, inside
from cartwheel.world.entry import ROTOR, scoped

_OBJ = mujoco.mjtObj


class JointStop:
    """Stops a velocity motor at the limits of its joint, however strong the motor.

    The motor's commands for a joint with limits are stored here, and the rotor turns at a velocity
    that does not move the joint beyond its limits; see `ServoHandle`. The rotor of a joint without
    limits is commanded directly.

    Args:
        model: Model name.
        joint: Joint name.
        servos: Returns the servos that drive the same joint.
    """

    wake: Callable[[], None] = staticmethod(lambda: None)
    """Called when `follow` has to be called at every step from now on."""

    def __init__(self, model: str, joint: str, servos: Callable[[], Sequence[ServoHandle]]) -> None:
        self.model_name = model
        self.name = joint
        self._find_servos = servos
        self._servos: Sequence[ServoHandle] = ()
        self.command: list[float] = [0.0]
        """The last commanded velocity, rad/s or m/s, while the joint has limits."""
        self._ends: tuple[float, float] | None = None
        self._turning = math.nan
        """The velocity that the rotor has from here; NaN if it may have another one."""
        self._awake = False

    def bind(self, model: Any, data: Any) -> None:
        """Resolves the name in a compiled model."""
        rotor = scoped(self.model_name, self.name, ROTOR)
        self._joint = mujoco.mj_name2id(model, _OBJ.mjOBJ_JOINT, scoped(self.model_name, self.name))
        self._qpos: Any = memoryview(data.qpos)
        self._qvel: Any = memoryview(data.qvel)
        self._position = int(model.jnt_qposadr[self._joint])
        turned = mujoco.mj_name2id(model, _OBJ.mjOBJ_JOINT, rotor)
        self._rotor = int(model.jnt_dofadr[turned])
        self._servos = self._find_servos()
        self.limit(model)

    def limit(self, model: Any) -> None:
        """Reads the limits of the joint, which have changed."""
        had, self._ends = self._ends is not None, ends_of(model, self._joint)
        self._turning = math.nan
        if self._ends is None:
            if had:
                self._qvel[self._rotor] = self.command[0]
            return
        if not had:
            self.command[0] = self._qvel[self._rotor]
        if not self._awake:
            self._awake = True
            self.wake()

    @property
    def place(self) -> tuple[Any, int]:
        """An array for the motor's commands, and their index."""
        return (self._qvel, self._rotor) if self._ends is None else (self.command, 0)

    def rests(self) -> bool:
        """Whether `follow` would change nothing until there is another command."""
        ends = self._ends
        if ends is None:
            return True
        if self.command[0] != 0.0 or self._turning != 0.0:
            return False
        return bool(ends[0] <= self._qpos[self._position] <= ends[1])

    def follow(self) -> None:
        """Turns the rotor; called at every step, after all commands."""
        if self._ends is None:
            return
        for servo in self._servos:
            if servo.mode in ("velocity", "position"):
                self._turning = math.nan
                return
        velocity = inside(self.command[0], self._qpos[self._position], self._ends)
        if velocity != self._turning:
            # While it is the same, the bits do not depend on how often this runs.
            self._turning = self._qvel[self._rotor] = velocity

    def hold(self) -> None:
        """Sets the velocity of the rotor again; see `Rotors`."""
        if self._ends is not None and not math.isnan(self._turning):
            self._qvel[self._rotor] = self._turning
