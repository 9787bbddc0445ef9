"""Point clouds of a velodyne, with rings."""

import math

import numpy as np
import pytest
from tests.devices.rays.walls import (
    AZIMUTHS,
    ELEVATIONS,
    HEIGHT,
    fields,
    lidar,
    messages,
    on_the_wall,
    places,
    world_of,
)

from cartwheel.geometry import Pose

VELODYNE = "libgazebo_ros_velodyne_laser.so"

POINTS = "<topicName>points_raw</topicName>"


def test_a_velodyne_gives_points_with_rings_column_by_column(make):
    message = messages(world_of(make, VELODYNE, POINTS), "/points_raw")[0]
    # What its drivers' users unpack.
    assert [(f.name, f.offset, f.datatype) for f in message.fields] == [
        ("x", 0, 7),
        ("y", 4, 7),
        ("z", 8, 7),
        ("intensity", 12, 7),
        ("ring", 16, 4),
        ("time", 18, 7),
    ]
    assert (message.height, message.width, message.point_step) == (1, 66, 22)
    assert message.is_dense
    cloud = fields(message)
    assert places(cloud)[0] == pytest.approx(
        on_the_wall().transpose(1, 0, 2).reshape(-1, 3), abs=1e-6
    )
    assert cloud["ring"][0].tolist() == [0, 1, 2, 3, 4, 5] * 11
    assert set(cloud["time"].ravel()) == {0.0}
    assert set(cloud["intensity"].ravel()) == {7.0}


def test_an_organised_cloud_keeps_the_place_of_what_was_not_hit(make):
    tags = POINTS + "<organize_cloud>true</organize_cloud><max_range>2.1</max_range>"
    message = messages(world_of(make, VELODYNE, tags), "/points_raw")[0]
    assert (message.height, message.width) == (11, 6)
    assert not message.is_dense
    cloud = fields(message)
    expected = on_the_wall().transpose(1, 0, 2)
    near = np.linalg.norm(expected, axis=-1) < 2.1
    assert 0 < near.sum() < 66
    assert places(cloud)[near] == pytest.approx(expected[near], abs=1e-6)
    assert np.isnan(places(cloud)[~near]).all()


@pytest.mark.parametrize(
    ("tags", "kept"),
    [
        ("<min_range>2.1</min_range>", lambda r: r > 2.1),
        ("<max_range>2.1</max_range>", lambda r: r < 2.1),
        ("<min_intensity>7.5</min_intensity>", lambda r: r < 0),
        ("<min_intensity>6.5</min_intensity>", lambda r: r > 0),
    ],
)
def test_a_velodyne_leaves_out_what_its_tags_leave_out(make, tags, kept):
    message = messages(world_of(make, VELODYNE, POINTS + tags), "/points_raw")[0]
    ranges = np.linalg.norm(on_the_wall(), axis=-1)
    assert message.width == kept(ranges).sum()


def test_a_velodynes_noise_is_along_the_rays(make):
    tags = POINTS + "<gaussianNoise>0.03</gaussianNoise>"
    reported = messages(world_of(make, VELODYNE, tags), "/points_raw", 6.0)
    expected = on_the_wall().transpose(1, 0, 2).reshape(-1, 3)
    length = np.linalg.norm(expected, axis=1)
    points = np.array([places(fields(message))[0] for message in reported])
    error = np.linalg.norm(points, axis=2) - length
    assert error.std() == pytest.approx(0.03, rel=5 / math.sqrt(2 * error.size))
    # Each point stays on its ray.
    along = points / np.linalg.norm(points, axis=2, keepdims=True)
    assert along == pytest.approx(
        np.broadcast_to(expected / length[:, None], points.shape), abs=1e-5
    )


def test_the_gpu_kind_sees_visuals(make):
    """The wall of this model is a collision alone."""
    world = world_of(make, "libgazebo_ros_velodyne_gpu_laser.so", POINTS, kind="gpu_ray")
    _, elevation = np.meshgrid(AZIMUTHS, ELEVATIONS)
    # Only the rows that meet the ground within 10 m give points.
    hit = 10.0 * np.sin(-elevation) > HEIGHT
    message = messages(world, "/points_raw")[0]
    assert message.width == hit.sum() > 0


def test_clouds_of_one_seed_are_the_same_bit_for_bit(make):
    def run():
        tags = POINTS + "<gaussianNoise>0.03</gaussianNoise>"
        ball = make.box("ball", (0.3, 0.3, 0.3), pose=Pose((1.2, 0.1, 2.0)))
        world = make.world(ball, make.sdf(lidar(VELODYNE, tags)), seed=9)
        return [bytes(message.data) for message in messages(world, "/points_raw", 1.0)]

    assert run() == run()
