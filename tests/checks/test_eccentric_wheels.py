"""Round wheels whose middle is not on their axis."""

import math

import pytest
from tests.corpus.carts import RADIUS, cart, plugin, written

import cartwheel
from cartwheel.codes.robot import SKID_STEERING, WHEEL_NOT_ROUND
from cartwheel.corpus import try_robot
from cartwheel.corpus.causes.drives import cause_of_drive

WHEEL = '<collision><geometry><cylinder radius="0.05" length="0.02"/>'


def eccentric(offset, times=2):
    """The cart, with wheels whose collisions are moved by a distance in m, at right angles to z."""
    moved = WHEEL.replace("<geometry>", f'<origin xyz="{offset} 0 0"/><geometry>')
    text = cart()
    assert text.count(WHEEL) == 2
    return text.replace(WHEEL, moved, times)


@pytest.mark.parametrize(
    ("offset", "told"), [(0.0, False), (0.04 * RADIUS, False), (-0.06 * RADIUS, True)]
)
def test_a_wheel_that_turns_about_another_point_is_reported(tmp_path, offset, told):
    found = cartwheel.check(written(tmp_path, eccentric(offset), plugin())).findings
    off = [each for each in found if each.code is WHEEL_NOT_ROUND]
    assert len(off) == 2 * told
    assert all(each.values["offset"] == pytest.approx(abs(offset)) for each in off)


@pytest.mark.parametrize(("rollers", "moved"), [(5, False), (7, False), (7, True)])
def test_rollers_around_the_axis_are_on_it(tmp_path, rollers, moved):
    """The middle of five rollers' widths is not the middle of the circle on which they are."""
    ring = "".join(
        f'<collision><origin xyz="{0.7 * RADIUS * math.cos(angle) + 0.1 * RADIUS * moved} '
        f'{0.7 * RADIUS * math.sin(angle)} 0"/><geometry><sphere radius="{0.3 * RADIUS}"/>'
        for angle in (2 * math.pi * each / rollers for each in range(rollers))
    ).replace('"/><coll', '"/></geometry></collision><coll')
    text = cart()
    assert text.count(WHEEL) == 2
    found = cartwheel.check(written(tmp_path, text.replace(WHEEL, ring), plugin())).findings
    assert len([each for each in found if each.code is WHEEL_NOT_ROUND]) == 2 * moved


def test_wheels_whose_size_is_almost_0_are_judged(tmp_path):
    tiny = WHEEL.replace('<cylinder radius="0.05" length="0.02"/>', '<sphere radius="1e-300"/>')
    found = cartwheel.check(written(tmp_path, cart().replace(WHEEL, tiny), plugin())).findings
    assert all(each.code is not WHEEL_NOT_ROUND for each in found)


def test_a_base_that_has_to_climb_its_own_wheels_is_explained(tmp_path):
    heavy = eccentric(0.6 * RADIUS).replace('<mass value="2"/>', '<mass value="40"/>', 1)
    weak = plugin(more="<wheelTorque>0.5</wheelTorque><torque>0.5</torque>")
    verdict = try_robot(written(tmp_path, heavy, weak), standing=1.0)
    reasons = {each.code for each in verdict.faults if each.test in ("drive", "turn")}
    assert reasons == {WHEEL_NOT_ROUND}


def test_wheels_that_slide_explain_a_turn_that_is_slower_than_predicted():
    """More weight than assumed may rest on some of them."""
    sliding = SKID_STEERING.diagnostic("", values={"ratio": 0.33, "least": 0.33})
    for ratio in (0.28, 0.2):
        cause = cause_of_drive([sliding], ratio, turning=True)
        assert cause is not None
        assert cause.code is SKID_STEERING
    assert cause_of_drive([sliding], 0.1, turning=True) is None
    assert cause_of_drive([sliding], -0.28, turning=True) is None
    assert cause_of_drive([sliding], 0.28) is None
