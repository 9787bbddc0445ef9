"""Drive plugins that receive the same commands, and so drive a robot together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cartwheel.checks.stated_sizes import LEAST, Stated, differs
from cartwheel.checks.wheels import axle_of, wheel_place
from cartwheel.description.solids import Floats


def united(one: Stated, sizes: Sequence[Stated]) -> Stated:
    """A wheel separation with the wheels of all plugins that turn the robot at the same rate.

    A plugin for each axle moves the robot as one plugin for all wheels does.

    Args:
        one: The stated separation.
        sizes: All stated sizes.

    Returns:
        `one` itself if its plugin drives alone, or if the plugins share wheels or contradict each
        other.
    """
    if one.measure != "apart" or not one.topic:
        return one
    drives = [
        each
        for each in sizes
        if each.robot is one.robot and each.measure == "apart" and each.topic == one.topic
    ]
    first, second = (
        tuple(name for each in drives for name in getattr(each, side))
        for side in ("first", "second")
    )
    wheels = (*first, *second)
    across = _across(one)
    if (
        len(drives) < 2
        or len(set(wheels)) < len(wheels)
        or any(differs(each.used, one.used, LEAST) for each in drives)
        or any(float(_across(each) @ across) <= 0 for each in drives)
    ):
        return one
    return replace(one, first=first, second=second, skids=True)


def _across(one: Stated) -> Floats:
    """From the second wheels to the first ones along the axle, m, shape (3,)."""
    sides = [
        [
            wheel_place(one.robot, joint).position
            for name in names
            if (joint := one.robot.joints[name]).child in one.robot.placed
        ]
        for names in (one.first, one.second)
    ]
    if not all(sides):
        return np.zeros(3)
    axle = axle_of(one.robot, one.first, one.second, beside=True)
    between = np.mean(sides[0], axis=0) - np.mean(sides[1], axis=0)
    return np.asarray(axle * float(axle @ between), dtype=np.float64)
