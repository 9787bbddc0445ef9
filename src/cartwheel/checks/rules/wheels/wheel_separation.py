"""Stated wheel separations, compared with the distance between the wheels, and their effect."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from cartwheel.checks.rule import rule
from cartwheel.checks.rules.wheels.wheel_diameter import size_mismatch, wrong_size
from cartwheel.checks.sliding import turn_ratio, turn_with_slip
from cartwheel.checks.stated_sizes import (
    LEAST,
    Stated,
    differs,
    mean_between,
    stated_sizes,
)
from cartwheel.checks.subject import Subject
from cartwheel.checks.tracks import sliding_tracks
from cartwheel.checks.wheels import axle_of, wheel_place
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Joint
from cartwheel.description.solids import Floats
from cartwheel.errors import Diagnostic

WIDEST_SKID = 2.5
"""Maximum ratio of the stated wheel separation to the track of a skid-steered robot.

Skid-steered robots need a larger value for correct odometry. This limit applies to robots that are
not longer than wide; see `_widest`.
"""
_TAGS = "the <slip1> or <slip2> of the wheels"
UNKNOWN_SLIP = f", without {_TAGS}, which is not simulated"
_LEAST_SKID = 0.05
"""Minimum relative difference between the commanded and the expected turn rate."""


@rule(robot_codes.WHEEL_SEPARATION_MISMATCH)
def wheel_separation(subject: Subject) -> Iterator[Diagnostic]:
    sizes = list(stated_sizes(subject))
    for one in sizes:
        if one.measure not in ("apart", "reach"):
            continue
        apart, joints = (mean_between(one, beside=True, treads=treads) for treads in (True, False))
        if one.measure == "reach":
            apart, joints = (
                (each + mean_between(one, beside=False)) / 2 for each in (apart, joints)
            )
        whole = _united(one, sizes)
        slides = whole.skids and not any(one.steered_by(other) for other in sizes)
        if slides and min(apart, joints) <= one.used <= _widest(whole, apart):
            # Such a robot needs a larger value, which a multiplier may contribute.
            continue
        if differs(one.used, apart, LEAST):
            more = "more" if one.used > apart else "less"
            said = (
                "the wheels are"
                if one.measure == "apart"
                else "half the sum of wheel base and track is"
            )
            found = size_mismatch(
                robot_codes.WHEEL_SEPARATION_MISMATCH,
                one,
                apart,
                f"{said} {apart:.4g} m{' apart' * (one.measure == 'apart')}, so the robot turns "
                f"{abs(one.used / apart - 1):.0%} {more} than commanded",
            )
            found = _with_wrong_wheels(found, one, one.used / apart, sizes)
            # A wheel may be offset from its joint, and the author measured between the joints.
            offset = not differs(one.used, joints, LEAST)
            yield replace(found, severity="info") if offset else found


def _with_wrong_wheels(
    found: Diagnostic, one: Stated, ratio: float, sizes: Sequence[Stated]
) -> Diagnostic:
    """The finding with the turn rate if the size of the same wheels is wrong as well.

    Args:
        found: The finding.
        one: The stated separation.
        ratio: The turn rate relative to the commanded one, with the right size of the wheels.
        sizes: All stated sizes.
    """
    factor, measure = _wrong_wheels(one, sizes)
    if not measure:
        return found
    turns = ratio * factor
    more = "more" if turns > 1 else "less"
    return replace(
        found,
        message=f"{found.message}, and {abs(turns - 1):.0%} {more} with the wrong {measure} of its "
        "wheels",
        values={**found.values, "turns": turns},
    )


def _wrong_wheels(one: Stated, sizes: Sequence[Stated]) -> tuple[float, str]:
    """Factor of the turn rate by a wrong size of the wheels of a separation, and its measure.

    The measure is empty if the size is right.
    """
    wheels = {*one.first, *one.second}
    for other in sizes:
        if other.robot is not one.robot or wheels.isdisjoint(other.first) or not other.used:
            continue
        real = wrong_size(other)
        if real is not None:
            return real / other.used, other.measure
    return 1.0, ""


def _widest(one: Stated, track: float) -> float:
    """Largest plausible wheel separation for a skid-steered robot, m.

    Consider four wheels of a robot with track t and wheelbase b that turns on the spot at 1 rad/s,
    with rim speed u. Each wheel slides by t/2 - u lengthwise and b/2 sideways. The friction torque
    vanishes where t/2 (t/2 - u) + b/2 b/2 = 0, so that 2 u = t (1 + (b/t)²). This is 2 t for a
    square robot. The limit for longer robots grows by the same ratio beyond `WIDEST_SKID`.
    """
    along = _places(one)
    if not along or track <= 0:
        return 0.0
    base = max(along) - min(along)
    return WIDEST_SKID * track * max(1.0, (1 + (base / track) ** 2) / 2)


@rule(robot_codes.SKID_STEERING)
def skid_steering(subject: Subject) -> Iterator[Diagnostic]:
    yield from sliding_tracks(subject)
    sizes = list(stated_sizes(subject))
    # Steered and mecanum wheels, whose drives also state a wheel base, do not slide.
    others = {id(one.robot) for one in sizes if one.measure in ("base", "reach")}
    for one in (_united(each, sizes) for each in sizes):
        if one.measure != "apart" or id(one.robot) in others:
            continue
        left, right = (_with_followers(one, side) for side in (one.first, one.second))
        axle = axle_of(one.robot, one.first, one.second, beside=True)
        ratio = turn_ratio(one.robot, left, right, axle, one.used / 2)
        if ratio is None or ratio == 0:
            continue
        slipping = turn_with_slip(one.robot, left, right, axle, one.used / 2)
        turns = abs(ratio - 1.0) <= _LEAST_SKID
        if turns and slipping is None:
            continue
        least = turn_ratio(one.robot, left, right, axle, one.used / 2, outer=True)
        apart = mean_between(one, beside=True)
        message = f"the wheels slide when the robot turns, {_effect(one, ratio)}"
        factor, measure = _wrong_wheels(one, sizes)
        if measure:
            message += f", and at {ratio * factor:.0%} with the wrong {measure} of its wheels"
        if slipping is not None:
            message += UNKNOWN_SLIP
            if turns:
                message = f"with {_TAGS}, the robot turns at about {slipping:.0%} of the commanded "
                message += "rate in Gazebo; slip is not simulated"
        yield robot_codes.SKID_STEERING.diagnostic(
            message=message,
            severity="info" if turns else None,
            values={
                "tag": one.label,
                "joint": one.first[0],
                "ratio": ratio,
                "least": ratio if least is None else min(least, ratio),
                "stated": one.value,
                "factor": one.factor,
                "multiplier": one.multiplier,
                "measured": one.measured,
                "fits": one.value / ratio,
                # The sides of a drive that names wheels of both sides on each are not apart.
                "rolling": one.used / apart if apart else 1.0,
                **one.owner,
                **({} if slipping is None else {"slip": True, "slipping": slipping}),
            },
            origin=one.origin,
            hint=""
            if turns
            else compensation(one.value, one.factor, one.multiplier, ratio, scaled=one.measured),
            mark=one.mark,
        )


def compensation(
    separation: float, factor: float, multiplier: str, ratio: float, *, scaled: bool
) -> str:
    """The hint how a parameter compensates for wheels that slide.

    Args:
        separation: The wheel separation that is used, m.
        factor: Factor by which a controller multiplies it.
        multiplier: Name of the parameter with this factor; empty if there is none.
        ratio: Turn rate relative to the commanded one.
        scaled: Whether only the factor can be stated.
    """
    wanted = [] if scaled else [f"a wheel separation of {separation / ratio:.4g} m"]
    if multiplier:
        wanted.append(f'a "{multiplier}" of {factor / ratio:.4g}')
    said = " or ".join(wanted)
    return f"{said[:1].upper()}{said[1:]} compensates for this." if said else ""


def _effect(one: Stated, ratio: float) -> str:
    """What follows from wheels that slide, with the stated separation."""
    rate = f"so it turns at {ratio:.0%} of the commanded rate"
    if ratio <= 1.0:
        return rate
    times = f", multiplied by {one.factor:.4g}," if one.factor != 1.0 else ""
    stated = f"{one.label} of {one.value:.4g} m{times}"
    if one.measured:
        stated = f'"{one.multiplier}" of {one.factor:.4g}'
    return f"but {stated} compensates for more than that, {rate}"


def _with_followers(one: Stated, side: Sequence[str]) -> list[Joint]:
    """The wheel joints of a side, and those that mimic them."""
    followers = [
        joint
        for joint in one.robot.joints.values()
        if joint.mimic is not None and joint.mimic.joint in side and joint.mimic.multiplier == 1
    ]
    return [*(one.robot.joints[name] for name in side), *followers]


def _places(one: Stated) -> list[float]:
    """Positions of the wheels along the robot, m."""
    axle = axle_of(one.robot, one.first, one.second, beside=True)
    return [
        float(np.cross(axle, wheel_place(one.robot, joint).position)[2])
        for name in one.first + one.second
        if (joint := one.robot.joints[name]).child in one.robot.placed
    ]


def _united(one: Stated, sizes: Sequence[Stated]) -> Stated:
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
