"""A ramp: a speed or an angle that follows its target at a limited rate."""

from __future__ import annotations

from cartwheel.devices.elementwise import Number, clamp


def ramp(value: Number, target: Number, most: Number) -> Number:
    """Returns the value after a step toward the target.

    Args:
        value: Current value, such as a wheel's commanded rim speed in m/s.
        target: Value to reach.
        most: Largest change in this step: the maximum acceleration times the time of the step.
    """
    return value + clamp(target - value, -most, most)
