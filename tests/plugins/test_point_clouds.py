"""Clouds of points from ray sensors: block_laser, velodyne, and ROS 2's ray_sensor."""

import math

import numpy as np
import pytest

from cartwheel.errors import CartwheelError
from cartwheel.geometry import Pose

HEIGHT = 1.0
AZIMUTHS = np.linspace(-0.5, 0.5, 11)
ELEVATIONS = np.linspace(-0.3, 0.2, 6)
DISTANCE = 2.0
"""m, of the wall: near enough that no row meets the ground first."""


def lidar(filename, tags, *, rays="", retro=7, kind="ray", most=10.0):
    """Eleven columns by six rows, and a wall across the x axis in the same model."""
    return f"""<model name="post"><static>true</static><pose>0 0 {HEIGHT} 0 0 0</pose>
      <link name="head">
      <collision name="wall"><pose>{DISTANCE + 0.5} 0 0 0 0 0</pose>
        <laser_retro>{retro}</laser_retro>
        <geometry><box><size>1 40 40</size></box></geometry></collision>
      <sensor name="lidar" type="{kind}"><update_rate>10</update_rate>
        <ray><scan>
          <horizontal><samples>11</samples><min_angle>-0.5</min_angle><max_angle>0.5</max_angle>
          </horizontal>
          <vertical><samples>6</samples><min_angle>-0.3</min_angle><max_angle>0.2</max_angle>
          </vertical></scan>
          <range><min>0.1</min><max>{most}</max></range>{rays}</ray>
        <plugin name="cloud" filename="{filename}"><frameName>optic</frameName>{tags}</plugin>
      </sensor></link></model>"""


def world_of(make, filename, tags="", **more):
    return make.world(make.sdf(lidar(filename, tags, **more)), seed=4)


def messages(world, topic, seconds=0.2):
    inbox = world.mailbox(topic, size=1000)
    world.run(seconds)
    inbox.close()
    return inbox.drain()


def on_the_wall():
    """Where each ray meets the wall, shape (rows, columns, 3)."""
    azimuth, elevation = np.meshgrid(AZIMUTHS, ELEVATIONS)
    return DISTANCE * np.stack(
        [np.ones_like(azimuth), np.tan(azimuth), np.tan(elevation) / np.cos(azimuth)], axis=-1
    )


def fields(message):
    """Those of a PointCloud2 by name, each of shape (height, width), by its own layout."""
    kinds = {4: "<u2", 7: "<f4"}
    layout = np.dtype(
        {
            "names": [field.name for field in message.fields],
            "formats": [kinds[field.datatype] for field in message.fields],
            "offsets": [field.offset for field in message.fields],
            "itemsize": message.point_step,
        }
    )
    assert len(message.data) == message.row_step * message.height
    assert message.row_step == message.point_step * message.width
    assert not message.is_bigendian
    return message.data.view(layout).reshape(message.height, message.width)


def places(cloud):
    return np.stack([cloud["x"], cloud["y"], cloud["z"]], axis=-1)


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
    told = messages(world_of(make, "libgazebo_ros_block_laser.so", tags), "/cloud", 6.0)
    points = np.array([[(p.x, p.y, p.z) for p in message.points] for message in told])
    error = points - on_the_wall().reshape(-1, 3)
    count = error[..., 0].size
    for axis in range(3):
        assert error[..., axis].mean() == pytest.approx(0, abs=5 * 0.05 / math.sqrt(count))
        assert error[..., axis].std() == pytest.approx(0.05, rel=5 / math.sqrt(2 * count))


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
    told = messages(world_of(make, VELODYNE, tags), "/points_raw", 6.0)
    expected = on_the_wall().transpose(1, 0, 2).reshape(-1, 3)
    length = np.linalg.norm(expected, axis=1)
    points = np.array([places(fields(message))[0] for message in told])
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
    assert (message.min_range, message.max_range) == (0.1, 10.0)
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


def test_clouds_of_one_seed_are_the_same_bit_for_bit(make):
    def run():
        tags = POINTS + "<gaussianNoise>0.03</gaussianNoise>"
        ball = make.box("ball", (0.3, 0.3, 0.3), pose=Pose((1.2, 0.1, 2.0)))
        world = make.world(ball, make.sdf(lidar(VELODYNE, tags)), seed=9)
        return [bytes(message.data) for message in messages(world, "/points_raw", 1.0)]

    assert run() == run()
