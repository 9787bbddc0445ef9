"""The figures are those that a reader measures."""

import time

import pytest

from cartwheel.geometry import Pose

TOPIC = "/gazebo/performance_metrics"


def test_sensors_and_factor(make, gazebo, rosbots):
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    gazebo(world)
    box = world.mailbox(TOPIC)
    world.mailbox("/bumpers")
    world.run(1.0)
    box.drain()
    begin = time.perf_counter()
    world.run(4.0)
    wall = time.perf_counter() - begin
    reported = box.drain()
    assert len(reported) == 20
    factors = [message.real_time_factor for message in reported]
    # The factor of the whole is the harmonic mean of the parts, less what is at the ends.
    assert len(factors) / sum(1 / factor for factor in factors) == pytest.approx(
        4.0 / wall, rel=0.5
    )
    last = {sensor.name: sensor for sensor in reported[-1].sensors}
    bumper = next(sensor for name, sensor in last.items() if "bumper" in name)
    rates = [
        sensor.sim_update_rate
        for message in reported
        for sensor in message.sensors
        if sensor.name == bumper.name
    ]
    assert sum(rates) / len(rates) == pytest.approx(50.0, rel=0.02)
    assert bumper.real_update_rate == pytest.approx(
        bumper.sim_update_rate * reported[-1].real_time_factor, rel=1e-6
    )
    # Nobody reads the camera.
    camera = next(sensor for name, sensor in last.items() if "camera" in name)
    assert (camera.sim_update_rate, camera.fps) == (0.0, 0.0)
    assert all(name.startswith("rosbots::") for name in last)


def test_a_camera_that_is_read_has_frames(make, gazebo, rosbots):
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    gazebo(world)
    box = world.mailbox(TOPIC)
    world.mailbox("/rosbots/camera1/image_raw", size=1)
    world.run(1.0)
    camera = next(s for s in box.drain()[-1].sensors if "camera" in s.name)
    assert camera.sim_update_rate == pytest.approx(30.0, abs=5.0)
    assert camera.fps == camera.real_update_rate > 0


def test_a_reset_begins_anew(make, gazebo):
    world = make.world()
    gazebo(world)
    box = world.mailbox(TOPIC)
    world.run(1.0)
    assert len(box.drain()) == 5
    world.reset()
    world.run(1.0)
    reported = box.drain()
    assert len(reported) == 5
    assert all(message.real_time_factor > 0 for message in reported)
