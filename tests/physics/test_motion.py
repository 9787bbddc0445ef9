"""Bodies and joints without friction: what Newton says, at the default step."""

import itertools
import math

import numpy as np
import pytest

from cartwheel import Twist, World
from cartwheel.description import load_text
from cartwheel.geometry import Pose, quat_from_rpy
from cartwheel.world.build import DEFAULT_STEP

G = 9.8


def body_velocity(world, model, link="link"):
    """Linear velocity of a free body, m/s, in the world."""
    data = world.session.simulation.data
    return data.joint(f"{model}::{link}").qvel[:3]


def pendulum(length, *, mass=1.5, radius=0.05, more="", limit=""):
    """A ball on a massless rod that hangs from (0, 0, 2) and swings about y."""
    inertia = 0.4 * mass * radius**2
    return f"""
    <model name="pendulum"><pose>0 0 2 0 0 0</pose>
      <link name="rod">
        <inertial><pose>0 0 {-length} 0 0 0</pose><mass>{mass}</mass>
          <inertia><ixx>{inertia}</ixx><iyy>{inertia}</iyy><izz>{inertia}</izz></inertia>
        </inertial>
      </link>
      <joint name="pivot" type="revolute"><parent>world</parent><child>rod</child>
        <axis><xyz>0 1 0</xyz>{limit}<dynamics>{more}</dynamics></axis>
      </joint>
    </model>"""


def set_joint(world, name, position):
    data = world.session.simulation.data
    data.joint(name).qpos[0] = position


def record(world, joint, seconds):
    """Times in s and positions of a joint at every step."""
    simulation = world.session.simulation
    times, positions = [], []
    simulation.schedule(
        0,
        after=lambda: (
            times.append(simulation.time_ns * 1e-9),
            positions.append(float(simulation.data.joint(joint).qpos[0])),
        ),
    )
    world.run(seconds)
    return np.array(times), np.array(positions)


def rising_zeros(times, positions):
    """Times of the upward zero crossings, interpolated."""
    before, after = positions[:-1], positions[1:]
    at = np.nonzero((before < 0) & (after >= 0))[0]
    return times[at] - before[at] * np.diff(times)[at] / (after[at] - before[at])


@pytest.mark.parametrize("step", [None, 0.001])
def test_free_fall(make, step):
    world = make.world(
        make.box("stone", (0.1, 0.1, 0.1), pose=Pose((0, 0, 10))), step=step, ground=None
    )
    h = step or DEFAULT_STEP
    world.run(1.0)
    fallen = 10 - world.model("stone").pose.z
    n = round(1.0 / h)
    # Velocity first, then position with the new velocity: the sum of g h² k for k = 1 … n,
    # which is g t²/2 and the half step that this order runs ahead.
    assert fallen == pytest.approx(G * h * h * n * (n + 1) / 2, rel=1e-9)
    assert fallen - G / 2 == pytest.approx(G * h / 2, rel=1e-6)
    assert body_velocity(world, "stone")[2] == pytest.approx(-G, rel=1e-9)


@pytest.mark.parametrize(("step", "lost"), [(None, 0.03), (0.001, 0.006)])
def test_a_body_that_tumbles_loses_some_angular_momentum(make, step, lost):
    """As docs/physics.md states; the one that spins about a principal axis loses none."""
    sides = (0.1, 0.2, 0.4)
    world = make.world(
        make.box("tumbling", sides, pose=Pose((0, 0, 5))),
        make.box("spinning", sides, pose=Pose((9, 0, 5))),
        step=step, ground=None, gravity=0.0,
    )  # fmt: skip
    tumbling, spinning = world.model("tumbling"), world.model("spinning")

    def momentum():
        turn = np.transpose(Pose((0, 0, 0), tumbling.pose.orientation).apply(np.eye(3)))
        inertia = turn @ tumbling.link("link").inertia @ turn.T
        return np.linalg.norm(inertia @ tumbling.velocity.angular)

    tumbling.velocity = Twist((0.0, 0.0, 0.0), (0.01, 5.0, 0.01))
    spinning.velocity = Twist((0.0, 0.0, 0.0), (0.0, 0.0, 5.0))
    before = momentum()
    world.run(20.0)
    assert 1 - momentum() / before == pytest.approx(lost, rel=0.2)
    assert spinning.velocity.angular == pytest.approx((0.0, 0.0, 5.0), abs=1e-9)


def test_a_thrown_body_spins_on_and_drifts_on(make):
    """Without forces momentum stays: the velocity of the centre and the spin about it."""
    world = make.world(make.box("disc", (0.3, 0.3, 0.3)), ground=None, gravity=0.0)
    data = world.session.simulation.data
    data.joint("disc::link").qvel[:] = [0.4, -0.2, 0.1, 0.0, 0.0, 2.0]
    world.run(3.0)
    pose = world.model("disc").pose
    assert pose.position == pytest.approx((1.2, -0.6, 0.3), abs=1e-9)
    assert pose.yaw == pytest.approx(math.remainder(6.0, 2 * math.pi), abs=1e-9)


def test_links_with_gravity_off_float(make):
    floating = make.sdf(
        '<model name="m"><pose>0 0 1 0 0 0</pose><link name="l"><gravity>0</gravity>'
        "<inertial><mass>1</mass></inertial></link></model>"
    )
    world = make.world(floating, ground=None)
    world.run(2.0)
    assert world.model("m").pose.z == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize(("length", "amplitude"), [(1.0, 0.05), (0.4, 0.05), (1.0, 1.0)])
def test_pendulum_period(make, length, amplitude):
    mass, radius = 1.5, 0.05
    world = make.world(make.sdf(pendulum(length, mass=mass, radius=radius)), ground=None)
    set_joint(world, "pendulum::pivot", amplitude)
    times, angles = record(world, "pendulum::pivot", 20.0)
    zeros = rising_zeros(times, angles)
    period = float(np.mean(np.diff(zeros)))
    inertia = 0.4 * mass * radius**2 + mass * length**2
    omega = math.sqrt(mass * G * length / inertia)
    # The complete elliptic integral by the arithmetic-geometric mean: exact at any amplitude.
    a, b = 1.0, math.cos(amplitude / 2)
    for _ in range(6):
        a, b = (a + b) / 2, math.sqrt(a * b)
    # Symplectic Euler is off by (ω h)²/24; twice that is allowed, and the interpolation's error.
    tolerance = 2 * (omega * DEFAULT_STEP) ** 2 / 24 + 1e-5
    assert period == pytest.approx(2 * math.pi / (omega * a), rel=tolerance)
    # And it loses nothing: the last swing is as wide as the first, to the half step by which
    # the extremes are missed.
    last = angles[times > 20 - period]
    assert last.max() == pytest.approx(amplitude, rel=omega * DEFAULT_STEP)


def test_damped_pendulum_loses_what_its_damping_takes(make):
    length, mass, radius, damping = 1.0, 1.5, 0.05, 0.2
    world = make.world(
        make.sdf(pendulum(length, more=f"<damping>{damping}</damping>")), ground=None
    )
    set_joint(world, "pendulum::pivot", 0.05)
    _, angles = record(world, "pendulum::pivot", 10.0)
    inertia = 0.4 * mass * radius**2 + mass * length**2
    peaks = [
        angles[i]
        for i in range(1, len(angles) - 1)
        if angles[i] > 0 and angles[i - 1] < angles[i] >= angles[i + 1]
    ]
    assert len(peaks) >= 4
    decay = damping / (2 * inertia)
    omega = math.sqrt(mass * G * length / inertia - decay**2)
    expected = math.exp(-decay * 2 * math.pi / omega)
    for before, after in itertools.pairwise(peaks):
        # A peak is read up to half a step beside its top, where the cosine is 1 - (ω h)²/8.
        assert after / before == pytest.approx(expected, rel=4 * (omega * DEFAULT_STEP) ** 2 / 8)


def test_joint_limit_holds(make):
    """A pendulum let go beyond its stop comes to rest on it: the stop bears the weight's moment."""
    limit = "<limit><lower>0.5</lower><upper>2</upper></limit>"
    world = make.world(
        make.sdf(pendulum(1.0, limit=limit, more="<damping>1</damping>")), ground=None
    )
    set_joint(world, "pendulum::pivot", 1.5)
    world.run(10.0)
    # The stop is as soft as a contact: a milliradian at this load.
    assert world.model("pendulum").joint("pivot") == pytest.approx(0.5, abs=2e-3)
    world.run(1.0)
    assert world.session.simulation.data.joint("pendulum::pivot").qvel[0] == pytest.approx(
        0.0, abs=1e-6
    )


@pytest.mark.parametrize("angle", [0.0, 0.5])
def test_equal_limits_lock_a_joint(make, angle):
    """As soft as a stop: a milliradian at this load."""
    limit = f"<limit><lower>{angle}</lower><upper>{angle}</upper></limit>"
    world = make.world(make.sdf(pendulum(1.0, limit=limit)), ground=None)
    set_joint(world, "pendulum::pivot", angle)
    world.run(2.0)
    assert world.model("pendulum").joint("pivot") == pytest.approx(angle, abs=2e-3)


def test_what_follows_another_joint_is_not_locked_by_equal_limits(make):
    world = make.world(
        load_text(
            """<robot name="r"><link name="world"/><link name="a">{i}</link>
            <link name="b">{i}</link>
            <joint name="lead" type="revolute"><parent link="world"/><child link="a"/>
              <limit lower="-1" upper="1" effort="9" velocity="9"/></joint>
            <joint name="follow" type="revolute"><parent link="world"/><child link="b"/>
              <limit effort="9" velocity="9"/><mimic joint="lead"/></joint></robot>""".format(
                i='<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" '
                'iyz="0"/></inertial>'
            )
        ),
        ground=None,
    )
    world.session.simulation.set_joint_positions("r", {"lead": 0.7})
    world.run(1.0)
    assert world.model("r").joint("follow") == pytest.approx(0.7, abs=1e-3)


@pytest.mark.parametrize(
    ("shape", "factor"),
    [
        ("<sphere><radius>0.1</radius></sphere>", 2 / 5),
        ("<cylinder><radius>0.1</radius><length>0.2</length></cylinder>", 1 / 2),
    ],
)
def test_rolling_without_slipping(make, shape, factor):
    """a = g sin α / (1 + I / m r²), down a slope that is steep enough to slide without friction."""
    slope, mass, radius = math.radians(10), 2.0, 0.1
    inertia = factor * mass * radius**2
    roller = make.sdf(
        f"""<model name="roller"><link name="link">
        <inertial><mass>{mass}</mass>
          <inertia><ixx>{inertia}</ixx><iyy>{inertia}</iyy><izz>{inertia}</izz></inertia></inertial>
        <collision name="c"><pose>0 0 0 {math.pi / 2} 0 0</pose>
          <geometry>{shape}</geometry></collision>
        </link></model>"""
    )
    down = np.array([math.cos(slope), 0, -math.sin(slope)])
    up = np.array([math.sin(slope), 0, math.cos(slope)])
    ramp = make.box(
        "ramp",
        (20, 2, 0.2),
        pose=Pose(tuple(-0.1 * up), quat_from_rpy(0, slope, 0)),
        static=True,
    )
    world = make.world(ramp, ground=None)
    world.session.spawn(roller, pose=Pose(tuple(radius * up)))
    world.run(0.5)
    start = float(body_velocity(world, "roller") @ down)
    world.run(1.0)
    gained = float(body_velocity(world, "roller") @ down) - start
    # Rolling resistance is none; the contact's softness takes less than half a percent.
    assert gained == pytest.approx(G * math.sin(slope) / (1 + factor), rel=5e-3)
    spin = world.session.simulation.data.joint("roller::link").qvel[3:]
    assert np.linalg.norm(spin) * radius == pytest.approx(start + gained, rel=5e-3)


STEPS = [0.0002, 0.001, 0.005]


@pytest.mark.parametrize("step", STEPS)
def test_a_body_that_begins_to_fall_slowly_does_not_sleep(step):
    with World("empty", step_size=step) as world:
        box = world.spawn("box_small.urdf", z=5.0)
        world.gravity = (0.0, 0.0, -0.01)
        world.run(2.0)
        # The fall is g t² / 2 + g h t / 2.
        assert 5.0 - box.pose.z == pytest.approx(0.02 + 0.01 * step, rel=1e-3)


@pytest.mark.parametrize("step", STEPS)
def test_a_body_that_begins_to_slide_slowly_does_not_sleep(step):
    """It has slept before gravity turns by 0.1 degrees, and its base has no friction."""
    slope = math.radians(0.1)
    with World("empty", step_size=step) as world:
        box = world.spawn("box_small.urdf", z=0.15)
        box.link(box.links[0]).friction = 0.0
        world.run(1.0)
        start = box.pose.x
        world.gravity = (G * math.sin(slope), 0.0, -G * math.cos(slope))
        world.run(2.0)
        assert box.pose.x - start == pytest.approx(2 * G * math.sin(slope), rel=0.02)


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("amplitude", [0.005, 0.05])
def test_a_pendulum_does_not_sleep_at_its_turning_points(step, amplitude):
    text = f'<sdf version="1.9">{pendulum(1.0)}</sdf>'
    with World("empty", step_size=step) as world:
        swinging = world.spawn(text)
        swinging.joints["pivot"].position = amplitude
        times, angles = record(world, "pendulum::pivot", 6.0)
        late = angles[times > 3.0]
        # The extremes are missed by half a step at most.
        missed = 2 * (math.sqrt(G) * step) ** 2 + 1e-3
        assert late.max() == pytest.approx(amplitude, rel=missed)
        assert late.min() == pytest.approx(-amplitude, rel=missed)


def test_a_pendulum_moved_as_it_falls_asleep_swings():
    text = f'<sdf version="1.9">{pendulum(1.0)}</sdf>'
    with World("empty") as world:
        pivot = world.spawn(text).joints["pivot"]
        angles = []
        for rest in range(1, 20):
            world.reset()
            world.run(rest * DEFAULT_STEP)
            pivot.position = 0.5
            world.run(0.2)
            angles.append(pivot.position)
        assert angles[0] < 0.45
        assert angles == pytest.approx([angles[0]] * len(angles))
