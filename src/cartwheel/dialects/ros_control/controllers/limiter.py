"""Limits on a drive's commands: velocity, acceleration, jerk."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cartwheel.codes import devices
from cartwheel.dialects.ros_control.settings import Settings


@dataclass(frozen=True, kw_only=True, slots=True)
class Limiter:
    """Minimum and maximum of each quantity. Source: diff_drive_controller, speed_limiter."""

    velocity: tuple[float, float] | None = None
    acceleration: tuple[float, float] | None = None
    """While the speed increases."""
    deceleration: tuple[float, float] | None = None
    """While the speed decreases. Equals the acceleration if ROS 1 specifies one for both."""
    jerk: tuple[float, float] | None = None

    @classmethod
    def read(cls, settings: Settings) -> Limiter:
        """Reads ``max_velocity``, ``min_velocity`` and so on; in ROS 1 also ``has_…_limits``.

        Raises:
            PluginError: A limit is missing, or is not a number.
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
        """Returns the limited command.

        Args:
            wanted: The requested command, m/s or rad/s.
            last: The previous command.
            before: The command before the previous one.
            seconds: Time between two commands, s.
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
    """Returns the minimum and maximum of a quantity; None without a limit."""
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
        # Written for releases that also require has_…_limits. If applied, nothing would ever move.
        return None
    return low, high
