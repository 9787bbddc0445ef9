"""Restitution: what an impact leaves of speed, height and spin, against Newton's law."""

import math

import numpy as np
import pytest
from tests.coded import coded

import cartwheel as cw
from cartwheel.codes.world import PHYSICS_SETTING_IGNORED
from cartwheel.description import load_text

G = 9.8
RADIUS = 0.05
BALL = f"<sphere><radius>{RADIUS}</radius></sphere>"
CUBE = "<box><size>0.1 0.1 0.1</size></box>"
MOMENT = 0.4 * 0.3 * RADIUS**2
"""kg m², of the ball of 0.3 kg."""


def surface(restitution: float, threshold: float | None, mu: float) -> str:
    bound = "" if threshold is None else f"<threshold>{threshold}</threshold>"
    return f"""<surface><bounce><restitution_coefficient>{restitution}</restitution_coefficient>
      {bound}</bounce><friction><ode><mu>{mu}</mu><mu2>{mu}</mu2></ode></friction></surface>"""


def body(name: str, x: float, z: float, bounce: str, shape: str = BALL) -> str:
    return f"""<model name="{name}"><pose>{x} 0 {z} 0 0 0</pose><link name="link">
      <inertial><mass>0.3</mass><inertia><ixx>{MOMENT}</ixx><iyy>{MOMENT}</iyy><izz>{MOMENT}</izz>
      </inertia></inertial><collision name="c"><geometry>{shape}</geometry>{bounce}</collision>
      </link></model>"""


def scene(*bodies: str, floor: str, step: float = 0.001, gravity: float = G) -> cw.World:
    text = f"""<sdf version="1.6"><world name="w"><gravity>0 0 {-gravity}</gravity>
      <physics type="ode"><max_step_size>{step}</max_step_size></physics>
      <model name="floor"><static>true</static><link name="link"><collision name="c"><geometry>
      <plane/></geometry>{floor}</collision></link></model>{"".join(bodies)}</world></sdf>"""
    return cw.World(load_text(text, file="w.sdf"))


def peaks(world: cw.World, name: str, seconds: float) -> list[float]:
    """Heights in m above the floor at which it turns back, after its first fall."""
    simulation = world.session.simulation
    heights: list[float] = []
    simulation.schedule(0, after=lambda: heights.append(simulation.pose(name).position[2] - RADIUS))
    world.run(seconds)
    z = np.array(heights)
    return z[1:-1][(z[1:-1] > z[:-2]) & (z[1:-1] >= z[2:])].tolist()


@pytest.mark.parametrize("shape", [BALL, CUBE], ids=["ball", "cube"])
@pytest.mark.parametrize("step", [0.001, 0.005])
@pytest.mark.parametrize("restitution", [0.3, 0.5, 0.8, 1.0])
def test_what_falls_comes_back_to_e_squared_of_its_height(restitution, step, shape):
    """Each way costs or gains at most half a step at the speed of the impact."""
    height = 0.5
    floor = surface(1.0, 0.01, 1.0)
    with scene(
        body("b", 0, height + RADIUS, surface(restitution, 0.01, 1.0), shape),
        floor=floor,
        step=step,
    ) as world:
        first, second = peaks(world, "b", 2.0)[:2]
    slack = math.sqrt(2 * G * height) * step
    assert first == pytest.approx(restitution**2 * height, abs=slack)
    assert second == pytest.approx(restitution**4 * height, abs=2 * slack)


def test_the_lower_threshold_of_two_surfaces_counts():
    with scene(body("b", 0, 0.55, surface(0.8, 0.1, 1.0)), floor=surface(0.8, None, 1.0)) as world:
        assert max(peaks(world, "b", 1.0)) == pytest.approx(0.64 * 0.5, abs=0.004)


def test_of_two_surfaces_the_smaller_restitution_counts():
    with scene(
        body("a", 0, 0.55, surface(0.9, 0.01, 1.0)),
        body("b", 1, 0.55, surface(0.4, 0.01, 1.0)),
        floor=surface(0.6, 0.01, 1.0),
    ) as world:
        first = peaks(world, "a", 0.8)[0]
    assert first == pytest.approx(0.36 * 0.5, abs=math.sqrt(2 * G * 0.5) * 0.001)


@pytest.mark.parametrize(("threshold", "bounces"), [(3.0, True), (3.3, False), (None, False)])
def test_what_meets_below_the_threshold_stays(threshold, bounces):
    """From 0.5 m it meets the floor with 3.13 m/s; without a threshold nothing is fast enough."""
    bounce = surface(0.8, threshold, 1.0)
    with scene(body("b", 0, 0.55, bounce), floor=bounce) as world:
        found = peaks(world, "b", 1.0)
        reported = coded(world, PHYSICS_SETTING_IGNORED, setting="restitution")
    assert (max(found, default=0.0) > 0.1) == bounces
    assert len(reported) == (0 if threshold else 2)  # one for each model
    if threshold:
        # The second time it is slower than either.
        assert len([z for z in found if z > 0.01]) == int(bounces)


@pytest.mark.parametrize("step", [0.001, 0.005])
@pytest.mark.parametrize("restitution", [0.3, 0.8])
def test_what_has_come_to_rest_lies_still(restitution, step):
    bounce = surface(restitution, 0.0, 1.0)
    with scene(body("b", 0, 0.55, bounce, CUBE), floor=bounce, step=step) as world:
        world.run(5.0)
        assert world.model("b").pose.position[2] == pytest.approx(RADIUS, abs=2e-4)
        velocity = world.session.simulation.data.joint("b::link").qvel
        assert np.abs(velocity).max() < 1e-3


def test_two_balls_exchange_their_speeds():
    """Equal masses, e = 1: the one stops, the other goes on; with e = 0.5 a quarter is left."""
    for restitution, after in ((1.0, (0.0, 2.0)), (0.5, (0.5, 1.5))):
        bounce = surface(restitution, 0.01, 0.0)
        with scene(
            body("a", 0, 1, bounce), body("b", 0.3, 1, bounce), floor=bounce, gravity=0.0
        ) as world:
            data = world.session.simulation.data
            data.joint("a::link").qvel[0] = 2.0
            world.run(0.3)
            speeds = [data.joint(f"{name}::link").qvel[0] for name in "ab"]
            assert speeds == pytest.approx(after, abs=1e-3)
            assert sum(speeds) == pytest.approx(2.0, abs=1e-9)


@pytest.mark.parametrize(("mu", "sticks"), [(1.0, True), (0.05, False)])
def test_an_impact_rubs_as_far_as_friction_goes(mu, sticks):
    """A ball thrown sideways at v, meeting the floor at w.

    Friction gives it at most mu m (1 + e) w; where that does, it leaves rolling, with 5/7 v.
    """
    speed, height, restitution = 1.0, 0.5, 0.6
    bounce = surface(restitution, 0.01, mu)
    with scene(body("b", 0, height + RADIUS, bounce), floor=bounce) as world:
        data = world.session.simulation.data
        data.joint("b::link").qvel[0] = speed
        world.run(math.sqrt(2 * height / G) + 0.05)
        along, spin = data.joint("b::link").qvel[0], data.joint("b::link").qvel[4]
    meets = math.sqrt(2 * G * height)
    rubbed = mu * (1 + restitution) * meets
    assert (speed * 2 / 7 < rubbed) == sticks
    # They touch in the middle of the depth at which that is found, within one step.
    lever = meets * 0.001 / 2 / RADIUS
    expected = speed * 5 / 7 if sticks else speed - rubbed
    assert along == pytest.approx(expected, abs=lever * speed * 2 / 7 if sticks else mu * G * 0.002)
    assert spin == pytest.approx(0.3 * (speed - along) * RADIUS / MOMENT, rel=lever)


def test_a_link_of_an_arm_bounces_with_the_inertia_of_its_joint():
    """A rod on a hinge falls onto its end: the end parts with e of the speed it met with."""
    bounce = surface(0.5, 0.01, 0.0)
    arm = f"""<model name="arm"><pose>0 0 0.4 0 0 0</pose><link name="base"/>
      <link name="rod"><inertial><pose>0.5 0 0 0 0 0</pose><mass>0.3</mass><inertia><ixx>0.01</ixx>
      <iyy>0.02</iyy><izz>0.02</izz></inertia></inertial><collision name="c">
      <pose>1 0 0 0 0 0</pose><geometry>{BALL}</geometry>{bounce}</collision></link>
      <joint name="fix" type="fixed"><parent>world</parent><child>base</child></joint>
      <joint name="j" type="revolute"><parent>base</parent><child>rod</child>
      <axis><xyz>0 1 0</xyz></axis></joint></model>"""
    with scene(arm, floor=bounce) as world:
        simulation = world.session.simulation
        rates: list[float] = []
        simulation.schedule(0, after=lambda: rates.append(simulation.data.joint("arm::j").qvel[0]))
        world.run(0.5)
    fastest = int(np.argmax(rates))
    # The last one that is seen on the way down is that with which it meets.
    assert rates[fastest + 1] == pytest.approx(-0.5 * rates[fastest], rel=0.01)
