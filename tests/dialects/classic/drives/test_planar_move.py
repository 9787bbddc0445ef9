"""Planar move: its paths, walls and timeouts."""

import math

import numpy as np
import pytest
from tests.devices.drives.carts import (
    FOUR,
    PLANAR,
    RADIUS,
    START,
    circle,
    path,
    spawn,
    where,
)

from cartwheel.codes import running
from cartwheel.errors import PluginError
from cartwheel.geometry import Pose


def test_planar_move_goes_sideways_in_its_own_frame(make, cart, read):
    world = spawn(make, cart(FOUR, PLANAR.format("")), Pose.from_xyz_rpy((0, 0, 0.002), (0, 0, 1)))
    world.publish("/cmd_vel", linear_x=0.2, linear_y=0.4)
    world.run(0.5)
    reported = read(world, "/odom", 4.0)
    assert len(reported) == 80
    (x0, y0, yaw), (x1, y1, _) = where(reported[0]), where(reported[-1])
    seconds = 79 / 20
    cos, sin = math.cos(1), math.sin(1)
    # The tyres' friction mu g takes 1/5 of what the servo has: 0.05 / 5 m/s.
    assert (x1 - x0) / seconds == pytest.approx(0.2 * cos - 0.4 * sin, abs=0.012)
    assert (y1 - y0) / seconds == pytest.approx(0.2 * sin + 0.4 * cos, abs=0.012)
    assert yaw == pytest.approx(1.0, abs=0.01)
    # The friction varies while the wheels turn.
    twists = [message.twist.twist.linear for message in reported]
    assert sum(each.x for each in twists) / len(reported) == pytest.approx(0.2, abs=0.012)
    assert sum(each.y for each in twists) / len(reported) == pytest.approx(0.4, abs=0.012)


def test_planar_move_closes_a_circle_looking_outwards(make, cart, read):
    """Sideways at v and turning at ω: round a centre ahead or behind at v/ω."""
    speed, turn = 0.4, 0.8
    world = spawn(make, cart(FOUR, PLANAR.format(""), mu=0.1))
    world.publish("/cmd_vel", linear_y=speed, angular_z=turn)
    world.run(1.0)
    reported = read(world, "/odom", 2 * math.pi / turn)
    assert circle(path(reported)) == pytest.approx(speed / turn, rel=0.02)
    assert np.linalg.norm(path(reported)[-1] - path(reported)[0]) < 0.06


def test_planar_move_turns_a_wide_body_against_its_friction(make):
    """The torque is for the radius of gyration of the body, not only of its parts."""
    wide = make.sdf(
        """<model name="wide"><link name="base"><pose>0 0 0.05 0 0 0</pose>
        <inertial><mass>20</mass><inertia><ixx>0.61</ixx><iyy>0.61</iyy><izz>1.2</izz></inertia>
        </inertial><collision name="c"><geometry><box><size>0.6 0.6 0.1</size></box></geometry>
        </collision></link>"""
        + PLANAR.format("")
        + "</model>"
    )
    world = make.world()
    world.session.spawn(wide)
    world.publish("/cmd_vel", angular_z=0.4)
    world.run(1.0)
    before = world.model("wide").pose.rpy[2]
    world.run(2.0)
    # The friction of the corners is mu m g 0.42 m; the servo has 5 m g 2 k, with k = 0.35 m.
    turned = (world.model("wide").pose.rpy[2] - before) / 2.0
    assert turned == pytest.approx(0.4 - 0.05 * 0.42 / (5 * 2 * 0.35), abs=0.005)


def test_planar_move_stops_at_a_wall(make, cart):
    wall = make.box("wall", (0.1, 4, 1), static=True, pose=Pose((1.05, 0, 0.5)))
    world = make.world(wall)
    world.session.spawn(cart(FOUR, PLANAR.format("")), pose=START)
    world.publish("/cmd_vel", linear_x=0.5)
    world.run(6.0)
    # Its front wheels touch the wall's face at 1 m, with the give of a contact.
    assert world.model("cart").pose.x == pytest.approx(1.0 - 0.2 - RADIUS, abs=0.02)
    assert abs(world.model("cart").pose.yaw) < 0.05


def test_planar_move_stands_after_its_timeout(make, cart, read):
    world = spawn(make, cart(FOUR, PLANAR.format("<cmdTimeout>0.5</cmdTimeout>")))
    world.publish("/cmd_vel", linear_x=0.4)
    world.run(0.4)
    assert read(world, "/odom", 0.05)[-1].twist.twist.linear.x > 0.35
    world.run(0.5)
    assert abs(read(world, "/odom", 0.05)[-1].twist.twist.linear.x) < 0.01


def test_planar_move_of_what_is_fixed_is_refused(make):
    plugin = PLANAR.format("")
    model = f'<model name="post"><static>1</static><link name="link"/>{plugin}</model>'
    with pytest.raises(PluginError) as caught:
        spawn(make, make.sdf(model))
    assert caught.value.code is running.MODEL_NOT_MOVABLE


TALL = """<model name="tall"><link name="base"><pose>0 0 0.501 0 0 0</pose>
    <inertial><mass>20</mass><inertia><ixx>1.8</ixx><iyy>1.8</iyy><izz>0.3</izz></inertia></inertial>
    <collision name="c"><geometry><box><size>0.3 0.3 1</size></box></geometry></collision></link>
    {}</model>"""


@pytest.mark.parametrize("command", [{"linear_x": 0.3}, {"linear_y": -0.3}])
def test_planar_move_does_not_tip_a_tall_box(make, command):
    """Friction of m g at 0.5 m below the centre of mass exceeds the weight at 0.15 m."""
    world = make.world()
    world.session.spawn(make.sdf(TALL.format(PLANAR.format(""))))
    world.publish("/cmd_vel", **command)
    world.run(6.0)
    roll, pitch, _ = world.model("tall").pose.rpy
    assert abs(roll) < 0.05
    assert abs(pitch) < 0.05
    x, y, _ = world.model("tall").pose.position
    # The friction takes 1/5 of what the servo has: 0.05 / 5 m/s.
    assert math.hypot(x, y) == pytest.approx(6.0 * 0.29, abs=0.05)


def test_planar_move_climbs_a_ramp(make, cart):
    slope = 0.15
    ramp = make.box(
        "ramp",
        (4, 4, 0.2),
        static=True,
        pose=Pose.from_xyz_rpy(
            (1.0 + 2 * math.cos(slope), 0, 2 * math.sin(slope) - 0.1 / math.cos(slope)),
            (0, -slope, 0),
        ),
    )
    world = make.world(ramp)
    world.session.spawn(cart(FOUR, PLANAR.format("")), pose=START)
    world.publish("/cmd_vel", linear_x=0.5)
    world.run(5.0)
    pose = world.model("cart").pose
    assert pose.x > 2.0
    assert pose.rpy[1] == pytest.approx(-slope, abs=0.03)


def test_planar_move_turns_a_wide_plate_whose_stated_inertia_is_small(make):
    """Friction of m g at the corners, 0.7 m from the centre, needs m g 0.7 m / 2 or so."""
    plate = TALL.replace("tall", "plate").replace("0 0 0.501", "0 0 0.02")
    plate = (
        plate.replace("0.3 0.3 1", "1 1 0.04").replace("1.8", "0.003").replace(">0.3<", ">0.003<")
    )
    world = make.world()
    world.session.spawn(make.sdf(plate.format(PLANAR.format(""))))
    world.publish("/cmd_vel", angular_z=0.4)
    world.run(1.0)
    before = world.model("plate").pose.yaw
    world.run(2.0)
    # The servo has 5 m g 0.71 m at an error of 0.05 rad/s, and the corners slide at 0.71 m.
    assert (world.model("plate").pose.yaw - before) / 2.0 == pytest.approx(0.39, abs=0.005)
