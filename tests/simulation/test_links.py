"""What a link reads at a high rate is what it reads otherwise, bit for bit."""

import math

import pytest

import cartwheel as cw
from cartwheel.geometry import yaw_of
from cartwheel.simulation import LinkHandle


@pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), (0.1, 0.2, 0.3)])
def test_numbers_without_arrays(offset):
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro", name="cart", yaw=2.0)
        world.publish("/part2_cmr/cmd_vel", linear_x=0.5, angular_z=0.3)
        world.run(1.0)
        simulation = world.session.simulation
        link = LinkHandle("cart", "base_link")
        link.bind(simulation.model, simulation.data)
        assert list(link.felt(offset)) == link.proper_acceleration(offset).tolist()
        place, turn, linear, angular = link.planar_motion()
        assert (place, turn) == link.place()
        (vx, vy, _), (_, _, rate) = link.motion_at(place)
        cos, sin = math.cos(yaw_of(turn)), math.sin(yaw_of(turn))
        assert linear == (cos * vx + sin * vy, cos * vy - sin * vx, 0.0)
        assert angular == (0.0, 0.0, rate)
        assert linear[0] == pytest.approx(0.5, abs=0.05)
