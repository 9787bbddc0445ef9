"""Bases drive and turn as in Gazebo 11.1, or closer to the command; see bases.py."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
from tests.physics.bases import (
    BASES,
    CARS,
    DAMPING,
    HUGE,
    RADIUS,
    STEERING,
    STIFFNESS,
    STRONGEST,
    WHEELBASE,
    car,
    low,
    skid_steer,
    steering_angles,
    two_wheels,
    wheel_speeds,
)

from cartwheel.codes import world as codes

GAZEBO = json.loads(Path(__file__).with_name("gazebo_turning.json").read_text())
G = 9.8
SPEED, RATE = 0.2, 0.4
"""Commands, m/s and rad/s."""
STEADY, MEASURED = 4.0, 2.0
"""s."""


def driven(make, base, *, without=(), heading=0.0):
    """A world with the base as a model "base" with a differential drive."""
    joints = "".join(f"<left_joint>{name}</left_joint>" for name in base.left)
    joints += "".join(f"<right_joint>{name}</right_joint>" for name in base.right)
    pairs = len(base.left)
    sizes = f"""<wheel_separation>{base.track}</wheel_separation>
      <wheel_diameter>{2 * RADIUS}</wheel_diameter>"""
    steering = "".join(
        f"""<plugin name="{name}" filename="gz-sim-joint-position-controller-system">
        <joint_name>{name}</joint_name><topic>/{name}</topic><p_gain>{STIFFNESS}</p_gain>
        <i_gain>0</i_gain><d_gain>{DAMPING}</d_gain><cmd_max>{STRONGEST}</cmd_max>
        <cmd_min>-{STRONGEST}</cmd_min></plugin>"""
        for name in ("left_steering", "right_steering")
        if name in base.links
    )
    model = make.sdf(
        f"""<model name="base"><pose>0 0 0 0 0 {heading}</pose>{base.links}{steering}
        <plugin name="drive" filename="libgazebo_ros_diff_drive.so">{joints}
        <num_wheel_pairs>{pairs}</num_wheel_pairs>{sizes * pairs}
        <max_wheel_torque>{base.torque}</max_wheel_torque></plugin></model>"""
    )
    world = make.world(without=without)
    world.spawn(model)
    world.run(0.5)
    return world


def motion(world, forward=0.0, turn=0.0):
    """Forward speed in m/s and yaw rate in rad/s after a constant command."""
    world.publish("/cmd_vel", linear_x=forward, angular_z=turn)
    world.run(STEADY)
    before = world.model("base").pose
    world.run(MEASURED)
    after = world.model("base").pose
    x, y = after.x - before.x, after.y - before.y
    along = math.cos(before.yaw) * x + math.sin(before.yaw) * y
    turned = math.remainder(after.yaw - before.yaw, 2 * math.pi)
    return along / MEASURED, turned / MEASURED


def as_good(measured, gazebo, wanted):
    """Within 5 % of Gazebo's value, or no further from the wanted value than Gazebo's is."""
    return abs(measured - gazebo) <= 0.05 * gazebo or abs(measured - wanted) <= abs(gazebo - wanted)


@pytest.mark.parametrize("name", BASES)
def test_a_base_drives_as_in_gazebo_or_as_commanded(make, name):
    recorded = GAZEBO["bases"][name]
    world = driven(make, BASES[name])
    speed, rate = motion(world, forward=SPEED)
    assert as_good(speed, recorded["speed"], SPEED)
    # A symmetric base does not turn: 0.02 % of the rate at which one wheel alone would turn it.
    assert abs(rate) < 2e-4 * SPEED / BASES[name].track
    _, rate = motion(world, turn=RATE)
    assert as_good(rate, recorded["rate"], RATE)


@pytest.mark.parametrize("ratio", [1.0, 1.5, 2.0])
def test_a_skid_steer_on_spheres_turns_as_in_gazebo(make, ratio):
    """Spheres have one point of contact in both. Gazebo's friction depends on the heading."""
    name = f"skid steer {ratio:g}, spheres"
    _, rate = motion(driven(make, BASES[name]), turn=RATE)
    assert rate == pytest.approx(GAZEBO["bases"][name]["rate"], rel=0.05)


@pytest.mark.parametrize("ratio", [0.5, 1.0, 1.5, 2.0])
def test_a_skid_steer_turns_by_coulombs_law(make, ratio):
    """Each wheel slides by t/2 - u lengthwise and b/2 sideways, with a torque of zero in total."""
    world = driven(make, skid_steer(ratio))
    for forward, turn in ((SPEED, 0.0), (SPEED, RATE), (-SPEED, -RATE), (0.0, RATE)):
        _, rate = motion(world, forward=forward, turn=turn)
    assert rate == pytest.approx(RATE / (1 + 1 / ratio**2), rel=0.01)


@pytest.mark.parametrize("turn", [0.4, 0.75])
def test_a_skid_steer_with_an_uneven_load_turns_by_coulombs_law(make, turn):
    """The side with more load slides less, so the base turns about a point beside its middle."""
    aside, base = 0.1, skid_steer(1.1, track=0.57)
    links = base.links.replace("<pose>0.0 0 0.0 0 0 0</pose>", f"<pose>0 {aside} 0 0 0 0</pose>", 1)
    # 20 of the base's 22 kg are in its chassis.
    shift = 20 / 22 * 2 * aside / base.track
    expected = turning_rate(base.track, base.track / 1.1, shift, turn)
    _, rate = motion(driven(make, replace(base, links=links)), turn=turn)
    assert rate == pytest.approx(expected, rel=0.01)


def turning_rate(track, wheelbase, shift, turn):
    """Yaw rate in rad/s for which the friction of four sliding wheels adds up to nothing.

    `shift` is the fraction of the load that is moved to the left wheels.
    """
    rim = turn * track / 2

    def pull(side, ahead, rate):
        """Forward friction of a wheel on a side, relative to the mean load, and its lever arm."""
        along = side * rim - (ahead + side * rate * track / 2)
        across = rate * wheelbase / 2
        load = (1 - side * shift) / math.hypot(along, across)
        return load * along, load * (side * along * track - across * wheelbase) / 2

    def bisect(function, low, high):
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if function(middle) > 0 else (low, middle)
        return low

    def drift(rate):
        return bisect(lambda ahead: sum(pull(side, ahead, rate)[0] for side in (-1, 1)), -1.0, 1.0)

    def torque(rate):
        ahead = drift(rate)
        return sum(pull(side, ahead, rate)[1] for side in (-1, 1))

    return bisect(torque, 1e-6, turn)


def with_tyres(links):
    """The links, where the collision of each wheel belongs to a link of almost no mass."""
    wheel = r'(<link name="(\w+)"><pose relative_to="base">[^<]*</pose>.{0,200}?</inertial>)'
    tyre = r"""\1</link><link name="\2_tyre"><pose relative_to="\2"/><inertial><mass>1e-4</mass>
      <inertia><ixx>1e-7</ixx><iyy>1e-7</iyy><izz>1e-7</izz></inertia></inertial>\3</link>
      <joint name="\2_tyre_joint" type="fixed"><parent>\2</parent><child>\2_tyre</child></joint>"""
    links, count = re.subn(
        wheel + r'(<collision name="tyre">.*?</collision>)</link>', tyre, links, flags=re.DOTALL
    )
    assert count == 4
    return links


@pytest.mark.parametrize("apart", [False, True])
@pytest.mark.parametrize("inertia", [1e-4, 1e-6])
def test_light_wheels_of_a_heavy_skid_steer_follow_their_motors(make, inertia, apart):
    """Their motors do not slip, although the inertia is 25 to 2500 times too small.

    The shapes of the wheels may belong to links that are fixed to them.
    """
    base = skid_steer(1.0)
    wheel = r"(<mass>0.5</mass><inertia>).*?</inertia>"
    light = "".join(f"<{each}>{inertia}</{each}>" for each in ("ixx", "iyy", "izz"))
    links, count = re.subn(wheel, rf"\1{light}</inertia>", base.links, flags=re.DOTALL)
    assert count == 4
    links = links.replace("<mass>20</mass>", "<mass>200</mass>")
    if apart:
        links = with_tyres(links)
    _, rate = motion(driven(make, replace(base, links=links, torque=500.0)), turn=RATE)
    assert rate == pytest.approx(RATE / 2, rel=0.02)


def test_a_motor_replaces_the_dry_friction_of_its_wheel(make):
    """ODE's parameter FMax is both, so friction of twice the motor's torque holds nothing."""
    base = two_wheels()
    rough = f"<dynamics><friction>{2 * base.torque}</friction></dynamics></axis>"
    world = driven(make, replace(base, links=base.links.replace("</axis>", rough)))
    speed, _ = motion(world, forward=SPEED)
    assert speed == pytest.approx(SPEED, rel=0.01)


def test_a_skid_steer_that_drags_a_ball_keeps_its_speed(make):
    """Gazebo loses 3 to 6 % with a ball like this; wheels with softer friction lose a quarter."""
    base = skid_steer(1.0)
    ball = """</collision><collision name="ball"><geometry><sphere><radius>0.1</radius></sphere>
      </geometry></collision></link>"""
    links = base.links.replace("</collision></link>", ball, 1)
    speed, _ = motion(driven(make, replace(base, links=links)), forward=SPEED)
    assert speed == pytest.approx(SPEED, rel=0.06)


def test_a_skid_steer_stands_on_a_slope(make):
    """At 15° it creeps by less than 0.5 mm/s."""
    base, slope = skid_steer(1.0), math.radians(15)
    world = driven(make, base)
    world.session.simulation.model.opt.gravity[:] = (
        G * math.sin(slope), 0.0, -G * math.cos(slope)
    )  # fmt: skip
    world.run(1.0)
    before = world.model("base").pose.position
    world.run(2.0)
    assert math.dist(before, world.model("base").pose.position) < 1e-3


@pytest.mark.parametrize(
    "base",
    [two_wheels(HUGE, HUGE), two_wheels(100.0, 100.0, share=0.45), low(HUGE, HUGE, centre=0.02)],
    ids=["caster", "heavy caster", "low"],
)
def test_friction_of_dragged_parts_does_not_hold_a_base(make, base):
    world = driven(make, base, heading=0.6)
    (note,) = (each for each in world.diagnostics if each.code is codes.FRICTION_LIMITED)
    assert note.values["coefficients"] == (1.0,)
    speed, rate = motion(world, forward=SPEED)
    assert speed == pytest.approx(SPEED, rel=0.01)
    assert abs(rate) < 1e-3
    _, rate = motion(world, turn=RATE)
    assert rate == pytest.approx(RATE, rel=0.01)
    held, _ = motion(driven(make, base, without=["limited-friction"]), forward=SPEED)
    assert held < 0.02 * SPEED


def test_a_skid_steer_turns_at_the_same_rate_with_any_large_coefficient(make):
    """By Coulomb's law the rate does not depend on mu, as long as the torque suffices."""
    rates = [motion(driven(make, skid_steer(1.0, mu)), turn=RATE)[1] for mu in (1.0, 100.0)]
    assert rates[0] == pytest.approx(rates[1], rel=1e-6)


def test_wheels_in_line_and_free_wheels_keep_their_friction(make):
    """Two wheels on one axle roll without sliding; so do those of a car without steering motors."""
    for base in (two_wheels(100.0), car(100.0, 0.04)):
        world = make.world()
        world.spawn(make.sdf(f'<model name="base">{base.links}</model>'))
        assert codes.FRICTION_LIMITED not in {each.code for each in world.diagnostics}


@pytest.mark.parametrize("name", CARS)
def test_a_car_steers_at_a_stand_and_drives_its_circle(make, name):
    recorded, base = GAZEBO["cars"][name], CARS[name]
    world = driven(make, base)
    angles = steering_angles()
    for side, angle in zip(("left", "right"), angles, strict=True):
        world.publish(f"/{side}_steering", data=angle)
    world.run(STEADY)
    for side, angle, found in zip(("left", "right"), angles, recorded["angles"], strict=True):
        assert world.model("base").joint(f"{side}_steering") == pytest.approx(angle, rel=0.05)
        assert found == pytest.approx(angle, rel=0.05)
    left, right = wheel_speeds(SPEED, base.left[0].partition("_")[0])
    forward, turn = (left + right) * RADIUS / 2, (right - left) * RADIUS / base.track
    _, rate = motion(world, forward=forward, turn=turn)
    assert as_good(rate, recorded["rate"], SPEED * math.tan(STEERING) / WHEELBASE)
