"""Limits on what a drive is told: velocity, acceleration, jerk."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cartwheel.codes import devices
from cartwheel.plugins.control.settings import Settings


@dataclass(frozen=True, kw_only=True, slots=True)
class Limiter:
    """Source: diff_drive_controller, speed_limiter; each pair is least and largest."""

    velocity: tuple[float, float] | None = None
    acceleration: tuple[float, float] | None = None
    """While it grows faster."""
    deceleration: tuple[float, float] | None = None
    """While it slows down; as the acceleration where ROS 1 states one for both."""
    jerk: tuple[float, float] | None = None

    @classmethod
    def read(cls, settings: Settings) -> Limiter:
        """``max_velocity``, ``min_velocity`` and so on; ROS 1 asks for ``has_…_limits`` as well.

        Raises:
            PluginError: A limit is missing, or is no number.
        """
        acceleration = _pair(settings, "acceleration")
        deceleration = acceleration
        low = settings.optional_number("max_deceleration")
        high = settings.optional_number("max_deceleration_reverse")
        if low is not None and acceleration is not None and not math.isinf(low):
            deceleration = (-abs(low), abs(low if high is None else high))
        settings.ignore("max_acceleration_reverse", "max_deceleration_reverse", "max_deceleration")
        return cls(
            velocity=_pair(settings, "velocity"),
            acceleration=acceleration,
            deceleration=deceleration,
            jerk=_pair(settings, "jerk"),
        )

    def limit(self, wanted: float, last: float, before: float, seconds: float) -> float:
        """The command that the limits allow.

        Args:
            wanted: m/s or rad/s.
            last: The last command.
            before: The one before it.
            seconds: Between commands.
        """
        value = wanted
        if self.jerk is not None:
            change = last - before
            low, high = (limit * 2 * seconds * seconds for limit in self.jerk)
            value = last + change + min(max(value - last - change, low), high)
        slows = abs(value) < abs(last) or value * last < 0
        bounds = self.deceleration if slows else self.acceleration
        if bounds is not None:
            if slows and last < 0:
                bounds = (-bounds[1], -bounds[0])
            low, high = (limit * seconds for limit in bounds)
            value = last + min(max(value - last, low), high)
        if self.velocity is not None:
            value = min(max(value, self.velocity[0]), self.velocity[1])
        return value


def _pair(settings: Settings, kind: str) -> tuple[float, float] | None:
    """Least and largest of a kind; None where it is not limited."""
    high = settings.optional_number(f"max_{kind}")
    low = settings.optional_number(f"min_{kind}")
    stated = settings.raw(f"has_{kind}_limits")
    if stated is not None and not settings.boolean(f"has_{kind}_limits"):
        return None
    if stated is not None and high is None:
        raise settings.missing(f"max_{kind}", f"It is required because has_{kind}_limits is true.")
    if high is None:
        return None
    if low is None:
        low = -high
    if low > high:
        raise settings.error(
            devices.PLUGIN_RANGE_REVERSED,
            f'"min_{kind}" must not exceed "max_{kind}" (got {low:g} and {high:g})',
            values={"parameter": f"min_{kind}", "value": low, "most": high},
        )
    if stated is None and low == high == 0 and kind != "velocity":
        # Written for releases that ask for has_…_limits too; obeyed, nothing would ever move.
        return None
    return low, high
