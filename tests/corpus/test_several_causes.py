"""Mistakes that together explain how a base moves."""

import pytest
from tests.corpus.carts import cart, plugin, written

from cartwheel.codes.robot import (
    BODY_ON_GROUND,
    CASTER_FRICTION,
    SKID_STEERING,
    STEERING_REVERSED,
    WHEEL_DIAMETER_MISMATCH,
    WHEEL_FRICTION_OBLIQUE,
    WHEEL_SEPARATION_MISMATCH,
    WHEELS_SWAPPED,
)
from cartwheel.corpus import try_robot
from cartwheel.corpus.causes.drives import cause_of_drive


def dragging(friction: float) -> str:
    """A cart that rests more on one caster behind it, which does not roll, than on its wheels."""
    text = cart(friction)
    front, back = text.index('<link name="front">'), text.index('<link name="back">')
    text = text[:front] + text[back:].replace("back", "caster")
    return text.replace("<inertial>", '<inertial><origin xyz="-0.1 0 0"/>', 1)


@pytest.mark.parametrize(
    ("separation", "reason"),
    [
        (0.2, CASTER_FRICTION),
        # Too fast, although the caster brakes.
        (0.4, WHEEL_SEPARATION_MISMATCH),
        # Too slow for both reasons, of which the separation contributes more.
        (0.1, WHEEL_SEPARATION_MISMATCH),
    ],
)
def test_a_wrong_separation_and_a_caster_that_is_dragged(tmp_path, separation, reason):
    verdict = try_robot(written(tmp_path, dragging(0.5), plugin(separation)), standing=1.0)
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("turn", reason, "file")
    (drive,) = verdict.drives
    assert 0.6 < (1 + drive.error_turn) / (separation / 0.2) < 0.9


@pytest.mark.parametrize(
    ("separation", "radius", "told"),
    [
        (0.2, 0.05, {("turn", WHEELS_SWAPPED)}),
        (0.3, 0.05, {("turn", WHEELS_SWAPPED), ("turn", WHEEL_SEPARATION_MISMATCH)}),
        # The radius is the reason of the speed.
        (0.2, 0.04, {("turn", WHEELS_SWAPPED), ("drive", WHEEL_DIAMETER_MISMATCH)}),
    ],
)
def test_wrong_sizes_are_told_beside_what_explains_more(tmp_path, separation, radius, told):
    drive = plugin(separation).replace("eter>0.1<", f"eter>{2 * radius}<")
    drive = drive.replace("leftJoint", "x").replace("rightJoint", "leftJoint")
    verdict = try_robot(written(tmp_path, cart(), drive.replace("<x", "<rightJoint").replace(
        "</x", "</rightJoint")), standing=1.0)  # fmt: skip
    assert len(verdict.faults) == len(told)
    assert {(each.test, each.code) for each in verdict.faults} == told
    assert verdict.outcome == "file"


SEPARATION = WHEEL_SEPARATION_MISMATCH.diagnostic("", values={"stated": 0.4, "measured": 0.2})
HALF = WHEEL_SEPARATION_MISMATCH.diagnostic("", values={"stated": 0.1, "measured": 0.2})
CASTER = CASTER_FRICTION.diagnostic("", values={"ratio": 0.4})
LOOSE = CASTER_FRICTION.diagnostic("", values={"ratio": None})


@pytest.mark.parametrize(
    ("found", "ratio", "reason"),
    [
        ([CASTER, SEPARATION], 1.6, SEPARATION),
        ([LOOSE, SEPARATION], 1.6, SEPARATION),
        ([SEPARATION], 1.6, SEPARATION),
        ([CASTER, SEPARATION], 0.85, CASTER),
        ([CASTER, HALF], 0.3, HALF),
        ([CASTER, HALF], 0.2, CASTER),
        # Slower than both together.
        ([HALF], 0.2, None),
        # Nothing brakes a base that is exactly as fast as its size says.
        ([CASTER, SEPARATION], 2.0, SEPARATION),
        # Faster than the size says.
        ([SEPARATION], 3.0, None),
    ],
)
def test_a_size_and_a_brake_are_combined(found, ratio, reason):
    assert cause_of_drive(found, ratio, turning=True) is reason


SWAPPED = WHEELS_SWAPPED.diagnostic("")
REVERSED = STEERING_REVERSED.diagnostic("")
SLIDING = SKID_STEERING.diagnostic("", values={"ratio": 0.1})


@pytest.mark.parametrize(
    ("found", "ratio", "reason"),
    [
        ([SLIDING, SWAPPED], -0.06, SWAPPED),
        ([CASTER, SWAPPED], -0.3, SWAPPED),
        ([CASTER, SEPARATION, REVERSED], -0.9, REVERSED),
        # It does not turn at all, as wheels that slide.
        ([SLIDING, SWAPPED], -0.01, SLIDING),
        ([SLIDING], 0.06, SLIDING),
    ],
)
def test_only_what_reverses_a_turn_explains_one_in_the_wrong_direction(found, ratio, reason):
    cause = cause_of_drive(found, ratio, turning=True)
    assert cause is not None
    assert cause.code is reason.code


def test_swapped_wheels_and_a_caster_that_is_dragged(tmp_path):
    swapped = plugin().replace(">left_", ">?").replace(">right_", ">left_").replace(">?", ">right_")
    verdict = try_robot(written(tmp_path, dragging(0.5), swapped), standing=1.0)
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("turn", WHEELS_SWAPPED, "file")


def test_wheels_that_carry_nothing_do_not_drive(tmp_path):
    """The centre of mass is above a caster."""
    heavy = cart(0.1).replace(
        '<inertial><mass value="2"/>', '<inertial><origin xyz="0.12 0 0"/><mass value="20"/>', 1
    )
    verdict = try_robot(written(tmp_path, heavy, plugin()), standing=1.0)
    assert verdict.stands
    assert not verdict.drives[0].follows
    assert {(each.code, each.source) for each in verdict.faults} == {(BODY_ON_GROUND, "file")}


OBLIQUE = WHEEL_FRICTION_OBLIQUE.diagnostic("")


@pytest.mark.parametrize(
    ("ratio", "turning", "reason"),
    [(0.7, False, OBLIQUE), (1.3, False, None), (1.3, True, OBLIQUE), (-1.3, False, OBLIQUE)],
)
def test_friction_makes_no_base_faster_straight_ahead(ratio, turning, reason):
    assert cause_of_drive([OBLIQUE], ratio, turning=turning) is reason
