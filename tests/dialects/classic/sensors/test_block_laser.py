"""Point clouds of Gazebo Classic's block_laser."""

import math

import numpy as np
import pytest
from tests.devices.rays.walls import messages, on_the_wall, world_of


def test_a_block_laser_gives_the_points_that_it_hits(make):
    message = messages(
        world_of(make, "libgazebo_ros_block_laser.so", "<topicName>cloud</topicName>"), "/cloud"
    )[0]
    points = [(p.x, p.y, p.z) for p in message.points]
    # Gazebo's own has z upside down; here it points up.
    assert np.array(points) == pytest.approx(on_the_wall().reshape(-1, 3), abs=1e-6)
    (channel,) = message.channels
    assert channel.name == "intensity"
    assert channel.values.tolist() == [7.0] * 66
    assert message.header.frame_id == "optic"


def test_a_block_laser_leaves_out_what_it_does_not_hit(make):
    world = world_of(make, "libgazebo_ros_block_laser.so", "<topicName>cloud</topicName>", most=2.1)
    message = messages(world, "/cloud")[0]
    expected = on_the_wall().reshape(-1, 3)
    near = np.linalg.norm(expected, axis=1) < 2.1
    assert 0 < near.sum() < 66
    assert len(message.points) == len(message.channels[0].values) == near.sum()


def test_a_block_lasers_noise_is_of_each_coordinate(make):
    tags = "<topicName>cloud</topicName><gaussianNoise>0.05</gaussianNoise>"
    reported = messages(world_of(make, "libgazebo_ros_block_laser.so", tags), "/cloud", 6.0)
    points = np.array([[(p.x, p.y, p.z) for p in message.points] for message in reported])
    error = points - on_the_wall().reshape(-1, 3)
    count = error[..., 0].size
    for axis in range(3):
        assert error[..., axis].mean() == pytest.approx(0, abs=5 * 0.05 / math.sqrt(count))
        assert error[..., axis].std() == pytest.approx(0.05, rel=5 / math.sqrt(2 * count))
