"""``libplugin_drone.so``: takeoff, flight and landing."""

import itertools

import numpy as np
import pytest
from tests.coded import raises
from tests.dialects.makers.flying.quadrotors import GAINS, Bird

from cartwheel.codes import devices, running
from cartwheel.errors import PluginError, UnknownNameError

LANDED, FLYING, TAKING_OFF, LANDING = range(4)


def drone(make, tags="", **options):
    return Bird(make, "libplugin_drone.so", GAINS + tags, **options)


@pytest.mark.parametrize("step", [0.001, 0.004])
def test_a_drone_takes_off_hovers_follows_commands_and_lands(make, step):
    bird = drone(make, step=step)
    states = bird.world.mailbox("/state", size=100_000)
    bird.world.run(1.0)
    assert bird.position[2] == pytest.approx(0.05, abs=0.005)
    bird.world.publish("/takeoff")
    bird.command(z=0.5)
    bird.world.run(4.0)
    assert bird.velocity == pytest.approx([0, 0, 0.5], abs=0.02)
    bird.command()
    bird.world.run(3.0)
    hover = bird.position
    bird.world.run(3.0)
    assert bird.position == pytest.approx(hover, abs=0.01)
    bird.command(x=1.0, y=-0.5, turn=0.0)
    bird.world.run(6.0)
    assert bird.velocity == pytest.approx([1.0, -0.5, 0.0], abs=0.03)
    assert bird.position[2] == pytest.approx(hover[2], abs=0.05)
    bird.command(turn=0.5)
    bird.world.run(4.0)
    yaw = bird.yaw
    bird.world.run(1.0)
    assert bird.yaw - yaw == pytest.approx(0.5, abs=0.02)
    bird.command(z=-0.5)
    bird.world.run(2.0 * (bird.position[2] - 0.3))
    bird.world.publish("/land")
    bird.world.run(3.0)
    assert bird.position[2] == pytest.approx(0.05, abs=0.005)
    assert np.abs(bird.velocity).max() < 0.01
    order = [message.data for message in states.drain()]
    assert [stage for stage, _ in itertools.groupby(order)] == [
        LANDED, TAKING_OFF, FLYING, LANDING, LANDED
    ]  # fmt: skip


def test_it_flies_to_positions(make):
    tags = """<positionXYProportionalGain>1.1</positionXYProportionalGain><positionXYLimit>5
      </positionXYLimit><positionZProportionalGain>1</positionZProportionalGain>
      <positionXYDifferentialGain>0</positionXYDifferentialGain>"""
    bird = drone(make, tags)
    bird.world.publish("/takeoff")
    bird.world.run(1.0)
    bird.world.publish("/posctrl", data=True)
    bird.command(x=1.0, y=2.0, z=1.5)
    bird.world.run(15.0)
    assert bird.position == pytest.approx([1.0, 2.0, 1.5], abs=0.05)


def test_it_stays_on_the_ground_without_takeoff(make):
    bird = drone(make)
    bird.command(z=2.0)
    bird.world.run(1.0)
    assert bird.position[2] == pytest.approx(0.05, abs=0.005)


def test_the_largest_force_is_limited(make):
    # 10 N cannot carry 1.5 kg.
    bird = Bird(make, "libplugin_drone.so", GAINS.replace(">30<", ">10<"))
    bird.world.publish("/takeoff")
    bird.command(z=1.0)
    bird.world.run(2.0)
    assert bird.position[2] < 0.2


def test_it_publishes_its_mode_and_its_motion(make):
    bird = drone(make, "<pub_odom>true</pub_odom><odom_hz>20</odom_hz>")
    world = bird.world
    modes, poses, odometry = (world.mailbox(each) for each in ("/cmd_mode", "/gt_pose", "/odom"))
    speeds = world.mailbox("/gt_vel")
    world.publish("/dronevel_mode", data=True)
    world.publish("/takeoff")
    bird.command(z=0.5)
    world.run(4.0)
    assert [message.data for message in modes.drain()] == ["velocity"]
    assert poses.drain()[-1].position.z == pytest.approx(bird.position[2], abs=0.01)
    assert speeds.drain()[-1].linear.z == pytest.approx(0.5, abs=0.02)
    messages = odometry.drain()
    assert len(messages) == pytest.approx(80, abs=1)
    assert messages[-1].header.frame_id == "odom"
    assert messages[-1].child_frame_id == "base_footprint"


def test_noise_disturbs_the_commands(make):
    heights = []
    for noise in (
        "",
        "<motionSmallNoise>0.5</motionSmallNoise>",
        "<motionDriftNoise>0.5</motionDriftNoise>",
    ):
        bird = drone(make, noise)
        bird.world.publish("/takeoff")
        for _ in range(30):
            bird.command(z=0.5)
            bird.world.run(0.1)
        heights.append(bird.position[2])
    assert len({round(height, 4) for height in heights}) == 3
    # A drift that lasts for a second moves it by half a metre, in any direction.
    assert heights[1:] == pytest.approx([heights[0]] * 2, abs=1.9)


def test_the_body_must_exist(make):
    with raises(running.UNKNOWN_LINK, UnknownNameError):
        drone(make, "<bodyName>base_lnk</bodyName>")


def test_wrong_tags_are_errors(make):
    with raises(devices.PLUGIN_PARAMETER_INVALID, PluginError, parameter="motionDriftNoiseTime"):
        drone(make, "<motionDriftNoiseTime>0</motionDriftNoiseTime>")
