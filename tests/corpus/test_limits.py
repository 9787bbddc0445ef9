"""Limits on the velocities that the corpus commands."""

import pytest
from tests.checks.test_steering_and_casters import BODY, REAR
from tests.checks.test_wheel_speed import CAR, CLASSIC, GZ, MECANUM

from cartwheel.checks.robot import Robot
from cartwheel.corpus.limits import StatedLimits, within_speeds
from cartwheel.description import load_robot


@pytest.mark.parametrize("drive", [GZ, CAR, MECANUM, CLASSIC])
def test_the_wheels_of_gz_sim_turn_no_faster_than_their_joints(tmp_path, drive):
    """0.4 rad/s on a radius of 0.1 m, of which 90 % is commanded; the track is 0.3 m."""
    path = tmp_path / "cart.urdf"
    limit = '<axis xyz="0 1 0"/><limit effort="9" velocity="0.4"/>'
    wheels = REAR.replace('<axis xyz="0 1 0"/>', limit)
    path.write_text(f'<robot name="cart">{BODY.format(more="")}{wheels}{drive}</robot>')
    limits = within_speeds(StatedLimits(), Robot(load_robot(path), None), [])
    if drive is CLASSIC:
        assert limits == StatedLimits()
    else:
        assert (limits.forward, limits.turn) == pytest.approx((0.036, 0.24))
