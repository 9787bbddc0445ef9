"""Motors that hold a velocity, within the limits of their joints."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import mujoco

from cartwheel.simulation.dynamics.joint_servo import ServoHandle, ends_of, inside
from cartwheel.world.entry import ROTOR, Motor, scoped

_OBJ = mujoco.mjtObj


def _stay_awake() -> None:
    """The default of `JointStop.wake`."""


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

    def __init__(self, model: str, joint: str, servos: Callable[[], Sequence[ServoHandle]]) -> None:
        self.model_name = model
        self.name = joint
        self.wake: Callable[[], None] = _stay_awake
        """Called when `follow` has to be called at every step from now on."""
        self._find_servos = servos
        self._servos: Sequence[ServoHandle] = ()
        self.command: list[float] = [0.0]
        """The last commanded velocity, rad/s or m/s, while the joint has limits."""
        self.ends: tuple[float, float] | None = None
        """The limits of the joint, rad or m; None without limits."""
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
        self.refresh(model)

    def refresh(self, model: Any) -> None:
        """Reads the limits of the joint, which may have changed."""
        had, self.ends = self.ends is not None, ends_of(model, self._joint)
        self._turning = math.nan
        if self.ends is None:
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
        return (self._qvel, self._rotor) if self.ends is None else (self.command, 0)

    def rests(self) -> bool:
        """Whether `follow` would change nothing until there is another command."""
        ends = self.ends
        if ends is None:
            return True
        if self.command[0] != 0.0 or self._turning != 0.0:
            return False
        return bool(ends[0] <= self._qpos[self._position] <= ends[1])

    def follow(self) -> None:
        """Turns the rotor; called at every step, after all commands."""
        if self.ends is None:
            return
        for servo in self._servos:
            if servo.mode in ("velocity", "position"):
                self._turning = math.nan
                return
        velocity = inside(self.command[0], self._qpos[self._position], self.ends)
        if velocity != self._turning:
            # While it is the same, the bits do not depend on how often this runs.
            self._turning = self._qvel[self._rotor] = velocity

    def hold(self) -> None:
        """Sets the velocity of the rotor again; see `Rotors`."""
        if self.ends is not None and not math.isnan(self._turning):
            self._qvel[self._rotor] = self._turning


class MotorHandle:
    """A joint driven at a velocity with limited effort; it brakes at zero velocity.

    As in Gazebo, dry friction acts between the joint and a rotor that turns at the target velocity.
    The joint velocity is exact below the effort limit; at the limit, the joint slips. A joint with
    position limits stops at them.

    Args:
        motor: The motor.
        stop: Stops the motor at the joint's limits; bound before this handle.
        yields: Whether the owner of the handle leaves the joint to others while it has no command.
        repeats: Whether its owner commands the joint at each update; see `overrule`.
    """

    rivalled = False
    """Whether another handle, which does not yield, drives the joint."""
    overruled = False
    """Whether the commands have no effect; see `overrule`."""

    def __init__(
        self, motor: Motor, stop: JointStop, *, yields: bool = False, repeats: bool = False
    ) -> None:
        self.motor = motor
        self.stop = stop
        self.repeats = repeats
        self.yields = yields
        """Whether the owner of the handle leaves the joint to others while it has no command."""
        self.target = 0.0
        # Until the model is compiled, commands are only stored.
        self.rotors: Any = [0.0]
        """Velocities of the compiled model, or the commands of a joint with limits; `dof` is the
        index of this motor's rotor. A caller at a high rate may set both this velocity and `target`
        itself, which is what `command` does."""
        self.dof = 0

    def bind(self, model: Any, data: Any) -> None:  # noqa: ARG002 - all handles bind alike
        """Writes commands to a compiled model from now on."""
        self.refresh(model)
        if not (self.yields and self.rivalled):
            self.command(self.target)

    def refresh(self, model: Any) -> None:  # noqa: ARG002 - handles are refreshed alike
        """Finds where to write commands, after the limits of the joint may have changed."""
        if not self.overruled:
            self.rotors, self.dof = self.stop.place

    def overrule(self) -> None:
        """Makes the commands ineffective, because a later handle repeats its own at each update."""
        self.overruled = True
        self.rotors, self.dof = [0.0], 0

    def restore(self) -> None:
        """Makes the commands effective again."""
        self.overruled = False
        self.rotors, self.dof = self.stop.place
        self.command(self.target)

    @property
    def turns(self) -> bool:
        """Whether the commanded velocity is nonzero."""
        return self.target != 0.0

    def command(self, target: float) -> None:
        """Sets the target velocity, rad/s or m/s."""
        self.target = target
        self.rotors[self.dof] = target
