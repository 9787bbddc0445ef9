"""The PID law of ros_control."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cartwheel.plugins.control.settings import Settings


@dataclass(frozen=True, kw_only=True, slots=True)
class Gains:
    """Source: control_toolbox."""

    p: float
    i: float = 0.0
    d: float = 0.0
    i_min: float = 0.0
    i_max: float = 0.0
    antiwindup: bool = False
    """Clamps the integral itself, not only what it gives."""
    u_min: float = -math.inf
    """Of all together."""
    u_max: float = math.inf

    @classmethod
    def read_ros2(cls, settings: Settings) -> Gains:
        """The same of ROS 2's joint_trajectory_controller: nothing must be stated or is clamped.

        Raises:
            PluginError: A value is no number.
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
        """``p``, ``i``, ``d``, ``i_clamp`` or ``i_clamp_min`` and ``i_clamp_max``, ``antiwindup``.

        The integral gives nothing where no clamp is stated, as in ros_control.

        Raises:
            PluginError: A value is no number, or there is no ``p``.
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
"""(omega T)² of a spring with a joint that the controller sees twenty times in a swing."""


@dataclass(frozen=True, slots=True)
class Law:
    """An effort that falls with the joint's velocity: ``effort - damping * velocity``.

    The physics takes the damping implicitly, so a derivative gain is stable at any step.
    """

    effort: float
    damping: float = 0.0


class Pid:
    """Holds a position or a velocity by effort."""

    def __init__(self, gains: Gains) -> None:
        self.gains = gains
        self.reset()

    def reset(self) -> None:
        """Forgets the integral and the last target."""
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
        """The law for an error of position.

        Args:
            error: Target minus position, rad or m.
            seconds: Since the last call, s.
            target: Of position; how it changes is part of the derivative.
            rate: Of the target, rad/s or m/s, where it is known.
            lightness: Of the joint: how much faster an effort of 1 makes it in 1 s.
        """
        if rate is None:
            before = target if self._target is None else self._target
            rate = (target - before) / seconds if seconds > 0 else 0.0
        self._target = target
        gains = self.gains
        effort = gains.p * error + self._integrate(error, seconds) + gains.d * rate
        damping = gains.d
        if gains.p * seconds * seconds * lightness > _STIFF:
            # The spring of where the joint will be, not of where it is: what swings faster than
            # the controller looks would swing ever wider.
            damping += gains.p * seconds
            effort += gains.p * seconds * rate
        return Law(effort, damping)

    def velocity(self, target: float, velocity: float, seconds: float) -> Law:
        """The law for a wanted velocity, rad/s or m/s; the derivative is the target's alone."""
        before = target if self._target is None else self._target
        self._target = target
        gains = self.gains
        # Of the measured velocity it would be an inertia, and one that acts a step late and is
        # larger than the joint's own makes it swing ever wider, at any step.
        change = (target - before) / seconds if seconds > 0 else 0.0
        effort = gains.p * target + self._integrate(target - velocity, seconds) + gains.d * change
        return Law(effort, gains.p)

    def bounded(self, law: Law, velocity: float) -> Law:
        """A law that gives no more than the gains allow at a velocity, rad/s or m/s."""
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
