"""Explains why a base does not follow its commands, by diagnostics."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import replace

from cartwheel.checks.rules.wheels.wheel_separation import UNKNOWN_SLIP, compensation
from cartwheel.codes import robot, running
from cartwheel.codes.devices import CONTROLLER_GAIN_TOO_LOW, PLUGIN_PARAMETER_OBSOLETE
from cartwheel.corpus.faults import most_severe
from cartwheel.corpus.movers import reports
from cartwheel.dialects.catalogue import short_name
from cartwheel.errors import Code, Diagnostic

_AGREES = 0.15
"""Relative tolerance between a measured velocity and the one that a mistake predicts."""
_DIFFERS = 0.03
"""Difference between the predicted and the measured turn rate, relative to the command, for which
the measured one is stated."""
_BRAKED = 0.15
"""Largest part of the speed that a sliding caster takes while the base drives straight ahead."""
_PULLED = 0.5
"""Largest part of the turn rate for which wheels that point to one side account."""
_REVERSED = 0.5
"""Part of the speed from which a base moves the other way, rather than hardly."""
_UNEVEN = 0.5
"""Smallest part of a predicted turn rate for which uneven weight on sliding wheels accounts."""
_MOST = 0.5
"""Largest part of an error, of the logarithm of the speed, that a wrong size leaves unexplained if
it explains most of it."""
_TOO_FAST = 0.05
"""Relative error from which a base is too fast."""
_STUCK = 0.1
"""Predicted part of the turn rate up to which a robot may as well not turn at all."""
_DRIVING = frozenset(
    {
        robot.DRIVE_JOINT_UNKNOWN,
        robot.DRIVE_JOINT_NOT_CONTINUOUS,
        robot.WHEEL_AXIS_MISALIGNED,
        robot.WHEEL_NOT_ROUND,
        robot.WHEEL_FRICTIONLESS,
        robot.WHEEL_FRICTION_OBLIQUE,
        robot.WHEEL_WITHOUT_COLLISION,
        robot.WHEELS_OFF_GROUND,
        robot.BODY_ON_GROUND,
        robot.DRIVES_APART,
        robot.UNBALANCED,
        robot.EFFORT_ZERO,
        robot.DAMPING_TOO_HIGH,
        robot.OVERLAPPING_COLLISIONS,
        running.PLUGIN_LEFT_OUT,
        running.JOINT_DRIVEN_TWICE,
    }
)
"""Mistakes that change a base's velocity by an unknown factor."""
_NEVER_FASTER = frozenset(
    {
        robot.DRIVE_JOINT_UNKNOWN,
        robot.DRIVE_JOINT_NOT_CONTINUOUS,
        robot.WHEEL_FRICTIONLESS,
        robot.WHEEL_FRICTION_OBLIQUE,
        robot.WHEEL_WITHOUT_COLLISION,
        robot.WHEELS_OFF_GROUND,
        robot.BODY_ON_GROUND,
        robot.DRIVES_APART,
        robot.EFFORT_ZERO,
        robot.DAMPING_TOO_HIGH,
    }
)
"""Mistakes with which a base does not drive faster ahead than its wheels roll."""
_SLOWING = frozenset({robot.SKID_STEERING, robot.CASTER_FRICTION})
"""Parts that slide in a turn."""
_SIDEWAYS = _DRIVING | {running.WHEELS_WITHOUT_ROLLERS}
_TURNING = _DRIVING | {robot.CASTER_FRICTION, running.WHEELS_WITHOUT_ROLLERS}


def cause_of_drive(
    found: Sequence[Diagnostic],
    ratio: float,
    *,
    turning: bool = False,
    sideways: bool = False,
    arc: bool = False,
) -> Diagnostic | None:
    """The mistake that explains why a base moves at a multiple of the commanded velocity."""
    codes = _TURNING if turning else _SIDEWAYS if sideways else _DRIVING
    if ratio > 1.0 + _TOO_FAST and not turning and not sideways:
        codes -= _NEVER_FASTER
    cause = _cause(found, ratio, codes, turning=turning, arc=arc)
    if cause is None and turning:
        cause = _too_weak(found, ratio) or _slides_more(found, ratio)
    if cause is not None and cause.code is robot.SKID_STEERING and ratio > 1.0:
        # Wheels that slide slow the robot down, so it is the stated separation that is wrong.
        wrong = (each for each in found if each.code is robot.WHEEL_SEPARATION_MISMATCH)
        return next(wrong, _as_measured(cause, ratio))
    if cause is None or cause.code is not robot.SKID_STEERING or not 0.0 < ratio < 1.0:
        return cause
    return _as_measured(cause, ratio)


def wrong_sizes(
    found: Sequence[Diagnostic], ratio: float, *, turning: bool = False
) -> list[Diagnostic]:
    """The wrong sizes of wheels or, for a turn, of the distance between them.

    They do not matter to a base that hardly moves. `ratio` is its velocity relative to the command.
    """
    if abs(ratio) < _STUCK:
        return []
    code = robot.WHEEL_SEPARATION_MISMATCH if turning else robot.WHEEL_DIAMETER_MISMATCH
    return [each for each in found if each.code is code and each.severity != "info"]


def explains_turn(forward: Diagnostic | None, factor: float, ratio: float) -> bool:
    """Whether the reason of a wrong speed, if it is a wheel size, also explains the turn rate.

    The radius of wheels that slide counts for the turn rate by an unknown factor, but not by more
    than for the speed.

    Args:
        forward: The reason of the speed.
        factor: The measured speed relative to the commanded one.
        ratio: The measured turn rate relative to the commanded one.
    """
    if forward is None or forward.code is not robot.WHEEL_DIAMETER_MISMATCH:
        return False
    if factor <= 0.0 or ratio <= 0.0:
        return False
    return abs(math.log(ratio)) <= abs(math.log(factor)) + _AGREES


def _too_weak(found: Sequence[Diagnostic], ratio: float) -> Diagnostic | None:
    """The finding that gains are too low for wheels that have to slide, which turn too slowly."""
    slides = any(
        each.code is robot.SKID_STEERING
        and isinstance(predicted := each.values.get("ratio"), float)
        and 0.0 <= ratio < predicted
        for each in found
    )
    weak = (each for each in found if each.code is CONTROLLER_GAIN_TOO_LOW)
    return next((each for each in weak if slides and "sliding" in each.values), None)


def _slides_more(found: Sequence[Diagnostic], ratio: float) -> Diagnostic | None:
    """The finding that wheels slide, if the robot turns by less than predicted.

    Wheels on which more of the weight rests than assumed slide more.
    """
    skids = next((each for each in found if each.code is robot.SKID_STEERING), None)
    predicted = skids.values.get("ratio") if skids is not None else None
    if skids is None or not isinstance(predicted, float):
        return None
    return skids if _UNEVEN * _least(skids, predicted) <= ratio < predicted else None


def _as_measured(skids: Diagnostic, ratio: float) -> Diagnostic:
    """The finding that wheels slide, with the measured turn rate if it is not the predicted one."""
    estimate, stated = (skids.values.get(name) for name in ("estimate", "stated"))
    predicted = skids.values.get("ratio", estimate)
    if not isinstance(predicted, float) or abs(predicted - ratio) <= _DIFFERS * max(1.0, ratio):
        return skids
    values = skids.values
    hint = ""
    more = "but the stated separation compensates for more than that, " if ratio > 1.0 else ""
    if isinstance(stated, float):
        factor = values.get("factor", 1.0)
        hint = compensation(
            stated,
            factor if isinstance(factor, float) else 1.0,
            str(values.get("multiplier", "")),
            ratio,
            scaled=values.get("measured") is True,
        )
    why = f"the {'tracks' if 'reach' in values else 'wheels'} slide when the robot turns"
    if "hardware" in values:
        why = (
            f'the hardware "{values["hardware"]}" turns all wheels at the same speed, so they slide'
        )
    return replace(
        skids,
        message=f"{why}, {more}so it turns at {ratio:.0%} of the commanded rate, as measured"
        f"{UNKNOWN_SLIP if 'slip' in values else ''}",
        hint=hint,
        values={**skids.values, "measured": ratio},
    )


def _cause(
    found: Sequence[Diagnostic], ratio: float, codes: Set[Code], *, turning: bool, arc: bool
) -> Diagnostic | None:
    crossed = [each for each in found if turning and each.values.get("partly") is True]
    if crossed and ratio < 1.0 - _DIFFERS:
        return crossed[0]
    factors = {
        each.code: (each, factor)
        for each in found
        if (factor := _factor(each, turning)) is not None
    }
    swapped = factors.get(robot.WHEELS_SWAPPED)
    if swapped is not None and ratio > 0.0:
        # It reverses either the drive or the turn.
        factors.pop(robot.WHEELS_SWAPPED)
    if robot.SKID_STEERING in factors:
        # Its ratio contains the stated separation, and the parts that the base drags.
        factors.pop(robot.WHEEL_SEPARATION_MISMATCH, None)
        factors.pop(robot.CASTER_FRICTION, None)
    skids, slowest = factors.get(robot.SKID_STEERING, (None, 1.0))
    size = factors.get(robot.WHEEL_DIAMETER_MISMATCH, (None, 1.0))
    if skids is not None and 1.0 + _TOO_FAST < ratio < size[1] * max(1.0, _rolling(skids)):
        # Wheels that slide only slow the robot down.
        return size[0] if size[1] > 1.0 + _TOO_FAST else skids
    lowest = _least(skids, slowest) * min(1.0, size[1]) if skids is not None else slowest
    if skids is not None and lowest < ratio < max(1.0, _rolling(skids)):
        # Fewer or other wheels than predicted carry the robot, or the friction depends on the
        # direction.
        return skids
    if turning and ratio < -_DIFFERS and any(each.code in _SLOWING for each in found):
        # What slides slows the turn down, but does not change its direction.
        reversing = [each for each, factor in factors.values() if factor < 0.0]
        if len(reversing) == 1:
            return reversing[0]
    if skids is not None and slowest <= _STUCK and -_DIFFERS <= ratio < max(slowest, _DIFFERS):
        # The predicted part may be exactly 0.
        return skids
    product = math.prod(factor for _, factor in factors.values())
    for each, factor in factors.values():
        if _follows(ratio, factor):
            return each
    if factors and _follows(ratio, product):
        # Of several mistakes, the one that contributes most to the error.
        return max(factors.values(), key=lambda pair: (pair[1] - 1.0) * (ratio - 1.0))[0]
    if (combined := _combined(factors, ratio)) is not None:
        return combined
    if swapped is not None and ratio < -_REVERSED:
        return swapped[0]
    if arc and factors:
        # Steering and rim speeds contradict each other, so the wheels slide.
        expected = [1.0, *(factor for _, factor in factors.values())]
        if min(expected) < ratio < max(expected):
            return next(iter(factors.values()))[0]
    toed = next((each for each in found if turning and arc and _pulls(each, ratio)), None)
    if toed is not None:
        return toed
    if 0.0 < ratio < 1.0:
        codes |= {robot.PLANAR_FRICTION, robot.WHEELS_BRAKED}
        if turning and skids is None:
            # Wheels that slide by an unknown amount.
            codes |= {robot.SKID_STEERING}
    held = [each for each in found if each.values.get("holds") is True]
    if held and abs(ratio) < 1.0:
        return most_severe(each for each in found if each.code in codes) or held[0]
    if 1.0 - _BRAKED < ratio < 1.0:
        # A caster may also brake a base that drives straight ahead.
        codes |= {robot.CASTER_FRICTION}
    unknown = most_severe(
        each
        for each in found
        if each.code in codes and not _only_measures(each) and (ratio < 0 or not _reverses(each))
    )
    largest = _largest(factors, ratio)
    driven_twice = any(each.code is running.JOINT_DRIVEN_TWICE for each in found)
    return unknown if unknown is None or largest is None or driven_twice else largest


def _largest(factors: Mapping[Code, tuple[Diagnostic, float]], ratio: float) -> Diagnostic | None:
    """The wrong size that explains most of an error, so that anything else contributes less."""
    sizes = [each for each in factors.values() if "stated" in each[0].values and each[1] > 0.0]
    size = math.prod(factor for _, factor in sizes)
    if not sizes or size == 1.0 or ratio <= 0.0:
        return None
    if abs(math.log(ratio / size)) > _MOST * abs(math.log(size)):
        return None
    return max(sizes, key=lambda pair: math.log(pair[1]) * math.log(size))[0]


def _combined(factors: Mapping[Code, tuple[Diagnostic, float]], ratio: float) -> Diagnostic | None:
    """The reason for a velocity that follows from a wrong size and from parts that are dragged.

    What a base drags slows it down by up to the predicted factor. It is the size that makes a base
    too fast, whatever slows it down. Otherwise, it is what contributes more.
    """
    drags, most = factors.get(robot.CASTER_FRICTION, (None, 1.0))
    sizes = [each for code, each in factors.items() if code is not robot.CASTER_FRICTION]
    size = math.prod(factor for _, factor in sizes)
    if not sizes or size <= 0.0 or not 0.0 < ratio < size:
        return None
    largest = max(sizes, key=lambda pair: (pair[1] - 1.0) * (size - 1.0))[0]
    if ratio > 1.0 + _TOO_FAST:
        return largest
    if drags is None or ratio < size * most * (1.0 - _AGREES):
        return None
    return largest if abs(math.log(size)) >= abs(math.log(ratio / size)) else drags


def _pulls(each: Diagnostic, ratio: float) -> bool:
    """Whether steered wheels that point to one side explain the turn rate of a small angle."""
    toe = each.values.get("toe")
    return (
        each.code is robot.WHEELS_TOED
        and isinstance(toe, float)
        and toe * (ratio - 1.0) > 0
        and abs(ratio - 1.0) < _PULLED
    )


def _reverses(each: Diagnostic) -> bool:
    """Whether it is about wheels that all turn backwards, so that the base moves the other way."""
    return each.code is robot.WHEEL_AXIS_MISALIGNED and each.values.get("all") is True


def _only_measures(each: Diagnostic) -> bool:
    """Whether it is about a plugin that moves nothing, such as one that publishes joint states."""
    return each.code is running.PLUGIN_LEFT_OUT and reports(
        short_name(str(each.values.get("plugin", "")))
    )


def _follows(ratio: float, expected: float) -> bool:
    """Whether a measured ratio follows from a mistake, rather than from none."""
    error = abs(ratio - expected)
    return error <= _AGREES * abs(expected) and error < abs(ratio - 1.0)


def _least(skids: Diagnostic, predicted: float) -> float:
    """The lowest turn rate of wheels that slide, whichever of them carry the robot."""
    least = skids.values.get("least")
    return predicted if not isinstance(least, float) else min(predicted, least * (1.0 - _AGREES))


def _rolling(skids: Diagnostic) -> float:
    """The turn rate of wheels that do not slide, relative to the commanded one."""
    ratio = skids.values.get("rolling")
    return ratio if isinstance(ratio, float) else 1.0


def ignored_torque(found: Iterable[Diagnostic], ratio: float) -> Diagnostic | None:
    """The torque that Gazebo ignores and that is larger than the one it uses, if a base is slow."""
    return next(
        (
            each
            for each in found
            if each.code is PLUGIN_PARAMETER_OBSOLETE
            and isinstance(stated := each.values.get("stated"), float)
            and isinstance(used := each.values.get("used"), float)
            and abs(ratio) < 1.0 < stated / used
        ),
        None,
    )


def is_free(said: Iterable[Diagnostic], topic: str) -> bool:
    """Whether a controller only turns wheels without friction, while another drive pushes them."""
    names = topic.split("/")
    return any(
        each.code is robot.WHEEL_FRICTIONLESS and each.values.get("controller") in names
        for each in said
    )


def _factor(finding: Diagnostic, turning: bool) -> float | None:
    """The velocity relative to the commanded one that follows from a wrong size."""
    values = finding.values
    if finding.code is robot.SKID_STEERING and turning:
        ratio = values.get("ratio")
        return ratio if isinstance(ratio, float) else None
    if finding.code is robot.CASTER_FRICTION and turning:
        ratio = values.get("ratio")
        return ratio if isinstance(ratio, float) and 0.0 < ratio < 1.0 else None
    if finding.code is robot.STEERING_REVERSED and turning:
        return -1.0
    if finding.code is robot.WHEELS_SWAPPED and "partly" in values:
        return None
    if finding.code is robot.WHEELS_SWAPPED:
        # Seen in the other direction, the robot drives backward instead.
        return -1.0
    stated, measured = values.get("stated"), values.get("measured")
    if not isinstance(stated, float) or not isinstance(measured, float) or stated * measured == 0:
        return None
    if finding.code is robot.WHEEL_DIAMETER_MISMATCH:
        return measured / stated
    if turning and finding.code in (robot.WHEEL_SEPARATION_MISMATCH, robot.WHEEL_BASE_MISMATCH):
        return stated / measured
    return None
