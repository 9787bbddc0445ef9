"""PID controllers as in ros_control."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cartwheel.dialects.ros_control.settings import Settings


@dataclass(frozen=True, kw_only=True, slots=True)
class Gains:
    """Gains and limits of a PID. Source: control_toolbox."""

    p: float
    i: float = 0.0
    d: float = 0.0
    i_min: float = 0.0
    i_max: float = 0.0
    antiwindup: bool = False
    """Clamps the integral itself, in addition to the integral term."""
    u_min: float = -math.inf
    """Limits of the sum of all terms."""
    u_max: float = math.inf

    @classmethod
    def read_ros2(cls, settings: Settings) -> Gains:
        """Reads the gains of ROS 2 controllers: all are optional, and not clamped by default.

        Raises:
            PluginError: A value is not a number.
        """
        clamp = abs(settings.number("i_clamp", math.inf))
        strategy = settings.text("antiwindup_strategy", "legacy")
        if strategy not in ("legacy", "none"):
            raise settings.invalid("antiwindup_strategy", strategy, '"legacy" or "none"')
        settings.ignore("normalize_error", "angle_wraparound")
        return cls(
            p=settings.number("p", 0.0),
            i=settings.number("i", 0.0),
            d=settings.number("d", 0.0),
            i_min=settings.number("i_clamp_min", -clamp),
            i_max=settings.number("i_clamp_max", clamp),
            antiwindup=settings.boolean("antiwindup", False),
            u_min=settings.number("u_clamp_min", -math.inf),
            u_max=settings.number("u_clamp_max", math.inf),
        )

    @classmethod
    def read(cls, settings: Settings) -> Gains:
        """Reads ``p``, ``i``, ``d``, ``i_clamp``, ``i_clamp_min``, ``i_clamp_max``, ``antiwindup``.

        Without a clamp the integral term is 0, as in ros_control.

        Raises:
            PluginError: A value is not a number, or ``p`` is missing.
        """
        clamp = abs(settings.number("i_clamp", 0.0))
        settings.ignore("publish_state")
        return cls(
            p=settings.number("p"),
            i=settings.number("i", 0.0),
            d=settings.number("d", 0.0),
            i_min=-abs(settings.number("i_clamp_min", -clamp)),
            i_max=abs(settings.number("i_clamp_max", clamp)),
            antiwindup=settings.boolean("antiwindup", False),
        )


_STIFF = 0.1
"""(omega T)² of a spring and a joint that oscillate with a period of twenty control periods."""


@dataclass(frozen=True, slots=True)
class Law:
    """An effort that decreases with the joint's velocity: ``effort - damping * velocity``.

    The physics integrates the damping implicitly, so a derivative gain is stable at any step
    size.
    """

    effort: float
    damping: float = 0.0


class Pid:
    """Controls a position or a velocity by an effort."""

    def __init__(self, gains: Gains) -> None:
        self.gains = gains
        self.reset()

    def reset(self) -> None:
        """Clears the integral and the last target."""
        self._integral = 0.0
        self._target: float | None = None

    def position(
        self,
        error: float,
        seconds: float,
        *,
        target: float,
        rate: float | None = None,
        lightness: float = 0.0,
    ) -> Law:
        """Returns the effort for a position error.

        Args:
            error: Target minus position, rad or m.
            seconds: Time since the last call, s.
            target: Target position. Its rate of change is part of the derivative.
            rate: Rate of change of the target, rad/s or m/s; None: computed from the last target.
            lightness: Acceleration of the joint per effort.
        """
        if rate is None:
            before = target if self._target is None else self._target
            rate = (target - before) / seconds if seconds > 0 else 0.0
        self._target = target
        gains = self.gains
        effort = gains.p * error + self._integrate(error, seconds) + gains.d * rate
        damping = gains.d
        if gains.p * seconds * seconds * lightness > _STIFF:
            # The spring acts on the predicted position instead of the current one: the oscillation
            # of a joint that is fast compared with the control rate would grow.
            damping += gains.p * seconds
            effort += gains.p * seconds * rate
        return Law(effort, damping)

    def velocity(self, target: float, velocity: float, seconds: float) -> Law:
        """Returns the effort for a target velocity in rad/s or m/s. `d` acts on the target only."""
        before = target if self._target is None else self._target
        self._target = target
        gains = self.gains
        # The derivative of the measured velocity would act as an inertia, one step late. If it is
        # larger than the joint's own inertia, the oscillation grows at any step size.
        change = (target - before) / seconds if seconds > 0 else 0.0
        effort = gains.p * target + self._integrate(target - velocity, seconds) + gains.d * change
        return Law(effort, gains.p)

    def bounded(self, law: Law, velocity: float) -> Law:
        """Limits a law to the output limits, at a velocity in rad/s or m/s."""
        output = law.effort - law.damping * velocity
        clamped = min(max(output, self.gains.u_min), self.gains.u_max)
        return law if clamped == output else Law(clamped)

    def _integrate(self, error: float, seconds: float) -> float:
        gains = self.gains
        self._integral += error * seconds
        if gains.antiwindup and gains.i:
            low, high = sorted((gains.i_min / gains.i, gains.i_max / gains.i))
            self._integral = min(max(self._integral, low), high)
        return min(max(gains.i * self._integral, gains.i_min), gains.i_max)
