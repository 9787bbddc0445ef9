"""Friction, resting, hitting, sleeping."""

import itertools
import math

import numpy as np
import pytest

from cartwheel.geometry import Pose, quat_from_rpy
from cartwheel.world import contact
from cartwheel.world.build import DEFAULT_STEP

G = 9.8


def slide_down(make, degrees, mu_ramp, mu_box):
    """Acceleration in m/s² and way in m of a flat box let go on a slope, over one second."""
    slope = math.radians(degrees)
    down = np.array([math.cos(slope), 0, -math.sin(slope)])
    up = np.array([math.sin(slope), 0, math.cos(slope)])
    turn = quat_from_rpy(0, slope, 0)
    ramp = make.box(
        "ramp", (20, 2, 0.2), mu=mu_ramp, pose=Pose(tuple(-0.1 * up), turn), static=True
    )
    block = make.box("block", (0.3, 0.3, 0.1), mu=mu_box, pose=Pose(tuple(0.05 * up), turn))
    world = make.world(ramp, block, ground=None)
    world.run(0.2)
    times, ways = [], []
    simulation = world.session.simulation
    simulation.schedule(
        0,
        after=lambda: (
            times.append(world.time),
            ways.append(float(np.array(simulation.pose("block").position) @ down)),
        ),
    )
    world.run(1.0)
    return 2 * np.polyfit(times, ways, 2)[0], ways[-1] - ways[0]


def velocity(world, model):
    return world.session.simulation.data.joint(f"{model}::link").qvel[:3].copy()


@pytest.mark.parametrize("pair", [(0.5, 0.5), (0.5, 1.0), (1.0, 0.5), (0.5, 100.0)])
def test_slope_below_the_friction_angle_holds(make, pair):
    """atan 0.5 is 26.57°: at 25° a box stays."""
    assert math.degrees(math.atan(0.5)) > 25
    _, way = slide_down(make, 25, *pair)
    assert abs(way) < 1e-4


@pytest.mark.parametrize("pair", [(0.5, 0.5), (0.5, 1.0), (1.0, 0.5)])
@pytest.mark.parametrize("degrees", [28, 35])
def test_slope_above_the_friction_angle_slides(make, degrees, pair):
    slope = math.radians(degrees)
    acceleration, _ = slide_down(make, degrees, *pair)
    expected = G * (math.sin(slope) - 0.5 * math.cos(slope))
    # A sliding body skips along (docs/physics.md): the mean is right to one part in a hundred
    # of g, as an error of one degree in the slope would make it.
    assert acceleration == pytest.approx(expected, abs=0.01 * G)


@pytest.mark.parametrize("order", list(itertools.permutations(["slippery", "middling", "rough"])))
def test_friction_of_a_pair_is_the_smaller_whatever_the_order(make, order):
    """Three boxes and the ground of 0.5: each brakes with g min(mu, 0.5)."""
    mus = {"slippery": 0.1, "middling": 0.4, "rough": 2.0}
    boxes = [
        make.box(name, (0.4, 0.4, 0.1), mu=mus[name], pose=Pose((0, 2.0 * i, 0.05)))
        for i, name in enumerate(order)
    ]
    world = make.world(*boxes, ground=0.5)
    world.run(0.2)
    for name in order:
        world.session.simulation.data.joint(f"{name}::link").qvel[0] = 4.0
    for name, way in ways_of(world, order, 0.5).items():
        braked = -2 * np.polyfit(way[:, 0], way[:, 1], 2)[0]
        # Skipping makes a fit over half a second uncertain by a few parts in a hundred: far
        # less than any other of the coefficients would be off.
        assert braked == pytest.approx(G * min(mus[name], 0.5), rel=0.05), name


def ways_of(world, names, seconds):
    """Time in s and x in m of free bodies at every step."""
    simulation = world.session.simulation
    ways = {name: [] for name in names}

    def note():
        for name in names:
            ways[name].append((world.time, simulation.pose(name).x))

    simulation.schedule(0, after=note)
    world.run(seconds)
    return {name: np.array(way) for name, way in ways.items()}


@pytest.mark.parametrize(("top", "bottom"), [(0.2, 0.8), (0.8, 0.2)])
def test_friction_between_two_boxes_is_the_smaller(make, top, bottom):
    """The lower box stands on rough ground, so the upper one slides on it alone."""
    lower = make.box("lower", (4, 0.6, 0.2), mass=200, mu=bottom, pose=Pose((0, 0, 0.1)))
    upper = make.box("upper", (0.4, 0.4, 0.1), mu=top, pose=Pose((-1, 0, 0.25)))
    world = make.world(lower, upper)
    world.run(0.2)
    world.session.simulation.data.joint("upper::link").qvel[0] = 2.0
    way = ways_of(world, ["upper", "lower"], 0.5)
    braked = -2 * np.polyfit(way["upper"][:, 0], way["upper"][:, 1] - way["lower"][:, 1], 2)[0]
    assert braked == pytest.approx(G * 0.2, rel=0.05)


def test_a_sliding_body_is_hardly_lifted(make):
    """Friction that stops a slip within FRICTION_TIME_CONSTANT lifts by mu v b/k, and no more.

    b is 2/FRICTION_TIME_CONSTANT and k 1/STIFFEST_TIME_CONSTANT²; a skip may reach as high
    again as the gap within a step of the climb.
    """
    speed, mu = 2.0, 0.5
    world = make.world(make.box("box", (0.3, 0.3, 0.2), mu=mu, pose=Pose((0, 0, 0.1))))
    simulation = world.session.simulation
    world.run(0.2)
    simulation.data.joint("box::link").qvel[0] = speed
    heights = []
    simulation.schedule(0, after=lambda: heights.append(simulation.pose("box").z - 0.1))
    world.run(1.0)
    gap = mu * speed * 2 / contact.FRICTION_TIME_CONSTANT * contact.STIFFEST_TIME_CONSTANT**2
    assert max(heights) < 2 * gap
    assert velocity(world, "box")[0] == pytest.approx(0.0, abs=1e-3)


def test_friction_is_full_from_a_creep_on(make):
    """Pulled along at v, a box drags with mu m g from v = mu g T/2 on, below it with 2 m v/T."""
    mass, mu = 2.0, 0.5
    box = make.box("box", (0.3, 0.3, 0.1), mass=mass, mu=mu, pose=Pose((0, 0, 0.05)))
    world = make.world(box)
    world.run(0.2)
    simulation = world.session.simulation
    creep = mu * G * contact.FRICTION_TIME_CONSTANT / 2
    for force, speed in ((0.5 * mu * mass * G, 0.5 * creep), (0.9 * mu * mass * G, 0.9 * creep)):
        simulation.data.body("box::link").xfrc_applied[0] = force
        world.run(1.0)
        assert velocity(world, "box")[0] <= speed * 1.05
    simulation.data.body("box::link").xfrc_applied[0] = 1.2 * mu * mass * G
    before = velocity(world, "box")[0]
    world.run(1.0)
    assert velocity(world, "box")[0] - before == pytest.approx(0.2 * mu * G, rel=0.1)


def test_only_moving_geoms_of_other_models_get_a_pair_of_their_own(make):
    """And friction of such a pair is the smaller of the two, as for all others."""
    world = make.world(
        make.box("wall", (1, 1, 1), mu=0.2, static=True, pose=Pose((5, 0, 0.5))),
        make.box("box", (0.3, 0.3, 0.3), mu=0.5, pose=Pose((0, 0, 0.15))),
        make.box("other", (0.3, 0.3, 0.3), mu=0.7, pose=Pose((0, 2, 0.15))),
    )
    model = world.session.simulation.model
    pairs = {
        (model.geom(model.pair_geom1[i]).name, model.geom(model.pair_geom2[i]).name): float(
            model.pair_friction[i, 0]
        )
        for i in range(model.npair)
    }
    ground, wall = "ground_plane::link::collision", "wall::link::collision"
    box, other = "box::link::collision", "other::link::collision"
    found = {tuple(sorted(names)): mu for names, mu in pairs.items()}
    assert found == {
        tuple(sorted((ground, box))): 0.5,
        tuple(sorted((ground, other))): 0.7,
        tuple(sorted((wall, box))): 0.2,
        tuple(sorted((wall, other))): 0.2,
    }


def test_priorities_rise_as_friction_falls():
    ranks = contact.priorities([1.0, 0.3, 100.0, 0.3])
    assert ranks[0.3] > ranks[1.0] > ranks[100.0]


def test_contact_stiffness_is_that_of_kp_and_kd():
    """ω = √(kp/m), ζ = kd/(2√(kp m)); solref is 1/(ζω) and ζ, within what a step can resolve."""
    from cartwheel.description.model import Surface

    mass, kp, kd = 10.0, 4000.0, 800.0
    omega, zeta = math.sqrt(kp / mass), kd / (2 * math.sqrt(kp * mass))
    assert zeta > 1
    constant, ratio = contact.reference(Surface(kp=kp, kd=kd), mass, 0.001)
    assert (constant, ratio) == pytest.approx((1 / (zeta * omega), zeta))
    # Rigid by default, and never stiffer than two steps.
    assert contact.reference(Surface(), mass, 0.001) == (0.01, 1.0)
    assert contact.reference(Surface(), mass, 0.02)[0] == pytest.approx(0.04)


def drop(make, height, step=None):
    """Heights of a ball's bottom over time after it was let go."""
    radius, mass = 0.1, 1.0
    inertia = 0.4 * mass * radius**2
    ball = make.sdf(
        f"""<model name="ball"><pose>0 0 {height + radius} 0 0 0</pose><link name="link">
        <inertial><mass>{mass}</mass>
          <inertia><ixx>{inertia}</ixx><iyy>{inertia}</iyy><izz>{inertia}</izz></inertia></inertial>
        <collision name="c"><geometry><sphere><radius>{radius}</radius></sphere></geometry>
        </collision></link></model>"""
    )
    world = make.world(ball, step=step)
    simulation = world.session.simulation
    heights = []
    simulation.schedule(0, after=lambda: heights.append(simulation.pose("ball").z - radius))
    world.run(3.0)
    return np.array(heights)


def test_a_dropped_ball_neither_bounces_nor_sinks(make):
    height = 0.5
    heights = drop(make, height)
    speed = math.sqrt(2 * G * height)
    # A critically damped spring of time constant T gives way by v T/e; a step may pass before
    # the ground is felt.
    deepest = speed * (contact.STIFFEST_TIME_CONSTANT / math.e + DEFAULT_STEP)
    assert -deepest < heights.min() < 0
    landed = int(np.argmax(heights < 0))
    # No restitution: what comes back of the energy is less than one part in a hundred.
    assert heights[landed:].max() < 0.01 * height
    assert abs(heights[-1]) < 1e-4


def test_a_stack_stays(make):
    boxes = [
        make.box(
            f"box_{i}", (0.4, 0.4, 0.4), mass=3, mu=0.5, pose=Pose((0.01 * i, 0, 0.2 + 0.4 * i))
        )
        for i in range(4)
    ]
    world = make.world(*boxes)
    world.run(1.0)
    settled = [world.model(f"box_{i}").pose for i in range(4)]
    world.run(60.0)
    for i, before in enumerate(settled):
        after = world.model(f"box_{i}").pose
        assert math.dist(before.position, after.position) < 1e-4
        # Each interface gives way by less than a tenth of a millimetre.
        assert after.z == pytest.approx(0.2 + 0.4 * i, abs=1e-4 * (i + 1))
        assert abs(after.yaw) < 1e-4


def asleep(world, model):
    simulation = world.session.simulation
    tree = simulation.model.body_treeid[simulation.model.body(f"{model}::link").id]
    return not simulation.data.tree_awake[tree]


def test_a_resting_body_sleeps_and_wakes_when_hit(make):
    """A sliding box hits one asleep: momentum passes on as if it had been awake."""
    sleeper = make.box("sleeper", (0.4, 0.4, 0.4), mu=0.0, pose=Pose((0, 0, 0.2)))
    runner = make.box("runner", (0.4, 0.4, 0.4), mu=0.0, pose=Pose((-3, 0, 0.2)))
    world = make.world(sleeper, runner)
    world.run(3.0)
    assert asleep(world, "sleeper")
    world.session.simulation.data.joint("runner::link").qvel[0] = 2.0
    world.run(3.0)
    assert not asleep(world, "sleeper")
    moved = velocity(world, "sleeper")[0]
    # Equal masses without restitution move on together or apart, with all of the momentum.
    assert moved >= 1.0 - 1e-3
    assert moved + velocity(world, "runner")[0] == pytest.approx(2.0, rel=1e-3)


def test_what_rests_on_a_deleted_body_falls(make):
    world = make.world(
        make.box("table", (1, 1, 0.5), pose=Pose((0, 0, 0.25)), static=True),
        make.box("cup", (0.1, 0.1, 0.1), pose=Pose((0, 0, 0.55))),
    )
    world.run(3.0)
    assert asleep(world, "cup")
    world.model("table").delete()
    world.run(0.2)
    fallen = 0.55 - world.model("cup").pose.z
    n = round(0.2 / DEFAULT_STEP)
    assert fallen == pytest.approx(G * DEFAULT_STEP**2 * n * (n + 1) / 2, abs=2e-4)


def test_a_body_moved_in_its_sleep_falls(make):
    world = make.world(make.box("cup", (0.1, 0.1, 0.1), pose=Pose((0, 0, 0.05))))
    world.run(3.0)
    assert asleep(world, "cup")
    world.model("cup").pose = Pose((1, 2, 1))
    assert world.model("cup").pose.position == (1, 2, 1)
    world.run(0.2)
    n = round(0.2 / DEFAULT_STEP)
    fallen = G * DEFAULT_STEP**2 * n * (n + 1) / 2
    assert world.model("cup").pose.z == pytest.approx(1 - fallen, rel=1e-9)


RESTS = range(5, 60)
"""Steps of rest after which a box is awake, about to fall asleep, or asleep."""
FALL = 20
"""Steps."""
FALLEN = pytest.approx(G * DEFAULT_STEP**2 * FALL * (FALL + 1) / 2, abs=2e-3)
"""m; a box on the ground still springs a little after few steps."""


def falls(world, change):
    """How far the cup falls after a change that follows each number of steps of rest, m."""
    found, slept = [], set()
    for rest in RESTS:
        world.reset()
        world.run(rest * DEFAULT_STEP)
        slept.add(bool(asleep(world, "cup")))
        change()
        start = world.model("cup").pose.z
        world.run(FALL * DEFAULT_STEP)
        found.append(start - world.model("cup").pose.z)
    assert slept == {True, False}
    return found


@pytest.mark.parametrize("how", ["set_pose", "set_state"])
def test_a_body_moved_as_it_falls_asleep_falls(make, how):
    world = make.world(make.box("cup", (0.1, 0.1, 0.1), pose=Pose((0, 0, 0.05))))

    def lift():
        getattr(world.session.simulation, how)("cup", Pose((0, 0, 1)))

    assert falls(world, lift) == [FALLEN] * len(RESTS)


def test_a_body_held_in_the_air_falls_when_it_is_let_go(make):
    """As the web interface holds a dragged model, in a simulation that is as slow as its images."""
    world = make.world(make.box("cup", (0.1, 0.1, 0.1), pose=Pose((0, 0, 0.05))))
    for _ in range(40):
        world.model("cup").pose = Pose((0, 0, 1))
        world.run(DEFAULT_STEP)
    world.model("cup").pose = Pose((0, 0, 1))
    world.run(FALL * DEFAULT_STEP)
    assert 1 - world.model("cup").pose.z == FALLEN


@pytest.mark.parametrize("static", [False, True])
def test_a_body_that_falls_asleep_as_its_support_is_moved_falls(make, static):
    table = make.box("table", (1, 1, 0.5), pose=Pose((0, 0, 0.25)), static=static)
    world = make.world(table, make.box("cup", (0.1, 0.1, 0.1), pose=Pose((0, 0, 0.55))))

    def pull():
        world.model("table").pose = Pose((3, 0, 0.25))

    assert falls(world, pull) == [FALLEN] * len(RESTS)


def test_a_body_that_falls_asleep_as_gravity_begins_falls(make):
    world = make.world(make.box("cup", (0.1, 0.1, 0.1), pose=Pose((0, 0, 1))), gravity=0.0)
    for rest in range(1, 20):
        world.gravity = (0.0, 0.0, 0.0)
        world.reset()
        world.run(rest * DEFAULT_STEP)
        world.gravity = (0.0, 0.0, -G)
        world.run(FALL * DEFAULT_STEP)
        assert 1 - world.model("cup").pose.z == FALLEN, rest


def test_a_body_pushed_in_its_sleep_moves(make):
    """A force of F for t gives F t / m, also to one asleep."""
    world = make.world(make.box("cup", (0.1, 0.1, 0.1), mass=2, mu=0.0, pose=Pose((0, 0, 0.05))))
    world.run(3.0)
    assert asleep(world, "cup")
    data = world.session.simulation.data
    data.body("cup::link").xfrc_applied[0] = 4.0
    world.run(0.5)
    assert velocity(world, "cup")[0] == pytest.approx(4.0 * 0.5 / 2, rel=1e-3)
