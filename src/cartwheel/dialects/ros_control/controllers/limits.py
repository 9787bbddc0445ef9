"""Settings of a drive's limits: velocity, acceleration, deceleration, jerk."""

from __future__ import annotations

import math

from cartwheel.codes import devices
from cartwheel.devices.drives.limiter import Bounds, Limits
from cartwheel.dialects.ros_control.settings import Settings


def read_limits(settings: Settings) -> Limits:
    """Reads ``max_velocity``, ``min_velocity`` and so on; in ROS 1 also ``has_…_limits``.

    Raises:
        PluginError: A limit is missing, or is not a number.
    """
    acceleration = _pair(settings, "acceleration")
    # ROS 1 has one limit for both.
    deceleration = acceleration
    low = settings.optional_number("max_deceleration")
    high = settings.optional_number("max_deceleration_reverse")
    if low is not None and acceleration is not None and not math.isinf(low):
        deceleration = (-abs(low), abs(low if high is None else high))
    settings.ignore("max_acceleration_reverse", "max_deceleration_reverse", "max_deceleration")
    return Limits(
        velocity=_pair(settings, "velocity"),
        acceleration=acceleration,
        deceleration=deceleration,
        jerk=_pair(settings, "jerk"),
    )


def _pair(settings: Settings, kind: str) -> Bounds | None:
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
