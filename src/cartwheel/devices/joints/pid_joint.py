"""Joints that PID controllers move to a target."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from cartwheel.devices.elementwise import remainder
from cartwheel.devices.joints.actuator import JointActuator
from cartwheel.devices.joints.pid import DampedEffort, Pid, PidGains

Quantity = Literal["position", "velocity", "effort"]
UNKNOWN = (math.nan, math.nan)
_TURN = 2 * math.pi


@dataclass(frozen=True, kw_only=True, slots=True)
class PidJointConfig:
    gains: PidGains
    quantity: Literal["position", "velocity"]
    """Quantity of the target."""
    commands_effort: bool = True
    """Whether the output is an effort; otherwise a velocity."""


class PidJoint:
    """A joint that a PID controller moves to a target position or velocity.

    Args:
        joint: The joint.
        config: Gains and quantities.
    """

    def __init__(self, joint: JointActuator, config: PidJointConfig) -> None:
        self.joint = joint
        self.config = config
        self._pid = Pid(config.gains)
        joint.tune(self._pid)
        self.target = 0.0
        """rad or m, or rad/s or m/s."""

    def start(self) -> None:
        """Holds the current position, or a velocity of 0."""
        self.target = self.joint.position if self.config.quantity == "position" else 0.0
        self._pid.reset()

    def update(self, seconds: float) -> tuple[float, float]:
        """Commands the joint; returns the error of the target and the output.

        Args:
            seconds: Time since the last call, s.
        """
        # This runs at every step, so it reads the state without calls.
        joint, target = self.joint, self.target
        state = joint.state
        velocity = state.qvel[state.dofadr]
        if self.config.quantity == "velocity":
            error = target - velocity
            effort, damping = self._pid.velocity(target, velocity, seconds, state.lightness)
        else:
            if joint.type != "continuous":
                # Comparisons take a quarter of the time of `clamp`.
                limits = joint.limits
                if limits.lower > target:  # noqa: PLR1730
                    target = limits.lower
                if limits.upper < target:  # noqa: PLR1730
                    target = limits.upper
                error = target - state.qpos[state.qposadr]
            else:
                error = math.remainder(target - state.qpos[state.qposadr], _TURN)
            effort, damping = self._pid.position_terms(
                error, seconds, target, None, state.lightness
            )
        output: float = effort - damping * velocity
        if self.config.commands_effort:
            joint.command, joint.damping = effort, damping
        else:
            joint.command = output
        return error, output


@dataclass(frozen=True, kw_only=True, slots=True)
class PidLoopConfig:
    gains: PidGains
    quantity: Quantity
    """Quantity of the reference and of the measured value."""
    damped: bool
    """Whether the derivative gain damps the joint, which the physics integrates implicitly."""
    feedforward_gain: float
    """Output per reference, or per rate of change of a reference with a rate."""
    wraparound: bool
    """Whether errors take the shorter way around a full turn."""


class PidLoop:
    """A joint whose PID controller follows references, which others command.

    Source: pid_controller.

    Args:
        joint: The commanded joint.
        state: The measured joint.
        references: Hold the reference and, optionally, its rate of change as their commands.
        config: Gains and quantities.
    """

    def __init__(
        self,
        joint: JointActuator,
        state: JointActuator,
        references: tuple[JointActuator, ...],
        config: PidLoopConfig,
    ) -> None:
        self._joint, self._state, self._references = joint, state, references
        self._config = config
        self._pid = Pid(config.gains)
        joint.tune(self._pid)
        self.measured = UNKNOWN
        """Measured value and its rate of change; NaN if unknown."""

    def start(self) -> None:
        """Forgets the measured value and resets the PID controller."""
        self.measured = UNKNOWN
        self._pid.reset()

    def measure(self) -> tuple[float, float]:
        """Returns the joint's own state: a value and its rate of change."""
        state = self._state
        match self._config.quantity:
            case "position":
                return state.position, state.velocity
            case "velocity":
                return state.velocity, math.nan
        return state.effort, math.nan

    @property
    def reference(self) -> tuple[float, float]:
        """The reference and its rate of change; NaN if not set."""
        value, *rate = (each.command for each in self._references)
        return value, rate[0] if rate else math.nan

    @reference.setter
    def reference(self, values: tuple[float, float]) -> None:
        for reference, value in zip(self._references, values, strict=False):
            reference.command = value

    @property
    def error(self) -> float:
        """Reference minus measured value."""
        error: float = self.reference[0] - self.measured[0]
        if self._config.wraparound and math.isfinite(error):
            error = remainder(error, 2 * math.pi)
        return error

    @property
    def output(self) -> float:
        """The last command of the joint."""
        return self._joint.command

    def update(self, seconds: float, *, feedforward: bool) -> None:
        """Commands the joint if it has a reference.

        Args:
            seconds: Time since the last call, s.
            feedforward: Add the feedforward term.
        """
        config, joint = self._config, self._joint
        (reference, rate), (measured, speed), error = self.reference, self.measured, self.error
        if not math.isfinite(error):
            return
        if config.quantity == "position":
            command = self._pid.position(
                error,
                seconds,
                target=reference,
                rate=rate if math.isfinite(rate) else None,
                lightness=joint.lightness if config.damped else 0.0,
            )
        else:
            lightness = joint.lightness if config.damped else 0.0
            command = self._pid.velocity(reference, measured, seconds, lightness)
            speed = measured
        speed = speed if math.isfinite(speed) else 0.0
        command = self._pid.limited(command, speed)
        ahead = rate if len(self._references) > 1 else reference
        if feedforward and math.isfinite(ahead):
            effort = command.effort + config.feedforward_gain * ahead
            command = DampedEffort(effort, command.damping)
        if config.damped:
            joint.set_effort(command)
        else:
            joint.command = command.at(speed)
