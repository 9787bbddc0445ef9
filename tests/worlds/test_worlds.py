"""The shipped worlds as they run: nothing falls over, sinks, creeps or complains."""

import math

import numpy as np
import pytest
from tests.coded import coded

import cartwheel as cw
from cartwheel.codes.world import MODELS_OVERLAP
from cartwheel.description import load_robot, load_world
from cartwheel.description.files.package_folders import share

WORLDS = sorted(path.stem for path in (share() / "worlds").glob("*.world"))


def opened(name):
    return cw.World(load_world(share() / "worlds" / f"{name}.world"))


def cart():
    return load_robot(share() / "robots" / "rosbots_description" / "urdf" / "rosbots.xacro")


def turned(before, after):
    dot = abs(sum(a * b for a, b in zip(before.orientation, after.orientation, strict=True)))
    return 2 * math.acos(min(1.0, dot))


@pytest.mark.parametrize("name", WORLDS)
def test_everything_stays_where_it_was_put(name):
    with opened(name) as world:
        simulation = world.session.simulation
        before = {model: simulation.pose(model) for model in simulation.models}
        world.run(5.0)
        for model, pose in before.items():
            now = simulation.pose(model)
            # Poses are written to a tenth of a millimetre, and contacts give way by less.
            assert math.dist(pose.position, now.position) < 5e-3, model
            assert turned(pose, now) < 0.02, model


@pytest.mark.parametrize("name", WORLDS)
def test_nothing_is_to_be_complained_of(name):
    with opened(name) as world:
        reported = [str(d) for d in world.session.diagnostics if d.severity != "info"]
    assert not reported


@pytest.mark.parametrize("name", [name for name in WORLDS if name != "elevator"])
def test_a_cart_has_room_at_the_origin(name):
    with opened(name) as world:
        world.spawn(cart(), z=0.1)
        assert not coded(world.session, MODELS_OVERLAP)


def test_wheels_spin_in_the_mud_and_grip_beside_it():
    """The way in 2 s from standing, at a ramp of 1 m/s² that asks for more than the mud gives."""
    way = {}
    for name in ("empty", "mud"):
        with opened(name) as world:
            robot = world.spawn(cart(), x=3.0, z=0.1)
            world.run(1.0)
            start = robot.pose.x
            world.publish("/part2_cmr/cmd_vel", linear_x=3.0)
            world.run(2.0)
            way[name] = robot.pose.x - start
    assert way["empty"] == pytest.approx(0.5 * 2.0**2, rel=0.05)
    # Friction pulls no harder than mu g.
    assert way["mud"] < 0.06 * 9.8 / 2 * 2.0**2


def test_targets_stand_at_the_distances_that_the_world_says():
    """A ray along x from each sensor's front."""
    import mujoco

    expected = {"sonar": 1.0, "infrared": 0.5, "laser_scanner": 2.0}
    with opened("range") as world:
        simulation = world.session.simulation
        for sensor, distance in expected.items():
            origin = np.add(simulation.pose(sensor).position, (0.001, 0, 0))
            hit = np.zeros(1, dtype=np.int32)
            group = np.array([0, 0, 0, 0, 1, 0], dtype=np.uint8)
            found = mujoco.mj_ray(
                simulation.model, simulation.data, origin, np.array([1.0, 0, 0]), group, 1, -1, hit
            )
            assert found == pytest.approx(distance - 0.001, abs=1e-6), sensor


def test_the_range_sensors_publish_those_distances():
    with opened("range") as world:
        boxes = {
            name: world.mailbox(f"/{name}", size=100) for name in ("sonar", "infrared", "scan")
        }
        world.run(2.0)
        read = {name: box.drain() for name, box in boxes.items()}
    # Ten a second; noise of 5 mm, of whose mean over twenty 3 mm is nearly three deviations.
    for name, distance in (("sonar", 1.0), ("infrared", 0.5)):
        assert len(read[name]) >= 19
        assert np.mean([each.range for each in read[name]]) == pytest.approx(distance, abs=4e-3)
    assert {each.radiation_type for each in read["sonar"]} == {0}
    assert {each.radiation_type for each in read["infrared"]} == {1}
    middle = [each.ranges[90] for each in read["scan"]]
    assert middle == pytest.approx([2.0] * len(middle), abs=2e-3)


def test_a_cart_drives_through_the_office_from_the_hall_into_a_room():
    with opened("willowgarage") as world:
        # Ahead of the second office of the middle block, and into its opening.
        robot = world.spawn(cart(), x=2.0, y=-0.3, z=0.1, yaw=-math.pi / 2)
        world.run(0.5)
        world.publish("/part2_cmr/cmd_vel", linear_x=0.8)
        world.run(5.0)
        # v t, less what the ramp of 1 m/s² takes: v²/2a.
        assert robot.pose.y == pytest.approx(-0.3 - (0.8 * 5.0 - 0.8**2 / 2), abs=0.05)
        assert robot.pose.x == pytest.approx(2.0, abs=0.15)


def test_large_worlds_state_no_more_pairs_than_they_may():
    from cartwheel.world.pairs import MOST_PAIRS

    with opened("willowgarage") as world:
        world.spawn(cart(), z=0.1)
        model = world.session.simulation.model
        assert 0 < model.npair <= MOST_PAIRS
        ground = model.geom("ground_plane::link::collision").id
        movers = {int(model.pair_geom2[i]) for i in range(model.npair)} | {
            int(model.pair_geom1[i]) for i in range(model.npair)
        }
        assert ground in movers
