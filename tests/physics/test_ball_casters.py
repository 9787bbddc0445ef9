"""Balls on two crossed axles, and two balls at one point, neither brake nor turn their base."""

import math

import numpy as np
import pytest

from cartwheel.description import load_text
from cartwheel.geometry import Pose

RADIUS, BEHIND = 0.05, 0.3
"""Of the ball, and its distance from the axle of the driven wheels, m."""
INERTIAL = """<inertial><mass value="{mass}"/>
  <inertia ixx="{i}" ixy="0" ixz="0" iyy="{i}" iyz="0" izz="{i}"/></inertial>"""
WHEEL = """<link name="{side}">{inertial}<collision><origin rpy="1.5707963 0 0"/>
  <geometry><cylinder radius="0.1" length="0.04"/></geometry></collision></link>
<joint name="{side}_joint" type="continuous"><origin xyz="0.1 {y} 0"/><axis xyz="0 1 0"/>
  <parent link="base"/><child link="{side}"/></joint>"""
BASE = """<robot name="cart"><link name="base">{base}<collision><origin xyz="0 0 0.05"/>
  <geometry><box size="0.4 0.2 0.05"/></geometry></collision></link>{parts}
<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">
  <leftJoint>left_joint</leftJoint><rightJoint>right_joint</rightJoint>
  <wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter>
  <wheelTorque>20</wheelTorque></plugin></gazebo></robot>"""
FORWARD, SIDEWAYS = "0 1 0", "1 0 0"
"""The axles about which a ball rolls forward and sideways."""


def part(name, parent, axis, at, *, ball):
    """A link on a continuous joint; a massive ball, or a light link without a shape."""
    shape = f'<collision><geometry><sphere radius="{RADIUS}"/></geometry></collision>'
    inertial = INERTIAL.format(mass=0.1, i=1e-4) if ball else INERTIAL.format(mass=0.01, i=1e-5)
    return f"""<link name="{name}">{inertial}{shape if ball else ""}</link>
    <joint name="{name}_joint" type="continuous"><origin xyz="{at}"/><axis xyz="{axis}"/>
    <parent link="{parent}"/><child link="{name}"/></joint>"""


PLACE = f"{0.1 - BEHIND} 0 {RADIUS - 0.1}"


def crossed(outer, inner):
    light = part("middle", "base", outer, PLACE, ball=False)
    return light + part("ball", "middle", inner, "0 0 0", ball=True)


def two_balls():
    other = part("other", "base", SIDEWAYS, PLACE, ball=True)
    return part("ball", "base", FORWARD, PLACE, ball=True) + other


def cart(make, caster):
    """A world with a cart whose caster carries a third of its weight at μ = 1."""
    wheels = "".join(
        WHEEL.format(side=side, y=y, inertial=INERTIAL.format(mass=0.5, i=1e-3))
        for side, y in (("left", 0.15), ("right", -0.15))
    )
    text = BASE.format(base=INERTIAL.format(mass=5, i=0.05), parts=wheels + caster)
    world = make.world()
    world.spawn(load_text(text, file="cart.urdf"), pose=Pose((0, 0, 0.1005)))
    world.run(0.5)
    return world


def driven(world, forward, turn, seconds=6.0):
    """Speed and turn rate of the axle's middle, and the slip of the ball per way of its centre."""
    world.publish("/cmd_vel", linear_x=forward, angular_z=turn)
    world.run(0.5)
    robot, ball = world.model("cart"), world.model("cart").link("ball")
    way, yaw, slip, rolled = 0.0, 0.0, 0.0, 0.0
    last = robot.pose @ Pose((0.1, 0, 0))
    for _ in range(round(seconds / 0.02)):
        world.run(0.02)
        pose = robot.pose @ Pose((0.1, 0, 0))
        way += math.dist(pose.position, last.position)
        yaw += math.remainder(pose.yaw - last.yaw, math.tau)
        last = pose
        velocity = ball.velocity
        touching = np.cross(velocity.angular, (0, 0, -RADIUS)) + velocity.linear
        slip += math.hypot(*touching[:2])
        rolled += math.hypot(*velocity.linear[:2])
    return way / seconds, yaw / seconds, slip / rolled


@pytest.mark.parametrize("turn", [0.5, 1.5])
def test_two_balls_at_one_point_do_not_brake_a_turn(make, turn):
    """One rolls forward and one sideways. By Coulomb's law, the base turns as commanded: the ball
    that rolls forward carries a sixth of the weight, at twice the lever of the wheels.
    """
    _, rate, _ = driven(cart(make, two_balls()), 0.0, turn)
    assert rate == pytest.approx(turn, rel=0.04)


@pytest.mark.parametrize("axles", [(SIDEWAYS, FORWARD), (FORWARD, SIDEWAYS)])
def test_a_ball_on_crossed_axles_rolls_in_both_directions(make, axles):
    world = cart(make, crossed(*axles))
    speed, rate, slip = driven(world, 0.2, 0.0, seconds=2.0)
    assert (speed, rate) == (pytest.approx(0.2, rel=0.01), pytest.approx(0.0, abs=2e-3))
    assert slip < 0.02
    world = cart(make, crossed(*axles))
    _, rate, slip = driven(world, 0.0, 0.5)
    assert rate == pytest.approx(0.5, rel=0.01)
    assert slip < 0.05


@pytest.mark.parametrize("axles", [(SIDEWAYS, FORWARD), (FORWARD, SIDEWAYS)])
def test_a_ball_on_crossed_axles_slides_while_its_inner_axle_is_upright(make, axles):
    """On an arc, the outer axle turns the inner one past the vertical, where both cannot roll.

    With exact Coulomb friction, the slip is 0.11. The base moves as commanded.
    """
    speed, rate, slip = driven(cart(make, crossed(*axles)), 0.2, 0.5)
    assert speed == pytest.approx(0.2, rel=0.01)
    assert rate == pytest.approx(0.5, rel=0.01)
    assert 0.05 < slip < 0.25


@pytest.mark.parametrize("axles", [(SIDEWAYS, FORWARD), (FORWARD, SIDEWAYS)])
def test_a_base_drives_while_the_inner_axle_is_upright(make, axles):
    world = cart(make, crossed(*axles))
    world.publish("/cmd_vel", angular_z=0.25)
    world.run(RADIUS * math.pi / 2 / BEHIND / 0.25)
    world.publish("/cmd_vel")
    world.run(0.5)
    speed, rate, _ = driven(world, 0.2, 0.0, seconds=2.0)
    assert (speed, rate) == (pytest.approx(0.2, rel=0.01), pytest.approx(0.0, abs=2e-3))


@pytest.mark.parametrize("lower", [0.0, 0.02])
def test_a_ball_that_cannot_roll_and_is_too_low_does_not_slow_a_base(make, lower):
    """A ball that turns only about the vertical slides. The wheels do not slip, however low."""
    ball = part("ball", "base", "0 0 1", f"{0.1 - BEHIND} 0 {RADIUS - 0.1 - lower}", ball=True)
    speed, _, slip = driven(cart(make, ball), 0.2, 0.0, seconds=2.0)
    assert speed == pytest.approx(0.2, rel=0.01)
    assert slip == pytest.approx(1.0, rel=0.02)
