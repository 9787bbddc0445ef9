"""Joints beyond hinge and slide: their law, from equations of motion."""

import itertools
import math

import numpy as np
import pytest
from tests.coded import coded

import cartwheel as cw
from cartwheel.codes.tags import ELEMENT_LEFT_OUT
from cartwheel.codes.world import MODELS_OVERLAP
from cartwheel.description import load_text

G = 9.8

INERTIAL = """<inertial><mass>{mass}</mass><inertia><ixx>{i}</ixx><iyy>{i}</iyy><izz>{i}</izz>
  </inertia></inertial>"""


def link(name, *, mass=1.0, inertia=0.1, pose="0 0 0 0 0 0"):
    inner = INERTIAL.format(mass=mass, i=inertia)
    return f'<link name="{name}"><pose>{pose}</pose>{inner}</link>'


def joint(name, kind, parent, child, more):
    return (
        f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>'
        f"{more}</joint>"
    )


def run(make, *parts, gravity=G):
    model = "".join(parts)
    return make.world(
        make.sdf(f'<model name="m"><pose>0 0 2 0 0 0</pose>{model}</model>'),
        ground=None,
        gravity=gravity,
    )


def data_of(world):
    world.session.simulation.refresh()
    return world.session.simulation.data


@pytest.mark.parametrize("pitch", [0.02, -0.02])
def test_a_nut_on_a_screw_sinks_as_its_thread_lets_it(make, pitch):
    mass, inertia = 2.0, 1e-4
    thread = f"<axis><xyz>0 0 1</xyz></axis><screw_thread_pitch>{pitch}</screw_thread_pitch>"
    world = run(
        make,
        link("nut", mass=mass, inertia=inertia),
        joint("screw", "screw", "world", "nut", thread),
    )
    world.run(1.0)
    data = data_of(world)
    angle = float(data.joint("m::screw").qpos[0])
    travel = float(data.body("m::nut").xpos[2]) - 2.0
    # m a = m g - (what turns the nut) with a turn's worth of angle for each pitch of travel.
    acceleration = G / (1 + inertia * (2 * math.pi / pitch) ** 2 / mass)
    assert travel == pytest.approx(-acceleration / 2, rel=0.02)
    assert abs(angle) > 10 * math.pi
    assert travel / angle == pytest.approx(pitch / (2 * math.pi), rel=1e-3)


def test_the_second_axis_of_a_steered_wheel_goes_with_the_first(make):
    axes = (
        "<axis><xyz>0 0 1</xyz><limit><lower>-2</lower><upper>2</upper></limit></axis>"
        "<axis2><xyz>0 1 0</xyz></axis2>"
    )
    world = run(make, link("wheel"), joint("hub", "revolute2", "world", "wheel", axes), gravity=0.0)
    data = data_of(world)
    data.joint("m::hub").qpos[0] = 1.2
    data.joint("m::hub::axis2").qvel[0] = 3.0
    world.run(0.5)
    # A body of three equal moments keeps its spin: about y, turned by 1.2 about z.
    spin = data.body("m::wheel").cvel[:3]
    assert spin == pytest.approx((-3 * math.sin(1.2), 3 * math.cos(1.2), 0), abs=1e-6)
    assert data.joint("m::hub").qpos[0] == pytest.approx(1.2, abs=1e-9)


@pytest.mark.parametrize(("kind", "turns"), [("ball", True), ("universal", False)])
def test_only_a_ball_lets_the_shaft_turn_about_itself(make, kind, turns):
    axes = "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2>"
    inertia, torque = 0.1, 0.2
    world = run(
        make,
        link("shaft", inertia=inertia, pose="0 0 -1 0 0 0"),
        joint("j", kind, "world", "shaft", ("<pose>0 0 1 0 0 0</pose>") + axes * (not turns)),
    )
    data_of(world).body("m::shaft").xfrc_applied[5] = torque
    world.run(1.0)
    spin = float(data_of(world).body("m::shaft").cvel[2])
    assert spin == pytest.approx(torque / inertia if turns else 0.0, abs=1e-6)


GEARS = (
    link("case", mass=50, inertia=5),
    link("small", inertia=0.02, pose="0.1 0 0 0 0 0"),
    link("large", inertia=0.5, pose="-0.3 0 0 0 0 0"),
    joint("anchor", "fixed", "world", "case", ""),
)


@pytest.mark.parametrize("flipped", [False, True])
def test_a_gearbox_turns_the_child_by_its_ratio_the_other_way(make, flipped):
    ratio, torque = 3.0, 0.5
    # The sense of the second hinge's own axis must not matter: the gearbox's axis2 rules.
    axis = "<axis><xyz>0 0 {}</xyz></axis>"
    world = run(
        make,
        *GEARS,
        joint("a", "revolute", "case", "large", axis.format(1)),
        joint("b", "revolute", "case", "small", axis.format(-1 if flipped else 1)),
        joint(
            "box",
            "gearbox",
            "large",
            "small",
            f"<gearbox_ratio>{ratio}</gearbox_ratio>"
            "<gearbox_reference_body>case</gearbox_reference_body>"
            "<axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 0 1</xyz></axis2>",
        ),
        gravity=0.0,
    )
    assert not [d for d in world.session.diagnostics if d.severity != "info"]
    data = data_of(world)
    data.body("m::large").xfrc_applied[5] = torque
    world.run(1.0)
    # Both turn together: the small one's inertia counts by the square of the ratio.
    rate = torque / (0.5 + ratio**2 * 0.02)
    assert float(data.body("m::large").cvel[2]) == pytest.approx(rate, rel=0.01)
    assert float(data.body("m::small").cvel[2]) == pytest.approx(-ratio * rate, rel=0.01)


def test_a_gearbox_at_a_limit_holds_both_joints(make):
    axis = "<axis><xyz>0 0 1</xyz>{}</axis>"
    limit = "<limit><lower>-0.3</lower><upper>0.3</upper></limit>"
    world = run(
        make,
        *GEARS,
        joint("a", "revolute", "case", "large", axis.format("")),
        joint("b", "revolute", "case", "small", axis.format(limit)),
        joint(
            "box",
            "gearbox",
            "large",
            "small",
            "<gearbox_ratio>3</gearbox_ratio>"
            "<gearbox_reference_body>case</gearbox_reference_body>"
            "<axis><xyz>0 0 1</xyz></axis><axis2><xyz>0 0 1</xyz></axis2>",
        ),
        gravity=0.0,
    )
    data = data_of(world)
    data.body("m::large").xfrc_applied[5] = 0.5
    world.run(2.0)
    assert world.session.simulation.joint_position("m", "a") == pytest.approx(0.1, abs=0.01)


def test_a_gearbox_without_hinges_says_so(make):
    model = make.sdf(
        '<model name="m">'
        + "".join(GEARS)
        + joint("f1", "fixed", "case", "large", "")
        + joint("f2", "fixed", "case", "small", "")
        + joint("box", "gearbox", "large", "small", "")
        + "</model>"
    )
    (reported,) = [each for each in model.diagnostics if each.severity == "warning"]
    assert (reported.code, reported.values["name"]) == (ELEMENT_LEFT_OUT, "box")


@pytest.mark.parametrize("kind", ["fixed", "revolute"])
def test_a_joint_that_closes_a_loop_holds_the_axis_too(make, kind):
    """A bar on two posts: pushed sideways at its end it must not turn about the second joint."""
    axis = "<axis><xyz>0 1 0</xyz></axis>"
    world = run(
        make,
        link("left", pose="0 0 0 0 0 0"),
        link("bar", pose="1 0 0 0 0 0"),
        joint("anchor", "fixed", "world", "left", ""),
        joint("first", "ball", "left", "bar", "<pose>-1 0 0 0 0 0</pose>"),
        joint("second", kind, "left", "bar", axis * (kind != "fixed")),
    )
    data_of(world).body("m::bar").xfrc_applied[3:] = (5.0, 0.0, 5.0)
    world.run(1.0)
    turned = 2 * np.linalg.norm(data_of(world).body("m::bar").xquat[[1, 3]])
    # The torque of 5 N m on a soft constraint: a hundredth of a degree for each N m.
    assert turned < 0.02


JOINED = """<sdf version="1.10"><world name="w"><gravity>0 0 -9.8</gravity>
  <model name="a"><pose>0 0 2 0 0 0</pose><link name="l">{solid}</link></model>
  <model name="b"><pose>{pose}</pose><link name="l">{solid}</link></model>
  <joint name="held" type="fixed"><parent>world</parent><child>a</child></joint>
  <joint name="j" type="{type}"><parent>a</parent><child>b</child>
    <pose>0 0 {arm} 0 0 0</pose><axis><xyz>0 1 0</xyz></axis></joint></world></sdf>"""
SOLID = (
    INERTIAL.format(mass=1.0, i=0.01)
    + """<collision name="c"><geometry><box><size>0.6 0.6 0.6</size></box></geometry></collision>"""
)


def joined(kind, pose, arm=0.0):
    text = JOINED.format(type=kind, pose=pose, arm=arm, solid=SOLID)
    return cw.World(load_text(text, file="w.sdf"))


def test_a_fixed_joint_of_the_world_holds_two_models_that_do_not_collide():
    """0.5 m aside with boxes of 0.6 m: what holds them bears 1 kg at that arm."""
    with joined("fixed", "0.5 0 2 0 0 0") as world:
        world.run(1.0)
        assert world.model("a").pose.position == pytest.approx((0, 0, 2), abs=1e-9)
        pose = world.model("b").pose
        assert pose.position == pytest.approx((0.5, 0, 2), abs=1e-3)
        assert pose.rpy == pytest.approx((0, 0, 0), abs=1e-3)
        assert not coded(world, MODELS_OVERLAP)


def test_a_hinge_between_models_swings_as_a_pendulum():
    """T = 2 pi sqrt((I + m l^2) / (m g l)), from 0.1 rad; the amplitude adds a part in 1600."""
    arm, tilt = 0.5, 0.1
    start = f"{-arm * math.sin(tilt)} 0 {2 - arm * math.cos(tilt)} 0 {tilt} 0"
    period = 2 * math.pi * math.sqrt((0.01 + arm**2) / (G * arm))
    way = arm * math.sin(tilt)
    with joined("revolute", start, arm) as world:
        # 1 % of a period is 6 % of the way where it is fastest: half of that.
        for part, expected in ((0.25, 0.0), (0.5, way), (0.75, 0.0), (1.0, -way)):
            world.run(part * period - world.time)
            assert world.model("b").pose.position[0] == pytest.approx(expected, abs=0.03 * way)
            assert world.model("b").pose.position[1] == pytest.approx(0, abs=1e-4)


def test_a_model_stands_free_when_what_it_was_joined_to_is_deleted():
    with joined("fixed", "0.5 0 2 0 0 0") as world:
        world.model("a").delete()
        world.run(0.5)
        assert world.model("b").pose.position[2] == pytest.approx(2 - G * 0.125, abs=0.02)


def test_a_joint_that_friction_holds_does_not_creep(make):
    # Two thirds of the friction hold the weight: 9.8 N at 0.1 m against 1.5 N m.
    lever = link("lever", inertia=0.01).replace(
        "<inertial>", "<inertial><pose>0.1 0 0 0 0 0</pose>"
    )
    axis = "<axis><xyz>0 1 0</xyz><dynamics><friction>{}</friction></dynamics></axis>"
    angles = {}
    for friction in (1.5, 0.9):
        world = run(make, lever, joint("j", "revolute", "world", "lever", axis.format(friction)))
        world.run(5.0)
        angles[friction] = float(data_of(world).joint("m::j").qpos[0])
    assert abs(angles[1.5]) < 1e-4
    assert angles[0.9] > 0.5


@pytest.mark.parametrize("frequency", [0.5, 2.0])
@pytest.mark.parametrize("step", [0.001, 0.005])
def test_a_spring_loses_what_the_step_takes(make, frequency, step):
    """The step solves (1 + (ω h)²) v' = v − h ω² q, which has the factor 1 / sqrt(1 + (ω h)²)."""
    omega, inertia = 2 * math.pi * frequency, 0.1
    spring = f"<axis><xyz>0 0 1</xyz><dynamics><spring_stiffness>{inertia * omega**2}"
    spring += "</spring_stiffness></dynamics></axis>"
    hinge = joint("hinge", "revolute", "world", "arm", spring)
    text = f'<sdf version="1.9"><model name="m">{link("arm", inertia=inertia)}{hinge}</model></sdf>'
    with cw.World("empty", step_size=step) as world:
        arm = world.spawn(text, z=2.0)
        arm.joints["hinge"].position = 0.5
        positions = []
        for _ in range(4):
            period = []
            for _ in range(round(1 / (frequency * step))):
                world.step()
                period.append(arm.joint("hinge"))
            positions.append(max(period[len(period) // 2 :]))
        lost = (1 + (omega * step) ** 2) ** (-math.pi / (omega * step))
        assert lost == pytest.approx(math.exp(-math.pi * omega * step), rel=0.01)
        for before, after in itertools.pairwise(positions):
            # The extremes are missed by half a step at most.
            assert after / before == pytest.approx(lost, rel=(omega * step) ** 2 + 1e-3)
