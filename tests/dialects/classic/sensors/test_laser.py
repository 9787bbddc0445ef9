"""Gazebo Classic's laser plugins: messages, names and frames."""

import numpy as np
import pytest
from tests.devices.rays.scanners import HEIGHT, box, model, scan, sensor, wall

from cartwheel.geometry import Pose
from cartwheel.messages.singles import single


def test_the_message_says_what_the_sensor_is(make):
    world = make.world(wall(make, 2.0), make.sdf(model(sensor(low=-1.0, high=1.5, samples=11))))
    message = scan(world)
    assert message.header.frame_id == "laser"
    assert (message.range_min, message.range_max) == (single(0.1), 10.0)
    assert (message.angle_min, message.angle_max) == (-1.0, 1.5)
    assert message.angle_increment == pytest.approx(0.25)
    # All rays are measured in one moment, as in Gazebo.
    assert (message.time_increment, message.scan_time) == (0.0, 0.0)
    assert message.ranges.dtype == message.intensities.dtype == np.float32


def test_a_gpu_sensor_sees_visuals_and_a_cpu_sensor_collisions(make):
    ahead = f"""<model name="ahead"><static>true</static><link name="link">
      {box("solid", "1 1 4", "3.5 0 0 0 0 0")}
      {box("picture", "1 1 4", "2.5 0 0 0 0 0", visual=True)}</link></model>"""
    for kind, plugin, expected in (
        ("ray", "libgazebo_ros_laser.so", 3.0),
        ("gpu_ray", "libgazebo_ros_gpu_laser.so", 2.0),
    ):
        text = sensor(samples=1, kind=kind, plugin=plugin)
        world = make.world(make.sdf(ahead), make.sdf(model(text)))
        assert scan(world).ranges == pytest.approx([expected])


def test_two_robots_have_their_own_topics_and_frames(make):
    world = make.world(wall(make, 2.0))
    described = make.sdf(model(sensor(samples=1)))
    for index in (1, 2):
        world.session.spawn(
            described,
            name=f"post_{index}",
            pose=Pose((-index, 0, HEIGHT)),
            namespace=f"robot_{index}",
            frame_prefix=f"robot_{index}",
        )
    for index in (1, 2):
        message = scan(world, f"/robot_{index}/scan")
        assert message.header.frame_id == f"robot_{index}/laser"
        # The second stands behind the first, of which a scanner alone is nothing to be seen.
        assert message.ranges == pytest.approx([2.0 + index])


@pytest.mark.parametrize(
    ("named", "frame"), [("laser", "robot_1/laser"), ("/laser", "laser"), ("", "robot_1/laser")]
)
def test_a_namespace_goes_before_the_frame_where_there_is_no_prefix(make, named, frame):
    tags = f"<topicName>scan</topicName><frameName>{named}</frameName>"
    tags += "<robotNamespace>/robot_1</robotNamespace>"
    world = make.world(make.sdf(model(sensor(samples=1, tags=tags))))
    assert scan(world, "/robot_1/scan").header.frame_id == frame
