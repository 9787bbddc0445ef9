"""What surfaces have of each other: directions of friction, turning on the spot, masks."""

import copy
import ctypes
import math
from pathlib import Path

import mujoco
import numpy as np
import pytest

from cartwheel.description.model import WorldDescription
from cartwheel.simulation.dynamics.friction_directions import Directions
from cartwheel.world import build
from cartwheel.world.entry import ModelEntry
from cartwheel.world.pairs import Alignment

G = 9.8
MU1, MU2 = 0.6, 0.15


def box(surface, *, pose="0 0 0.05 0 0 0", name="box", collision_pose="0 0 0 0 0 0", extra=""):
    """A flat box of 2 kg whose collision has a surface."""
    return f"""<model name="{name}"><pose>{pose}</pose><link name="link">
      <inertial><mass>2</mass><inertia><ixx>0.017</ixx><iyy>0.017</iyy><izz>0.03</izz></inertia>
      </inertial><collision name="c"><pose>{collision_pose}</pose>
      <geometry><box><size>0.3 0.3 0.1</size></box></geometry><surface>{surface}</surface>
      </collision></link>{extra}</model>"""


def friction(mu, mu2, more=""):
    return f"<friction><ode><mu>{mu}</mu><mu2>{mu2}</mu2>{more}</ode></friction>"


def braking(world, heading, speed=2.0, seconds=0.3, model="box"):
    """Mean deceleration in m/s² of the box when it slides at an angle, along and across that."""
    simulation = world.session.simulation
    world.run(0.2)
    way = np.array([math.cos(heading), math.sin(heading)])
    joint = simulation.data.joint(f"{model}::link")
    joint.qvel[:2] = speed * way
    before = joint.qvel[:2].copy()
    start = world.time
    world.run(seconds)
    joint = simulation.data.joint(f"{model}::link")
    lost = (before - joint.qvel[:2]) / (world.time - start)
    return float(lost @ way), float(lost @ np.array([-way[1], way[0]]))


@pytest.mark.parametrize("yaw", [0.0, 0.7, math.pi / 2])
@pytest.mark.parametrize(("mu", "mu2"), [(MU1, MU2), (MU2, MU1)])
def test_a_box_slides_by_one_coefficient_along_fdir1_and_by_the_other_across(make, mu, mu2, yaw):
    """fdir1 is in the collision's axes, so it turns with the box; each braking is mu g."""
    for turn, expected in ((0.0, mu), (math.pi / 2, mu2)):
        model = box(friction(mu, mu2, "<fdir1>1 0 0</fdir1>"), pose=f"0 0 0.05 0 0 {yaw}")
        along, across = braking(make.world(make.sdf(model)), yaw + turn)
        # A sliding body skips: see test_contact.
        assert along == pytest.approx(expected * G, rel=0.05)
        assert across == pytest.approx(0, abs=0.02 * G)


def test_the_direction_turns_with_its_collision(make):
    """The collision is turned by a right angle in its link: its x is the link's y."""
    surface = friction(MU1, MU2, "<fdir1>1 0 0</fdir1>")
    model = box(surface, collision_pose=f"0 0 0 0 0 {math.pi / 2}")
    along, _ = braking(make.world(make.sdf(model)), math.pi / 2)
    assert along == pytest.approx(MU1 * G, rel=0.05)


def test_without_a_direction_the_world_s_axes_count_as_in_ode(make):
    """On level ground ODE's first direction is the world's y, whatever the box's heading."""
    for heading, expected in ((math.pi / 2, MU1), (0.0, MU2)):
        model = box(friction(MU1, MU2), pose="0 0 0.05 0 0 0.7")
        along, _ = braking(make.world(make.sdf(model)), heading)
        assert along == pytest.approx(expected * G, rel=0.05)


def test_a_direction_in_another_link_s_axes(make):
    """A puck that spins on a pole keeps the directions of the link that it names."""
    surface = friction(MU1, 0.0, '<fdir1 gz:expressed_in="pole">1 1 0</fdir1>')
    spin = """<link name="pole"><pose>0 0 0.2 0 0 0</pose><inertial><mass>0.5</mass><inertia>
      <ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial></link>
      <joint name="j" type="revolute"><parent>pole</parent><child>link</child>
      <axis><xyz>0 0 1</xyz></axis></joint>"""
    text = box(surface, extra=spin).replace(
        '<model name="box">', '<model name="box" xmlns:gz="http://gazebosim.org/schema">'
    )
    for heading, expected in ((math.pi / 4, MU1), (-math.pi / 4, 0.0)):
        world = make.world(make.sdf(text))
        simulation = world.session.simulation
        world.run(0.2)
        root = "box::pole" if simulation.engine.free_joint("box", "pole") >= 0 else "box::link"
        way = np.array([math.cos(heading), math.sin(heading)])
        simulation.data.joint(root).qvel[:2] = 2 * way
        simulation.data.joint("box::j").qvel[0] = 1.0
        world.run(0.2)
        speed = simulation.data.joint(root).qvel[:2] @ way
        # All the weight is on the puck, whose corners go faster than they turn. Two bodies on a
        # joint skip more than one does.
        assert (2 - speed) / 0.2 == pytest.approx(expected * G, rel=0.15, abs=0.01 * G)


def test_a_caster_without_friction_across_its_wheel_is_led_sideways(make):
    """mu2 = 0: nothing brakes across, which is also the worst case for the solver."""
    model = box(friction(MU1, 0.0, "<fdir1>1 0 0</fdir1>"))
    along, across = braking(make.world(make.sdf(model)), math.pi / 2)
    assert (along, across) == pytest.approx((0, 0), abs=1e-3 * G)
    along, _ = braking(make.world(make.sdf(model)), 0.0)
    assert along == pytest.approx(MU1 * G, rel=0.05)


def test_of_two_surfaces_each_direction_has_the_smaller_coefficient(make):
    """The ground of 0.3 rules along the box's x, the box's own 0.15 across."""
    for heading, expected in ((0.0, 0.3), (math.pi / 2, MU2)):
        model = box(friction(MU1, MU2, "<fdir1>1 0 0</fdir1>"))
        along, _ = braking(make.world(make.sdf(model), ground=0.3), heading)
        assert along == pytest.approx(expected * G, rel=0.05)


def test_one_box_s_directions_are_not_another_s(make):
    """Two worlds at once share the engine's table; a third box has no directions."""
    first = make.world(make.sdf(box(friction(MU1, MU2, "<fdir1>1 0 0</fdir1>"))))
    second = make.world(make.sdf(box(friction(MU1, MU2, "<fdir1>0 1 0</fdir1>"))))
    plain = make.world(make.sdf(box(friction(MU1, MU1))))
    assert braking(first, 0.0)[0] == pytest.approx(MU1 * G, rel=0.05)
    assert braking(second, 0.0)[0] == pytest.approx(MU2 * G, rel=0.05)
    assert braking(plain, 0.0)[0] == pytest.approx(MU1 * G, rel=0.05)
    first.close()
    assert braking(second, math.pi / 2)[0] == pytest.approx(MU1 * G, rel=0.05)


def test_directions_also_apply_to_copies_of_the_data(make):
    """A copy, with another box's rotation, brakes by its own axes while the original exists."""
    world = make.world(make.sdf(box(friction(MU1, MU2, "<fdir1>1 0 0</fdir1>"))))
    world.run(0.2)
    model, original = world.session.simulation.engine.model, world.session.simulation.data
    joint = original.joint("box::link")
    joint.qvel[:2] = 2.0, 0.0
    same, turned = copy.copy(original), copy.copy(original)
    turned.joint("box::link").qpos[3:] = math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)
    start, steps = original.time, 60
    for data in (original, same, turned):
        mujoco.mj_step(model, data, nstep=steps)
    seconds = original.time - start
    brakings = [
        (2.0 - data.joint("box::link").qvel[0]) / seconds for data in (original, same, turned)
    ]
    assert brakings[0] == brakings[1] == pytest.approx(MU1 * G, rel=0.05)
    assert brakings[2] == pytest.approx(MU2 * G, rel=0.05)


def test_directions_that_make_no_difference_cost_nothing(make):
    """Gazebo's ground has 100 one way and 50 the other; what is on it slips on neither."""
    ground = make.sdf(
        f"""<model name="ground"><static>1</static><link name="l"><collision name="c"><geometry>
        <plane><normal>0 0 1</normal></plane></geometry><surface>{friction(100, 50)}</surface>
        </collision></link></model>"""
    )

    def alignments(mu, mu2):
        thing = make.sdf(box(friction(mu, mu2)))
        entries = [
            ModelEntry(name=each.name, description=each, pose=each.pose) for each in (ground, thing)
        ]
        return len(build(WorldDescription(name="w"), entries).alignments)

    assert alignments(1, 1) == 0
    assert alignments(1000, 1000) == 0
    assert alignments(1000, 1) == 1


def test_the_engine_s_own_functions_return_with_the_last_directions():
    """Otherwise all later worlds of the process would find contacts more slowly."""
    kinds = [int(kind) for kind in (mujoco.mjtGeom.mjGEOM_CAPSULE, mujoco.mjtGeom.mjGEOM_ELLIPSOID)]
    count = int(mujoco.mjtGeom.mjGEOM_SDF) + 1
    library = next(Path(mujoco.__file__).parent.glob("libmujoco*.so*"))
    table = (ctypes.c_void_p * count**2).in_dll(ctypes.CDLL(str(library)), "mjCOLLISIONFUNC")
    place = kinds[0] * count + kinds[1]
    model = mujoco.MjModel.from_xml_string(
        """<mujoco><worldbody><geom name="a" type="capsule" size="1 1"/>
        <geom name="b" type="ellipsoid" size="1 1 1"/></worldbody></mujoco>"""
    )
    pair = Alignment(first="a", second="b", body=None, direction=(1.0, 0.0, 0.0), across=False)
    own = table[place]
    directions = [Directions(model, [pair]) for _ in range(2)]
    assert table[place] != own
    del directions[0]
    assert table[place] != own
    directions.clear()
    assert table[place] == own
    again = Directions(model, [pair])
    assert table[place] != own
    del again
    assert table[place] == own


TORSION = "<friction><ode><mu>1</mu><mu2>1</mu2></ode>{}</friction>"


def spun_ball(make, torsional):
    """rad/s² by which a ball of 1 kg and 0.1 m, spun about the vertical, slows down."""
    model = make.sdf(
        f"""<model name="ball"><pose>0 0 0.1 0 0 0</pose><link name="link"><inertial>
        <mass>1</mass><inertia><ixx>0.004</ixx><iyy>0.004</iyy><izz>0.004</izz></inertia></inertial>
        <collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry>
        <surface>{TORSION.format(torsional)}</surface></collision></link></model>"""
    )
    world = make.world(model)
    world.run(0.2)
    joint = world.session.simulation.data.joint("ball::link")
    joint.qvel[5] = 40.0
    world.run(0.2)
    return (40.0 - world.session.simulation.data.joint("ball::link").qvel[5]) / 0.2


def test_a_patch_brakes_what_turns_on_the_spot(make):
    """The mean arm of a Hertzian patch of radius a is 3π/16 a: the torque is that times mu m g."""
    patch = "<torsional><coefficient>0.8</coefficient><patch_radius>0.02</patch_radius></torsional>"
    expected = 3 * math.pi / 16 * 0.02 * 0.8 * 1 * G / 0.004
    assert spun_ball(make, patch) == pytest.approx(expected, rel=0.02)


def test_a_point_brakes_nothing_that_turns_on_it(make):
    assert spun_ball(make, "") == pytest.approx(0, abs=1e-3)


MASK = "<contact><collide_bitmask>{}</collide_bitmask>{}</contact>"
CATEGORY = "<category_bitmask>{}</category_bitmask>"


@pytest.mark.parametrize(
    ("upper", "lower", "rests"),
    [
        ("", "", True),
        (MASK.format("0x01", ""), MASK.format("0x02", ""), False),
        (MASK.format("0x03", ""), MASK.format("0x02", ""), True),
        (MASK.format("0x01", ""), "", True),
        (MASK.format("0x10000", ""), "", False),
        (MASK.format("0xffff0000", ""), MASK.format("0x80000000", ""), True),
        # The upper one touches what is 0x02, and the lower one is that, though it touches nothing.
        (
            MASK.format("0x02", CATEGORY.format("0x01")),
            MASK.format("0", CATEGORY.format("2")),
            True,
        ),
        ("<contact><collide_without_contact>1</collide_without_contact></contact>", "", False),
    ],
)
def test_bitmasks_say_what_touches_what(make, upper, lower, rests):
    """The lower box is 0.2 m high and stands; the upper one lies on it, or falls through."""
    thing = make.sdf(box(upper, pose="0 0 0.26 0 0 0"))
    stand = box(lower, pose="0 0 0.15 0 0 0", name="stand").replace(
        "<link", "<static>1</static><link"
    )
    world = make.world(thing, make.sdf(stand), ground=None)
    world.run(0.5)
    height = world.session.simulation.pose("box").position[2]
    assert (height > 0.24) is rests


def mecanum(rates):
    """A platform on four wheels of radius 0.1 m with rollers at 45°, turned at rates in rad/s."""
    parts = []
    corners = {"fl": (0.3, 0.25, -1), "fr": (0.3, -0.25, 1), "rl": (-0.3, 0.25, 1),
               "rr": (-0.3, -0.25, -1)}  # fmt: skip
    for (name, (x, y, slant)), rate in zip(corners.items(), rates, strict=True):
        direction = f'<fdir1 gz:expressed_in="base">1 {slant} 0</fdir1>'
        parts.append(
            f"""<link name="{name}"><pose>{x} {y} 0.1 0 0 0</pose><inertial><mass>1</mass><inertia>
            <ixx>0.005</ixx><iyy>0.005</iyy><izz>0.005</izz></inertia></inertial>
            <collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry>
            <surface>{friction(1.0, 0.0, direction)}</surface></collision></link>
            <joint name="{name}" type="revolute"><parent>base</parent><child>{name}</child>
            <axis><xyz>0 1 0</xyz></axis></joint>
            <plugin filename="gz-sim-joint-controller-system" name="{name}">
            <joint_name>{name}</joint_name><initial_velocity>{rate}</initial_velocity></plugin>"""
        )
    return f"""<model name="robot" xmlns:gz="http://gazebosim.org/schema"><link name="base">
      <pose>0 0 0.15 0 0 0</pose><inertial><mass>20</mass><inertia><ixx>0.5</ixx><iyy>0.8</iyy>
      <izz>1.2</izz></inertia></inertial></link>{"".join(parts)}</model>"""


@pytest.mark.parametrize(
    ("rates", "velocity"),
    [
        ((5, 5, 5, 5), (0.5, 0.0, 0.0)),
        ((-5, 5, 5, -5), (0.0, 0.5, 0.0)),
        # On the spot: at each wheel 0.55 m/s per rad/s along its rollers' direction.
        ((-5.5, 5.5, -5.5, 5.5), (0.0, 0.0, 1.0)),
        ((0, 5, 5, 0), (0.25, 0.25, 0.0)),
    ],
)
def test_mecanum_wheels_carry_the_robot_any_way(make, rates, velocity):
    """Across its rollers' axes a wheel's rim goes with the ground: (v + ω x p - r n x) · d = 0."""
    world = make.world(make.sdf(mecanum(rates)))
    world.run(1.5)
    simulation = world.session.simulation
    before, start = simulation.pose("robot"), world.time
    world.run(1.0)
    after, seconds = simulation.pose("robot"), world.time - start
    yaw = (before.yaw + after.yaw) / 2
    x, y = (after.x - before.x) / seconds, (after.y - before.y) / seconds
    moved = (
        math.cos(yaw) * x + math.sin(yaw) * y,
        -math.sin(yaw) * x + math.cos(yaw) * y,
        (after.yaw - before.yaw) / seconds,
    )
    assert moved == pytest.approx(velocity, abs=0.02)
