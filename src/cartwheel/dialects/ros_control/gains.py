"""The parameters of PID controllers in ros_control and ros2_control."""

from __future__ import annotations

import math

from cartwheel.devices.joints.pid import PidGains
from cartwheel.dialects.ros_control.settings import Settings

GAINS = (
    "PID gains `p`, `i`, `d`, `i_clamp`, `i_clamp_min`, `i_clamp_max` and `antiwindup`; in ROS 2 "
    "also `u_clamp_min`, `u_clamp_max` and `antiwindup_strategy`."
)
"""Description for the reference."""


def read_gains(settings: Settings) -> PidGains:
    """Reads ``p``, ``i``, ``d``, ``i_clamp``, ``i_clamp_min``, ``i_clamp_max`` and ``antiwindup``.

    Without a clamp the integral term is 0, as in ros_control.

    Raises:
        PluginError: A value is not a number, or ``p`` is missing.
    """
    clamp = abs(settings.number("i_clamp", 0.0))
    settings.ignore("publish_state")
    return PidGains(
        p=settings.number("p"),
        i=settings.number("i", 0.0),
        d=settings.number("d", 0.0),
        i_min=-abs(settings.number("i_clamp_min", -clamp)),
        i_max=abs(settings.number("i_clamp_max", clamp)),
        stored="limited error" if settings.boolean("antiwindup", False) else "error",
    )


def read_ros2_gains(settings: Settings) -> PidGains:
    """Reads the gains of ROS 2 controllers: all are optional, and not clamped by default.

    Raises:
        PluginError: A value is not a number.
    """
    clamp = abs(settings.number("i_clamp", math.inf))
    strategy = settings.text("antiwindup_strategy", "legacy")
    if strategy not in ("legacy", "none"):
        raise settings.invalid("antiwindup_strategy", strategy, '"legacy" or "none"')
    settings.ignore("normalize_error", "angle_wraparound")
    return PidGains(
        p=settings.number("p", 0.0),
        i=settings.number("i", 0.0),
        d=settings.number("d", 0.0),
        i_min=settings.number("i_clamp_min", -clamp),
        i_max=settings.number("i_clamp_max", clamp),
        stored="limited error" if settings.boolean("antiwindup", False) else "error",
        u_min=settings.number("u_clamp_min", -math.inf),
        u_max=settings.number("u_clamp_max", math.inf),
    )
