"""Lidars of gz-sim: a scan and a point cloud, without a plugin."""

import math

import numpy as np
import pytest
from tests.coded import coded

from cartwheel.codes import devices
from cartwheel.geometry import Pose

HEIGHT = 0.5

SYSTEM = '<plugin name="s" filename="gz-sim-sensors-system"/>'


def lidar(*, kind="gpu_lidar", tags="<topic>scan</topic>", rows=3, plugin="", name="lidar"):
    """Five columns, straight ahead in the middle; `rows` from 0.2 rad below to 0.2 above."""
    return f"""<model name="robot"><static>true</static><pose>0 0 {HEIGHT} 0 0 0</pose>
      <link name="head"><sensor name="{name}" type="{kind}">{tags}<update_rate>10</update_rate>
        <ray><scan><horizontal><samples>5</samples><min_angle>-0.4</min_angle>
          <max_angle>0.4</max_angle></horizontal>
          <vertical><samples>{rows}</samples><min_angle>-0.2</min_angle>
          <max_angle>0.2</max_angle></vertical></scan>
          <range><min>0.1</min><max>20</max></range></ray></sensor></link>{plugin}</model>"""


def topics(world):
    return {topic.name: topic.type for topic in world.session.graph.topics()}


def read(world, topic):
    inbox = world.mailbox(topic, size=100)
    world.run(0.2)
    inbox.close()
    return inbox.drain()[0]


def columns(message):
    """The fields of a PointCloud2 by name, each of shape (height, width)."""
    kinds = {4: np.uint16, 7: np.float32}
    raw = message.data.reshape(message.height, message.width, message.point_step)
    return {
        field.name: raw[..., field.offset : field.offset + np.dtype(kinds[field.datatype]).itemsize]
        .copy()
        .view(kinds[field.datatype])[..., 0]
        for field in message.fields
    }


def test_its_topic_carries_the_scan_and_below_it_the_points(make):
    """On a wall across the x axis y is x tan(azimuth), and z is x tan(elevation)/cos(azimuth)."""
    distance = 2.0
    wall = make.box("wall", (1, 50, 50), static=True, pose=Pose((distance + 0.5, 0, 0)))
    world = make.world(wall, make.sdf(lidar()))
    message = read(world, "/scan")
    assert message.header.frame_id == "head"
    # The middle row is level.
    azimuth, elevation = np.meshgrid(np.linspace(-0.4, 0.4, 5), [-0.2, 0.0, 0.2])
    assert message.ranges == pytest.approx(distance / np.cos(azimuth[1]), rel=1e-6)

    cloud = read(world, "/scan/points")
    assert (cloud.height, cloud.width) == (3, 5)
    assert cloud.is_dense
    assert cloud.row_step == cloud.width * cloud.point_step
    fields = columns(cloud)
    # No row meets the ground before the wall.
    height = distance * np.tan(elevation) / np.cos(azimuth)
    assert height.min() > -HEIGHT
    assert fields["x"] == pytest.approx(np.full((3, 5), distance), rel=1e-6)
    assert fields["y"] == pytest.approx(distance * np.tan(azimuth), abs=1e-6)
    assert fields["z"] == pytest.approx(height, abs=1e-6)
    assert fields["ring"].tolist() == [[0] * 5, [1] * 5, [2] * 5]


def test_rows_that_meet_the_ground_lie_on_it(make):
    world = make.world(make.sdf(lidar(rows=2, kind="lidar")))
    cloud = read(world, "/scan/points")
    fields = columns(cloud)
    assert fields["z"][0] == pytest.approx(np.full(5, -HEIGHT), abs=1e-5)
    distance = HEIGHT / math.tan(0.2)
    assert np.hypot(fields["x"][0], fields["y"][0]) == pytest.approx(np.full(5, distance), rel=1e-5)
    # The upper row sees the sky.
    assert not cloud.is_dense
    assert np.all(np.isposinf(fields["x"][1]))
    assert not np.isnan(fields["y"]).any()


@pytest.mark.parametrize("tag", ["gz_frame_id", "ignition_frame_id"])
def test_the_frame_is_the_one_that_is_named(make, tag):
    tags = f"<topic>scan</topic><{tag}>optic</{tag}>"
    assert read(make.world(make.sdf(lidar(tags=tags))), "/scan").header.frame_id == "optic"


def test_it_publishes_wherever_it_is_written_for_new_gazebo(make):
    assert topics(make.world(make.sdf(lidar())))["/scan"] == "sensor_msgs/msg/LaserScan"
    assert "/scan" in topics(make.world(make.sdf(lidar(kind="ray"))))


def test_without_a_topic_it_has_gazebos_long_name(make):
    world = make.world(make.sdf(lidar(tags="", name="front-lidar")))
    base = "/world/test/model/robot/link/head/sensor/front_lidar/scan"
    assert {base, f"{base}/points"} <= set(topics(world))


def test_gazebo_classics_ray_without_plugin_is_silent_and_reported(make):
    world = make.world(make.sdf(lidar(kind="ray", tags="")))
    assert not any("scan" in name for name in topics(world))
    (reported,) = coded(world, devices.SENSOR_WITHOUT_PLUGIN)
    assert reported.origin.file == "test.sdf"


@pytest.mark.parametrize(("kind", "publishes"), [("gpu_lidar", True), ("ray", False)])
def test_a_plugin_that_is_none_takes_nothing_from_a_sensor_of_new_gazebo(make, kind, publishes):
    dummy = '<plugin name="dummy" filename="dummyfile"/>'
    world = make.world(make.sdf(lidar(kind=kind, tags=dummy)))
    assert any(name.endswith("/scan") for name in topics(world)) == publishes
    (reported,) = world.session.diagnostics
    assert reported.code is devices.PLUGIN_UNKNOWN
    assert reported.values["name"] == "dummyfile"


def test_physics_that_a_model_names_is_there_anyway(make):
    world = make.world(make.sdf(lidar(tags="", plugin=SYSTEM.replace("sensors", "physics"))))
    assert not world.session.diagnostics


@pytest.mark.parametrize("system", [SYSTEM, SYSTEM.replace("gz-sim", "libignition-gazebo")])
def test_a_system_of_the_model_makes_its_sensors_publish(make, system):
    world = make.world(make.sdf(lidar(kind="ray", tags="", plugin=system)))
    assert any(name.endswith("/scan") for name in topics(world))
    assert not coded(world, devices.PLUGIN_UNKNOWN)


def test_a_system_of_the_world_does_the_same(make):
    from cartwheel.description.model import Element, PluginTag
    from cartwheel.errors import Origin

    here = Origin(file="test.sdf", line=1)
    tag = PluginTag(
        name="s",
        filename="gz-sim-sensors-system",
        element=Element(tag="plugin", origin=here),
        origin=here,
    )
    world = make.world(make.sdf(lidar(kind="ray", tags="")), plugins=(tag,))
    assert any(name.endswith("/scan") for name in topics(world))


def test_a_type_that_nothing_serves_is_a_warning(make):
    world = make.world(
        make.sdf(
            """<model name="m"><static>true</static><link name="l">
            <sensor name="wind" type="air_speed"><topic>wind</topic></sensor></link></model>"""
        )
    )
    (warning,) = coded(world, devices.SENSOR_WITHOUT_PLUGIN, sensor="wind", type="air_speed")
    assert warning.severity == "warning"


def test_a_lidar_may_say_lidar_instead_of_ray(make):
    text = lidar().replace("<ray>", "<lidar>").replace("</ray>", "</lidar>")
    assert len(read(make.world(make.sdf(text)), "/scan").ranges) == 5


def test_it_leaves_with_its_model(make):
    world = make.world(make.sdf(lidar()))
    world.session.simulation.delete("robot")
    assert "/scan" not in topics(world)


@pytest.mark.parametrize("filename", ["gz-sim-pose-publisher-system", "gz_ros2_control-system"])
def test_sensors_of_a_model_for_gz_publish_on_gazebos_default_topic(make, filename):
    plugin = f'<plugin name="p" filename="{filename}"/>'
    world = make.world(make.sdf(lidar(kind="ray", tags="", plugin=plugin)))
    assert "/world/test/model/robot/link/head/sensor/lidar/scan" in topics(world)
    assert not coded(world, devices.SENSOR_WITHOUT_PLUGIN)
