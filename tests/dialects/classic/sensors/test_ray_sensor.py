"""The messages of ROS 2's ray_sensor, and tags of point clouds that are refused."""

import math

import numpy as np
import pytest
from tests.devices.rays.walls import fields, messages, on_the_wall, places, world_of
from tests.dialects.makers.test_velodyne_laser import VELODYNE

from cartwheel.errors import CartwheelError
from cartwheel.messages.singles import single

RAY = "libgazebo_ros_ray_sensor.so"


def ray(make, tags, **more):
    return world_of(make, RAY, tags, **more)


def test_a_ray_sensor_gives_points_when_nothing_is_asked_for(make):
    world = ray(make, "<ros><remapping>~/out:=cloud</remapping></ros>")
    message = messages(world, "/cloud")[0]
    assert (message.height, message.width, message.point_step) == (1, 66, 16)
    cloud = fields(message)
    assert places(cloud)[0] == pytest.approx(on_the_wall().reshape(-1, 3), abs=1e-6)
    assert set(cloud["intensity"].ravel()) == {7.0}


def test_a_ray_sensor_gives_a_scan_of_the_middle_row(make):
    tags = """<ros><namespace>bot</namespace><remapping>~/out:=scan</remapping></ros>
      <output_type>sensor_msgs/LaserScan</output_type><min_intensity>9</min_intensity>"""
    message = messages(ray(make, tags), "/bot/scan")[0]
    length = np.linalg.norm(on_the_wall(), axis=-1)
    assert message.ranges == pytest.approx(length[3], rel=1e-6)
    assert message.intensities.tolist() == [9.0] * 11


def test_a_ray_sensor_gives_the_old_clouds_too(make):
    tags = "<outputType>sensor_msgs/PointCloud</outputType><topicName>old</topicName>"
    message = messages(ray(make, tags), "/old")[0]
    assert np.array([(p.x, p.y, p.z) for p in message.points]) == pytest.approx(
        on_the_wall().reshape(-1, 3), abs=1e-6
    )


def test_a_ray_sensor_gives_the_least_range(make):
    tags = "<output_type>sensor_msgs/Range</output_type>"
    message = messages(ray(make, tags), "/cloud/out")[0]
    assert message.range == pytest.approx(np.linalg.norm(on_the_wall(), axis=-1).min(), rel=1e-6)
    # The wider of the two angles.
    assert message.field_of_view == pytest.approx(1.0)
    assert message.radiation_type == message.INFRARED
    assert (message.min_range, message.max_range) == (single(0.1), 10.0)
    nothing = messages(ray(make, tags, most=1.5), "/cloud/out")[0]
    assert nothing.range == math.inf


@pytest.mark.parametrize(
    ("filename", "tags", "parameter"),
    [
        (RAY, "<output_type>sensor_msgs/Image</output_type>", "output_type"),
        (VELODYNE, "<min_range>5</min_range><max_range>4</max_range>", "min_range"),
        (VELODYNE, "<gaussianNoise>-1</gaussianNoise>", "gaussianNoise"),
        ("libgazebo_ros_block_laser.so", "<gaussianNoise>-1</gaussianNoise>", "gaussianNoise"),
    ],
)
def test_tags_that_make_no_sense_are_refused_with_their_place(make, filename, tags, parameter):
    with pytest.raises(CartwheelError) as error:
        world_of(make, filename, tags)
    assert error.value.values["parameter"] == parameter
    assert error.value.origin is not None
