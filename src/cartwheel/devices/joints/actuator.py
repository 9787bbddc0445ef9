"""A joint that follows position, velocity or effort commands within its limits."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import partial

from cartwheel.devices.elementwise import Number, remainder
from cartwheel.devices.joints.limits import (
    JointLimits,
    cut_range,
    limited_effort,
    limited_position,
    position_range,
    saturated,
    velocity_bounds,
)
from cartwheel.devices.joints.pid import DampedEffort, Pid, PidGains
from cartwheel.errors import Origin
from cartwheel.simulation import Part
from cartwheel.simulation.dynamics.joint_servo import ServoHandle
from cartwheel.simulation.dynamics.velocity_motor import MotorHandle
from cartwheel.simulation.handles import JointHandle


@dataclass(frozen=True, kw_only=True, slots=True)
class JointActuatorConfig:
    joint: str
    """Name of the joint."""
    commands: tuple[str, ...]
    """Possible commands: ``position``, ``velocity`` and ``effort``."""
    limits: JointLimits = field(default_factory=JointLimits)
    """Limits of the commands."""
    strength: float
    """Maximum effort of position and velocity commands, N m or N."""
    exceeds_limit: bool = False
    """Whether `strength` is larger than the effort limit in the description."""
    pid: tuple[str, PidGains] | None = None
    """A command, ``position`` or ``velocity``, that a PID controller converts to efforts. None: the
    joint follows it regardless of its load, up to `strength`."""
    led: bool = False
    """Whether the joint follows another joint. It is then not held while it has no command."""
    idles: bool = False
    """Whether a joint with velocity commands turns freely while it has no command."""
    overruns: bool = False
    """Whether velocity commands may exceed the velocity limit, until a program changes it."""
    yields: bool = False
    """Whether only a drive plugin moves the joint, if there is one, while no controller does."""
    origin: Origin | None = None
    """File and line for errors."""


def position_error(target: Number, position: Number, *, continuous: bool) -> Number:
    """Returns target minus position in rad or m; in a continuous joint, by the shorter way."""
    error = target - position
    return remainder(error, 2 * math.pi) if continuous else error


class JointActuator:
    """A joint with a motor that follows the active command.

    Args:
        part: The model's part of the simulation.
        config: Commands and limits.

    Raises:
        UnknownNameError: The joint does not exist.
    """

    def __init__(self, part: Part, config: JointActuatorConfig) -> None:
        name, origin = config.joint, config.origin
        joint = part.description.joint(name)
        self.joint = name
        """Name in the description."""
        self.type = joint.type if joint is not None else ""
        self._continuous = self.type == "continuous"
        self.state: JointHandle = part.joint(name, origin=origin)
        self.pids = {config.pid[0]: Pid(config.pid[1])} if config.pid is not None else {}
        self.tune = partial(part.tune, name)
        """States that a PID controller commands the joint; see `Part.tune`."""
        for pid in self.pids.values():
            self.tune(pid)
        self._commands = config.commands
        self._motor: MotorHandle | None = None
        self._servo: ServoHandle | None = None
        if config.commands == ("velocity",) and not self.pids and not config.idles:
            self._motor = part.velocity_motor(
                name,
                max_effort=config.strength,
                beyond=config.exceeds_limit,
                yields=config.yields,
                origin=origin,
            )
        elif config.commands:
            self._servo = part.servo(
                name,
                max_effort=config.strength,
                beyond=config.exceeds_limit,
                yields=config.yields,
                origin=origin,
            )
        self._yields = config.yields
        self._idles = config.idles
        self._report_two = partial(part.report_two_drives, name, origin=origin)
        self._contest = partial(part.contest, name, sets_motor=not config.overruns)
        self._overruled: list[MotorHandle] = []
        """Those of drive plugins that have no effect while a controller commands the joint."""
        self._active = self._resting = ""
        self.command = 0.0
        """The active command: rad or m, rad/s or m/s, or N m or N."""
        self.rate = 0.0
        """Rate of change of a commanded position, rad/s or m/s; 0 if unknown."""
        self.strength = math.inf
        """Maximum effort of a position command, N m or N. A gripper controller can lower it."""
        self.damping = 0.0
        """Decrease of a commanded effort with velocity, N m s/rad or N s/m."""
        self._led = config.led
        self._held = position_range(joint)
        """The limits of the joint itself, rad or m."""
        self._limits = config.limits
        self._overruns = config.overruns
        self._prepare()
        part.limit(name, self)

    @property
    def limits(self) -> JointLimits:
        """Limits of the commands. A program may change them at any time."""
        return self._limits

    @limits.setter
    def limits(self, limits: JointLimits) -> None:
        ends = limits.lower, limits.upper
        if ends != (self._limits.lower, self._limits.upper):
            # A program sets those of the joint and of its controllers.
            self._held = ends
        self._overruns = self._overruns and limits.velocity == self._limits.velocity
        self._limits = limits
        self._prepare()

    def _prepare(self) -> None:
        limits = self._limits
        self._slows = limits.soft is not None and math.inf not in (-limits.lower, limits.upper)
        """Whether the maximum velocity depends on the position."""
        self._is_limited = limits != JointLimits()
        self._lower, self._upper, self._fastest = limits.lower, limits.upper, limits.velocity
        self._quickest = math.inf if self._overruns else limits.velocity
        self._lowest, self._highest = cut_range(limits, self._held)

    @property
    def fastest(self) -> float:
        """Maximum velocity command, rad/s or m/s."""
        return self._quickest

    def expect_commands(self, period: float) -> None:
        """States the time between two calls of `write`, s."""
        if self._servo is not None:
            self._servo.period = period

    @property
    def position(self) -> float:
        """rad or m."""
        return self.state.position

    @property
    def velocity(self) -> float:
        """rad/s or m/s."""
        return self.state.velocity

    @property
    def lightness(self) -> float:
        """Acceleration per effort: rad/s² for 1 N m, or m/s² for 1 N."""
        return self.state.lightness

    @property
    def effort(self) -> float:
        """Effort of the last step, N m or N."""
        return self.state.effort

    def error(self, target: float) -> float:
        """Returns the position error for a target in rad or m; see `position_error`."""
        if not self._continuous:
            return target - self.state.position
        error: float = position_error(target, self.state.position, continuous=True)
        return error

    def activate(self, command: str) -> None:
        """Selects the active command. The joint stays at its position."""
        self._select(command)
        drive = self._motor or self._servo
        if not self._yields or drive is None or not drive.rivalled:
            return
        if command == "effort":
            self._report_two("the efforts of both plugins are added")
            return
        overruled = self._contest(drive)
        if overruled is None:
            # The motor of the drive plugin turns the joint.
            self._active = ""
            if self._servo is not None:
                self._servo.release()
            self._report_two("as in Gazebo, only the commands of the drive plugin have an effect")
            return
        self._overruled += overruled
        self._report_two("as in Gazebo, only the commands of the controller have an effect")

    def _select(self, command: str) -> None:
        self._active = command
        self.damping = 0.0
        self.strength = math.inf
        self.command = self.position if command == "position" else 0.0
        self.rate = 0.0
        for pid in self.pids.values():
            pid.reset()

    def release(self) -> None:
        """Called when no controller commands the joint any more.

        A position command is kept; velocity and effort commands become 0.
        """
        self.rate = self.damping = 0.0
        for each in self._overruled:
            each.restore()
        self._overruled.clear()
        if self._active in ("velocity", "effort"):
            self.command = 0.0
        if self._idles:
            self._idle()
            return
        self._rest()

    def rest(self, *, holds: bool) -> None:
        """Called before any controller commands the joint.

        Args:
            holds: Hold joints with effort commands as well.
        """
        if not self._commands:
            return
        if (self._led or self._idles) and self._servo is not None:
            self._idle()
            return
        self._select(self._commands[0])
        if holds and self._servo is not None:
            self._active = "held"
            self.command = self.position
        self._rest()

    @property
    def _rivalled(self) -> bool:
        drive = self._motor or self._servo
        return drive is not None and drive.rivalled

    def _idle(self) -> None:
        self._active = ""
        if self._servo is not None:
            self._servo.release()

    def _rest(self) -> None:
        if self._yields and self._active:
            self._resting, self._active = self._active, "resting"

    def _decide(self, seconds: float) -> None:
        """Leaves the joint to a drive plugin, or applies the command; called at the first write,
        when all plugins are known.
        """
        if not self._rivalled:
            self._active = self._resting
            self.write(seconds)
            return
        self._active = ""
        if self._servo is not None:
            self._servo.release()

    def set_effort(self, command: DampedEffort) -> None:
        """Commands an effort that decreases with velocity, for controllers with their own PID."""
        self.command, self.damping = command.effort, command.damping

    def write(self, seconds: float, lead: float = 0.0) -> None:
        """Applies the command to the joint.

        Args:
            seconds: Time since the last call, s.
            lead: Time since the command was set, s. A position command is extrapolated by it.
        """
        # This runs for each joint at every step. Comparisons take a quarter of the time of `min`
        # and `max`, and positional arguments less than named ones.
        active, target = self._active, self.command
        if active == "velocity":
            high = self._quickest
            low = -high
            if self._slows:
                low, high = velocity_bounds(self._limits, self.state.position)
            if low > target:  # noqa: PLR1730
                target = low
            if high < target:  # noqa: PLR1730
                target = high
            motor = self._motor
            if motor is not None:
                motor.target = motor.rotors[motor.dof] = target
            else:
                self._follow_velocity(target, seconds)
        elif active == "position":
            rate, fastest = self.rate, self._fastest
            target += lead * rate
            if self._slows:
                target, fastest = limited_position(self._limits, target, self.state.position)
            else:
                if self._lower > target:  # noqa: PLR1730
                    target = self._lower
                if self._upper < target:  # noqa: PLR1730
                    target = self._upper
            servo = self._servo
            if servo is not None and not self.pids:
                servo.command_position(target, rate, fastest, self.strength)
            else:
                self._follow_position(target, fastest, seconds)
        elif active == "effort":
            damping, servo = self.damping, self._servo
            assert servo is not None
            if self._is_limited:
                target, damping = self._limited_effort(target, damping, seconds)
            servo.command_effort(target, damping)
        elif active == "held":
            assert self._servo is not None
            self._servo.command_position(target)
        elif active == "resting":
            self._decide(seconds)

    def halt(self) -> None:
        """Sets efforts to 0, and brakes joints with velocity or position commands."""
        if self._motor is not None:
            self._motor.command(0.0)
        elif self._servo is not None and self._active == "effort":
            self._servo.release()
        elif self._servo is not None:
            self._servo.command_velocity(0.0)

    def _follow_position(self, target: float, fastest: float, seconds: float) -> None:
        assert self._servo is not None
        pid = self.pids.get("position")
        if pid is None:
            self._servo.command_position(
                target, velocity=self.rate, max_velocity=fastest, max_effort=self.strength
            )
            return
        command = pid.position(
            self.error(target),
            seconds,
            target=target,
            rate=self.rate or None,
            lightness=self.lightness,
        )
        self._servo.command_effort(*command)

    def _follow_velocity(self, target: float, seconds: float) -> None:
        assert self._servo is not None
        pid = self.pids.get("velocity")
        if pid is None:
            self._servo.command_velocity(target)
        else:
            command = pid.velocity(target, self.velocity, seconds, self.lightness)
            self._servo.command_effort(*command)

    def _limited_effort(self, effort: float, damping: float, seconds: float) -> tuple[float, float]:
        """Returns an effort and its damping within the limits; see `limited_effort`."""
        limits, state = self._limits, self.state
        position, velocity = state.qpos[state.qposadr], state.qvel[state.dofadr]
        most = limits.velocity
        if limits.soft is not None or (
            position < self._lowest
            or position > self._highest
            or velocity < -most
            or velocity > most
        ):
            command = DampedEffort(effort, damping)
            gain = state.lightness * seconds
            effort, damping = limited_effort(
                limits, command, position, velocity, gain, held=self._held
            )
        elif damping:
            # The same as `saturated` for efforts within the limit, which most are.
            output, limit = effort - damping * velocity, limits.effort
            if output > limit or output < -limit:
                command = DampedEffort(effort, damping)
                gain = state.lightness * seconds
                effort, damping = saturated(command, limit, velocity, gain)
        else:
            # The same without an object.
            limit = limits.effort
            if -limit > effort:  # noqa: PLR1730
                effort = -limit
            if limit < effort:  # noqa: PLR1730
                effort = limit
        return effort, damping
