"""Models that are fixed to the world and move at a velocity."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.world import FIXED_TO_WORLD
from cartwheel.errors import SimulationError
from cartwheel.simulation.outside_steps import physics_of_cartwheel

G = 9.8
TURN = cw.Twist((0.3, 0.0, 0.0), (0.2, 0.5, 1.0))
STEPS = [0.005, 0.001]
SPACE = '<sdf version="1.9"><world name="space"><gravity>0 0 0</gravity></world></sdf>'
LASER = """<sensor name="laser" type="lidar"><topic>scan</topic><update_rate>10</update_rate>
<lidar><scan><horizontal><samples>1</samples></horizontal></scan><range><min>0.1</min>
<max>20</max></range></lidar></sensor>"""


def shape(size: tuple[float, float, float], *, bounce: float = 0.0, mu: float = 1.0) -> str:
    ode = f"<friction><ode><mu>{mu}</mu><mu2>{mu}</mu2></ode></friction>"
    restitution = (
        f"<bounce><restitution_coefficient>{bounce}</restitution_coefficient>"
        "<threshold>0.01</threshold></bounce>"
    )
    return (
        f'<collision name="c"><geometry><box><size>{" ".join(map(str, size))}</size></box>'
        f"</geometry><surface>{restitution if bounce else ''}{ode}</surface></collision>"
    )


def fixed(size: tuple[float, float, float], more: str = "", **given: float) -> str:
    return (
        f'<sdf version="1.9"><model name="moving"><static>true</static><link name="link">'
        f"{shape(size, **given)}{more}</link></model></sdf>"
    )


def loose(
    mass: float = 1.0, size: tuple[float, float, float] = (0.2, 0.2, 0.2), **given: Any
) -> str:
    x, y, z = size
    i, j, k = (mass / 12 * (a * a + b * b) for a, b in ((y, z), (x, z), (x, y)))
    return (
        f'<sdf version="1.9"><model name="box"><link name="link"><inertial><mass>{mass}</mass>'
        f"<inertia><ixx>{i}</ixx><iyy>{j}</iyy><izz>{k}</izz></inertia></inertial>"
        f"{shape(size, **given)}</link></model></sdf>"
    )


def loaded(world: cw.World, *, x: float = 0.0, **given: float) -> tuple[cw.Model, cw.Model]:
    """A platform with a box at rest."""
    platform = world.spawn(fixed((3.0, 3.0, 0.2)), z=0.1)
    box = world.spawn(loose(**given), x=x, z=0.3)
    world.run(0.5)
    return platform, box


@pytest.mark.parametrize("step", STEPS)
def test_a_platform_carries_by_friction(step: float) -> None:
    """The box slides until it is as fast: v / (mu g). It then stops with the platform."""
    with cw.World(step_size=step) as world:
        platform, box = loaded(world, mu=0.3)
        platform.velocity = cw.Twist((0.6, 0.0, 0.0))
        world.run(0.1)
        assert box.velocity.linear[0] == pytest.approx(0.3 * G * 0.1, rel=0.05)
        world.run(0.9)
        assert box.velocity.linear == pytest.approx((0.6, 0.0, 0.0), abs=1e-6)
        assert box.pose.x == pytest.approx(0.6 - 0.6**2 / (2 * 0.3 * G), abs=2e-3)
        assert platform.pose.x == pytest.approx(0.6, abs=1e-9)
        weight = sum(each.force[2] for each in world.contacts(between=(box, platform)))
        assert weight == pytest.approx(G, rel=1e-6)
        platform.velocity = cw.Twist()
        world.run(1.0)
        assert box.velocity.linear == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)
        assert platform.pose.x == pytest.approx(0.6, abs=1e-9)


@pytest.mark.parametrize("step", STEPS)
def test_a_lift_carries_a_box_as_a_floor_does(step: float) -> None:
    with cw.World(step_size=step) as world:
        platform, box = loaded(world)
        gap = box.pose.z - platform.pose.z
        for speed in (0.5, -0.3):
            platform.velocity = cw.Twist((0.0, 0.0, speed))
            world.run(1.0)
            assert box.velocity.linear[2] == pytest.approx(speed, abs=1e-6)
            assert box.pose.z - platform.pose.z == pytest.approx(gap, abs=5e-5)


@pytest.mark.parametrize("step", STEPS)
def test_a_box_keeps_its_place_on_a_turntable(step: float) -> None:
    with cw.World(step_size=step) as world:
        platform, box = loaded(world, x=0.8)
        platform.velocity = cw.Twist(angular=(0.0, 0.0, 0.5))
        world.run(0.5)
        place = platform.pose.inverse() @ box.pose
        world.run(4.0)
        now = platform.pose.inverse() @ box.pose
        assert math.dist(place.position, now.position) < 1e-4
        assert box.velocity.angular[2] == pytest.approx(0.5, abs=1e-6)
        assert platform.pose.yaw == pytest.approx(0.5 * 4.5, abs=1e-9)


@pytest.mark.parametrize("bounce", [0.0, 0.7])
@pytest.mark.parametrize("step", STEPS)
def test_an_impact_does_not_depend_on_which_body_moves(step: float, bounce: float) -> None:
    """Galilean invariance, with friction, rotation and restitution."""
    results: list[tuple[float, ...]] = []
    for moves in (False, True):
        with cw.World(SPACE, step_size=step) as world:
            wall = world.spawn(fixed((0.2, 1.0, 1.0), bounce=bounce), x=-0.5)
            box = world.spawn(loose(2.0, bounce=bounce, mu=0.5), x=0.1, y=0.02)
            box.velocity = cw.Twist((0.0 if moves else -0.7, 0.2, 0.0), (0.1, 0.0, 0.3))
            if moves:
                wall.velocity = cw.Twist((0.7, 0.0, 0.0))
            with world.record_contacts(between=(box, wall)) as record:
                world.run(1.2)
            between = np.subtract(box.pose.position, wall.pose.position).tolist()
            speed = np.subtract(box.velocity.linear, wall.velocity.linear).tolist()
            results.append((record.peak_force, *between, *box.pose.rpy, *speed))
    assert results[1] == pytest.approx(results[0], rel=1e-6, abs=1e-8)
    assert results[0][-3] > (0.3 if bounce else 0.0)


@pytest.mark.parametrize("step", STEPS)
def test_the_push_of_a_wall_is_the_friction_of_what_it_pushes(step: float) -> None:
    """In the mean: the box hops a little on the ground."""
    with cw.World(step_size=step) as world:
        wall = world.spawn(fixed((0.2, 1.0, 0.4), mu=0.0), x=-0.5, z=0.2)
        box = world.spawn(loose(2.0, (0.3, 0.3, 0.3), mu=0.5), z=0.15)
        wall.velocity = cw.Twist((0.4, 0.0, 0.0))
        world.run(1.0)
        with world.record_contacts(between=(box, wall)) as record:
            world.run(2.0)
        push = sum(each.impulse[0] for each in record) / 2.0
        assert push == pytest.approx(0.5 * 2.0 * G, rel=0.03)
        assert box.pose.x - wall.pose.x == pytest.approx(0.25, abs=1e-3)


def test_the_ground_moves_below_a_robot() -> None:
    """A treadmill: the wheels of a braked robot do not turn, so it moves with the ground."""
    with cw.World() as world:
        cart = world.spawn("rosbots.xacro", z=0.02)
        world.run(0.5)
        world.model("ground_plane").velocity = cw.Twist((0.1, 0.0, 0.0))
        world.run(3.0)
        assert cart.velocity.linear[0] == pytest.approx(0.1, abs=1e-3)


def test_poses_velocities_and_lasers_follow_it() -> None:
    with cw.World() as world:
        ship = world.spawn(fixed((0.2, 0.2, 0.2), LASER), x=1.0, z=1.0)
        scan = world.topic("/scan")
        world.spawn(loose(1000.0, (0.2, 8.0, 2.0)).replace('"box"', '"wall"'), x=4.0, z=1.0)
        ship.velocity = cw.Twist((0.5, 0.0, 0.0), (0.0, 0.0, 0.1))
        world.run(2.0)
        place = ship.pose
        assert place.position == pytest.approx((2.0, 0.0, 1.0))
        assert place.yaw == pytest.approx(0.2)
        assert ship.link("link").pose == place
        assert ship.velocity == cw.Twist((0.5, 0.0, 0.0), (0.0, 0.0, 0.1))
        link = ship.link("link").velocity
        assert link.linear == pytest.approx(ship.velocity.linear)
        assert link.angular == pytest.approx(ship.velocity.angular)
        world.serve_gazebo()
        twist = world.call("/gazebo/get_model_state", model_name="moving").twist
        assert (twist.linear.x, twist.angular.z) == pytest.approx((0.5, 0.1))
        assert scan.latest.ranges[0] == pytest.approx(1.9 / math.cos(0.2), abs=1e-3)
        ship.pose = cw.Pose((0.0, 0.0, 1.0))
        world.run(1.0)
        assert (ship.velocity, ship.pose.x) == (cw.Twist(), 0.0)
        assert scan.latest.ranges[0] == pytest.approx(3.9, abs=1e-3)


def test_what_it_squeezes_is_not_shot_away() -> None:
    """It is at most 0.5 m/s faster than the obstacle, as models that overlap."""
    with cw.World() as world:
        wall = world.spawn(fixed((0.1, 1.0, 1.0)), x=-0.6, z=0.5)
        world.spawn(fixed((0.2, 1.0, 1.0)).replace("moving", "stop"), x=0.6, z=0.5)
        box = world.spawn(loose(1.0, (0.3, 0.3, 0.3), mu=0.5), z=0.15)
        wall.velocity = cw.Twist((0.3, 0.0, 0.0))
        speeds: list[float] = []
        for _ in range(800):
            world.step()
            speeds.append(math.hypot(*box.velocity.linear))
        assert max(speeds) < 1.0


def scene(world: cw.World) -> Callable[[], tuple[object, ...]]:
    """A turning platform with a box; returns what is there."""
    platform, box = loaded(world, x=0.7)
    platform.velocity = cw.Twist((0.2, 0.1, 0.05), (0.0, 0.1, 0.4))
    world.run(0.3)
    return lambda: (world.model("moving").pose, world.model("box").pose, box.velocity)


def test_results_do_not_depend_on_how_a_run_is_divided() -> None:
    ends: list[tuple[object, ...]] = []
    for piece in (1.0, 0.05):
        with cw.World() as world:
            look = scene(world)
            while world.time < 1.79:
                world.run(piece)
                look()
                world.contacts()
            ends.append(look())
    assert ends[0] == ends[1]


def test_a_saved_state_continues_here_and_in_another_world() -> None:
    with cw.World() as world, cw.World() as other:
        look = scene(world)
        state = pickle.dumps(world.save())
        world.run(1.0)
        end = look()
        world.model("moving").velocity = cw.Twist()
        world.run(0.5)
        for each in (world, other):
            if each is other:
                loaded(other)
            each.restore(pickle.loads(state))
            each.run(1.0)
            moved = each.model("moving").pose, each.model("box").pose
            assert moved == end[:2]


def test_a_reset_and_a_deletion_end_the_motion() -> None:
    with cw.World() as world:
        platform, _ = loaded(world)
        start = platform.pose
        platform.velocity = cw.Twist((0.3, 0.0, 0.0))
        world.run(0.5)
        world.reset()
        world.run(0.5)
        assert (platform.pose, platform.velocity) == (start, cw.Twist())
        platform.velocity = cw.Twist((0.3, 0.0, 0.0))
        world.run(0.1)
        other = world.spawn(loose().replace('"box"', '"late"'), x=1.0, z=0.3)
        world.run(1.0)
        assert other.velocity.linear[0] == pytest.approx(0.3, abs=1e-6)
        platform.delete()
        world.run(1.0)
        assert other.pose.z == pytest.approx(0.1, abs=1e-3)


ARM = """<sdf version="1.9"><model name="arm"><link name="base"/>
<link name="rod"><inertial><mass>1</mass>
<inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial></link>
<joint name="bolt" type="fixed"><parent>world</parent><child>base</child></joint>
<joint name="turn" type="revolute"><parent>base</parent><child>rod</child>
<axis><xyz>0 1 0</xyz></axis>
</joint></model></sdf>"""


def test_a_model_with_joints_stays() -> None:
    with cw.World() as world:
        arm = world.spawn(ARM, z=1.0)
        with raises(FIXED_TO_WORLD, SimulationError, model="arm") as caught:
            arm.velocity = cw.Twist((0.1, 0.0, 0.0))
        assert caught.value.hint
        world.run(0.1)
        assert arm.pose.position == (0.0, 0.0, 1.0)


def test_another_engine_cannot_compute_it() -> None:
    with cw.World() as world:
        platform, _ = loaded(world)
        engine = world.session.simulation.engine
        for speed, expected in ((0.0, 0), (0.1, 1), (0.0, 0)):
            platform.velocity = cw.Twist((speed, 0.0, 0.0))
            assert len(list(physics_of_cartwheel(engine))) == expected


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("holds", [True, False])
@pytest.mark.parametrize("velocity", [cw.Twist((0.5, 0.1, 0.2)), TURN])
def test_what_is_attached_moves_with_the_model(step, holds, velocity):
    """The weld follows within a tenth of a millimetre, and turns as far as the model."""
    with cw.World("empty", step_size=step) as world:
        hook = world.spawn(fixed((0.1, 0.1, 0.1)), z=4.0)
        load = world.spawn(loose(2.0), x=0.3, z=3.5, yaw=0.4)
        one, two = hook.link("link"), load.link("link")
        (one.attach(two) if holds else two.attach(one))
        world.run(0.5)
        before = hook.pose.inverse() @ load.pose
        hook.velocity = velocity
        world.run(1.0)
        after = hook.pose.inverse() @ load.pose
        assert after.position == pytest.approx(before.position, abs=1e-4)
        assert after.rpy == pytest.approx(before.rpy, abs=1e-4)
        hook.velocity = cw.Twist()
        world.run(0.5)
        after = hook.pose.inverse() @ load.pose
        assert after.position == pytest.approx(before.position, abs=1e-5)
