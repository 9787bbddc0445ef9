"""PID controllers of joints: pure functions of gains, state and inputs, and a class for the state.

The functions take floats, or arrays with one element for each of many joints.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal, NamedTuple

from cartwheel.devices.elementwise import Number, anywhere, clamp, where


@dataclass(frozen=True, kw_only=True, slots=True)
class PidGains:
    """Gains and limits of a PID controller. Sources: control_toolbox, gz-math."""

    p: float
    """Proportional gain, effort per rad or m (or per rad/s or m/s)."""
    i: float = 0.0
    """Integral gain, effort per rad s or m s."""
    d: float = 0.0
    """Derivative gain, effort per rad/s or m/s."""
    i_min: float = 0.0
    """Minimum of the integral term, N m or N."""
    i_max: float = 0.0
    """Maximum of the integral term, N m or N."""
    stored: Literal["error", "limited error", "limited term"] = "error"
    """Integral that is stored: of the error, of the error within the limits of the integral term
    (anti-windup), or the integral term itself within its limits."""
    offset: float = 0.0
    """Constant part of `effort`, N m or N."""
    u_min: float = -math.inf
    """Minimum output, N m or N."""
    u_max: float = math.inf
    """Maximum output, N m or N."""


def limited_gains(
    p: float, i: float, d: float, *, integral: tuple[float, float], output: tuple[float, float]
) -> PidGains:
    """Gains with a limited integral term, as in gz-math: a maximum is at least its minimum.

    Args:
        p: Proportional gain; see `PidGains`.
        i: Integral gain.
        d: Derivative gain.
        integral: Minimum and maximum of the integral term, N m or N.
        output: Minimum and maximum output, N m or N.
    """
    return PidGains(
        p=p,
        i=i,
        d=d,
        i_min=integral[0],
        i_max=max(integral),
        stored="limited term",
        u_min=output[0],
        u_max=max(output),
    )


class DampedEffort(NamedTuple):
    """An effort that decreases with the joint's velocity: ``effort - damping * velocity``.

    The physics integrates the damping implicitly, so a derivative gain is stable at any step size.
    """

    effort: Number
    """N m or N."""
    damping: Number = 0.0
    """N m s/rad or N s/m."""

    def at(self, velocity: Number) -> Number:
        """Returns the effort in N m or N at a velocity in rad/s or m/s."""
        return self.effort - self.damping * velocity


_damped: Callable[[tuple[Number, Number]], DampedEffort] = partial(tuple.__new__, DampedEffort)
"""As `DampedEffort`, in half the time: its own constructor is a Python function."""


def integrate(gains: PidGains, integral: Number, error: Number, seconds: float) -> Number:
    """Returns the stored integral after a step.

    Args:
        gains: The gains.
        integral: The stored integral before the step.
        error: Target minus measured value.
        seconds: Duration of the step, s.
    """
    if gains.stored == "limited term":
        if not gains.i:
            return integral
        return clamp(integral + gains.i * error * seconds, gains.i_min, gains.i_max)
    integral = integral + error * seconds
    if gains.i and gains.stored == "limited error":
        low, high = sorted((gains.i_min / gains.i, gains.i_max / gains.i))
        integral = clamp(integral, low, high)
    return integral


def integral_term(gains: PidGains, integral: Number) -> Number:
    """Returns the effort in N m or N that a stored integral contributes."""
    if gains.stored == "limited term":
        return integral
    return clamp(gains.i * integral, gains.i_min, gains.i_max)


def rate_of(target: Number, before: Number, seconds: float) -> Number:
    """Returns the rate of change of a target; 0 if no time has passed."""
    return (target - before) / seconds if seconds > 0 else 0.0


_STIFF = 0.1
"""(omega T)² of a spring and a joint that oscillate with a period of twenty control periods."""


def position_effort(
    gains: PidGains,
    error: Number,
    integral: Number,
    *,
    rate: Number,
    seconds: float,
    lightness: Number = 0.0,
) -> DampedEffort:
    """Returns the effort for a position error.

    Args:
        gains: The gains.
        error: Target minus position, rad or m.
        integral: The stored integral.
        rate: Rate of change of the target, rad/s or m/s.
        seconds: Control period, s.
        lightness: Acceleration of the joint per effort. If the joint is fast compared with the
            control rate, the proportional term acts on its predicted position instead of the
            current one. Otherwise its oscillation would grow.
    """
    p, d = gains.p, gains.d
    effort = p * error + integral_term(gains, integral) + d * rate
    stiff = p * seconds * seconds * lightness > _STIFF
    if stiff is False or not anywhere(stiff):
        return DampedEffort(effort, d)
    return DampedEffort(
        where(stiff, effort + gains.p * seconds * rate, effort),
        where(stiff, gains.d + gains.p * seconds, gains.d),
    )


def velocity_effort(
    gains: PidGains, target: Number, integral: Number, change: Number, lightness: Number = 0.0
) -> DampedEffort:
    """Returns the effort for a target velocity.

    The derivative gain acts on the target only. The derivative of the measured velocity would act
    as an inertia, one step late. If it exceeded the joint's own inertia, the oscillation would grow
    at any step size. With both inertias, I and d, a jump of the target by v changes the velocity by
    d v / (I + d).

    Args:
        gains: The gains. The proportional gain acts as damping.
        target: Target velocity, rad/s or m/s.
        integral: The stored integral.
        change: Rate of change of the target, rad/s² or m/s².
        lightness: Acceleration of the joint per effort, 1 / I.
    """
    jump = gains.d * change / (1.0 + max(gains.d, 0.0) * lightness)
    effort = gains.p * target + integral_term(gains, integral) + jump
    return DampedEffort(effort, gains.p)


def plain_effort(gains: PidGains, error: Number, integral: Number) -> Number:
    """Returns the effort in N m or N for an error, within the output limits and without `d`."""
    effort = gains.p * error + integral_term(gains, integral) + gains.offset
    return clamp(effort, gains.u_min, gains.u_max)


class Pid:
    """Controls a position or a velocity by an effort.

    Args:
        gains: Gains and limits.
    """

    def __init__(self, gains: PidGains) -> None:
        self.gains = gains
        self._is_limited = (gains.u_min, gains.u_max) != (-math.inf, math.inf)
        self.reset()

    def reset(self) -> None:
        """Clears the integral and the last target."""
        self._integral = 0.0
        self._target: float | None = None

    def position(
        self,
        error: float,
        seconds: float,
        target: float,
        rate: float | None = None,
        lightness: float = 0.0,
    ) -> DampedEffort:
        """Returns the effort for a position error; see `position_terms`."""
        return _damped(self.position_terms(error, seconds, target, rate, lightness))

    def position_terms(
        self,
        error: float,
        seconds: float,
        target: float,
        rate: float | None = None,
        lightness: float = 0.0,
    ) -> tuple[float, float]:
        """Returns the effort for a position error and its damping, as a `DampedEffort` has them.

        Args:
            error: Target minus position, rad or m.
            seconds: Time since the last call, s.
            target: Target position. Its rate of change is part of the derivative.
            rate: Rate of change of the target, rad/s or m/s; None: computed from the last target.
            lightness: Acceleration of the joint per effort; see `position_effort`.
        """
        gains = self.gains
        if rate is None:
            before = target if self._target is None else self._target
            rate = (target - before) / seconds if seconds > 0 else 0.0
        self._target = target
        if gains.stored != "error":
            self._integral = integrate(gains, self._integral, error, seconds)
            return position_effort(
                gains, error, self._integral, rate=rate, seconds=seconds, lightness=lightness
            )
        # The same without calls, because most controllers do this at every step.
        p, d, low, high = gains.p, gains.d, gains.i_min, gains.i_max
        self._integral = integral = self._integral + error * seconds
        term = gains.i * integral
        if low > term:  # noqa: PLR1730
            term = low
        if high < term:  # noqa: PLR1730
            term = high
        effort = p * error + term + d * rate
        if p * seconds * seconds * lightness > _STIFF:
            effort, d = effort + p * seconds * rate, d + p * seconds
        return effort, d

    def velocity(
        self, target: float, velocity: float, seconds: float, lightness: float = 0.0
    ) -> DampedEffort:
        """Returns the effort for a target velocity and a measured velocity, rad/s or m/s.

        `lightness` is the acceleration of the joint per effort; see `velocity_effort`.
        """
        change = self._change(target, seconds)
        self._integral = integrate(self.gains, self._integral, target - velocity, seconds)
        return velocity_effort(self.gains, target, self._integral, change, lightness)

    def effort(self, error: float, seconds: float) -> float:
        """Returns the limited effort in N m or N for an error; see `plain_effort`."""
        self._integral = integrate(self.gains, self._integral, error, seconds)
        effort: float = plain_effort(self.gains, error, self._integral)
        return effort

    def position_command(
        self, error: float, velocity: float, seconds: float, step: float, lightness: float
    ) -> DampedEffort:
        """Returns the effort for a position error, in which the output limits leave out damping.

        Args:
            error: Target minus position, rad or m.
            velocity: Velocity of the joint, rad/s or m/s.
            seconds: Time since the last call, s.
            step: Time for which the effort acts, s.
            lightness: Acceleration of the joint per effort; see `position_effort`.
        """
        effort, gains = self.effort(error, seconds), self.gains
        if gains.p * step * step * lightness <= _STIFF:
            return DampedEffort(effort, gains.d)
        return self._after(error, gains.d + gains.p * step, velocity, step * lightness)

    def velocity_command(
        self, error: float, velocity: float, seconds: float, step: float, lightness: float
    ) -> DampedEffort:
        """Returns the effort for a velocity error.

        If the joint is light, the proportional term acts on the velocity after the step. With that
        before the step, the joint would overshoot its target in each step.

        Args:
            error: Target minus velocity, rad/s or m/s.
            velocity: Velocity of the joint, rad/s or m/s.
            seconds: Time since the last call, s.
            step: Time for which the effort acts, s.
            lightness: Acceleration of the joint per effort.
        """
        effort, gains = self.effort(error, seconds), self.gains
        if gains.p * step * lightness <= 1.0:
            return DampedEffort(effort)
        command = self._after(error, gains.p, 0.0, step * lightness)
        return DampedEffort(command.effort + command.damping * velocity, command.damping)

    def _after(self, error: float, damping: float, velocity: float, gain: float) -> DampedEffort:
        """The effort with a damping that acts after the step; without it at the output limits.

        Args:
            error: The error, whose integral is stored.
            damping: N m s/rad or N s/m.
            velocity: Velocity before the step that the damping reduces, rad/s or m/s.
            gain: Change of the velocity in the step per effort.
        """
        gains = self.gains
        effort = gains.p * error + integral_term(gains, self._integral) + gains.offset
        output = (effort - damping * velocity) / (1.0 + damping * gain)
        limited = clamp(output, gains.u_min, gains.u_max)
        return DampedEffort(effort, damping) if limited == output else DampedEffort(limited)

    def limited(self, command: DampedEffort, velocity: float) -> DampedEffort:
        """Applies the output limits to an effort at a velocity in rad/s or m/s."""
        if not self._is_limited:
            return command
        output = command.at(velocity)
        clamped = min(max(output, self.gains.u_min), self.gains.u_max)
        return command if clamped == output else DampedEffort(clamped)

    def _change(self, target: float, seconds: float) -> float:
        """Stores a target, and returns its rate of change since the last one."""
        before = target if self._target is None else self._target
        self._target = target
        change: float = rate_of(target, before, seconds)
        return change
