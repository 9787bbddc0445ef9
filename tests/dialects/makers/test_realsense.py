"""A RealSense: four streams of one plugin."""

import numpy as np
import pytest
from tests.coded import coded
from tests.devices.cameras.sensors import cloud_of, pixels_of, take, topic_names

from cartwheel.codes import devices, running
from cartwheel.geometry import Pose

PLUGIN = """<plugin name="camera" filename="librealsense_gazebo_plugin.so">
  <prefix>rs_</prefix>
  <colorTopicName>color/image_raw</colorTopicName>
  <colorCameraInfoTopicName>color/camera_info</colorCameraInfoTopicName>
  <infrared1TopicName>infra1/image_raw</infrared1TopicName>
  <infrared2TopicName>infra2/image_raw</infrared2TopicName>
  <depthTopicName>depth/image_raw</depthTopicName>
  <colorOpticalframeName>color_optical</colorOpticalframeName>
  <depthOpticalframeName>depth_optical</depthOpticalframeName>
  <depthUpdateRate>10</depthUpdateRate>
  <rangeMinDepth>0.3</rangeMinDepth><rangeMaxDepth>3</rangeMaxDepth>
  <pointCloud>1</pointCloud><pointCloudTopicName>depth/color/points</pointCloudTopicName>
  <pointCloudCutoff>0.3</pointCloudCutoff><pointCloudCutoffMax>{}</pointCloudCutoffMax>{}</plugin>"""


def eye(name, kind, form):
    return f"""<sensor name="rs_{name}" type="{kind}"><update_rate>30</update_rate>
      <camera><horizontal_fov>1.2</horizontal_fov><image><width>64</width><height>48</height>
      <format>{form}</format></image><clip><near>0.1</near><far>50</far></clip></camera></sensor>"""


def device(make, *, far=5, tags="", without=""):
    eyes = "".join(
        eye(name, kind, form)
        for name, kind, form in (
            ("color", "camera", "RGB_INT8"),
            ("ired1", "camera", "L_INT8"),
            ("ired2", "camera", "L_INT8"),
            ("depth", "depth", "R8G8B8"),
        )
        if name != without
    )
    return make.sdf(f"""<model name="rs"><static>1</static><pose>0 0 1 0 0 0</pose>
      <link name="link">{eyes}</link>{PLUGIN.format(far, tags)}</model>""")


def wall(make, distance):
    pose = Pose((distance + 0.05, 0, 1))
    return make.box("wall", (0.1, 60, 60), static=True, pose=pose, colour=(0.9, 0.05, 0.05))


def test_all_four_see_under_the_plugins_name(make):
    world = make.world(device(make), wall(make, 2.0), ground=None)
    assert {
        "/camera/color/image_raw",
        "/camera/color/camera_info",
        "/camera/infra1/image_raw",
        "/camera/infra2/image_raw",
        "/camera/infra2/camera_info",
        "/camera/depth/image_raw",
        "/camera/depth/camera_info",
        "/camera/depth/color/points",
    } <= set(topic_names(world))
    assert not coded(world, devices.SENSOR_WITHOUT_PLUGIN)
    colour = take(world, "/camera/color/image_raw")
    assert (colour.encoding, colour.header.frame_id) == ("rgb8", "color_optical")
    red, green, blue = pixels_of(colour)[24, 32].tolist()
    assert red > 4 * max(green, blue)
    grey = take(world, "/camera/infra1/image_raw")
    assert (grey.encoding, grey.header.frame_id) == ("mono8", "link")
    info = take(world, "/camera/depth/camera_info")
    assert (info.width, info.height) == (64, 48)


def test_depths_are_whole_millimetres_within_their_range(make):
    for distance, reported in ((2.0, 2000), (0.2, 0), (3.5, 0)):
        world = make.world(device(make), wall(make, distance), ground=None)
        message = take(world, "/camera/depth/image_raw")
        assert (message.encoding, message.header.frame_id) == ("16UC1", "depth_optical")
        depths = np.asarray(message.data).view("<u2")
        assert np.abs(depths.astype(int) - reported).max() <= 1
        world.close()


def test_points_have_bounds_of_their_own(make):
    """At 3.5 m there is no depth, and a point all the same; with the bound at 3 there is none."""
    world = make.world(device(make), wall(make, 3.5), ground=None)
    cloud = cloud_of(take(world, "/camera/depth/color/points"))
    assert np.abs(cloud["z"] - 3.5).max() < 1e-3
    near = make.world(device(make, far=3), wall(make, 3.5), ground=None)
    assert np.isnan(cloud_of(take(near, "/camera/depth/color/points"))["z"]).all()


def test_the_rate_is_the_lesser_of_both(make, read):
    world = make.world(device(make), wall(make, 2.0), ground=None)
    assert len(read(world, "/camera/depth/camera_info", 1.0)) == 11
    assert len(read(world, "/camera/color/camera_info", 1.0)) == 30


def test_a_sensor_that_is_missing_and_a_tag_unknown_are_reported_once(make):
    world = make.world(device(make, tags="<foo>1</foo>", without="ired2"))
    assert len(coded(world, running.UNKNOWN_SENSOR, name="rs_ired2")) == 1
    assert len(coded(world, devices.PLUGIN_PARAMETER_UNKNOWN, parameter="foo")) == 1
    names = topic_names(world)
    assert "/camera/infra1/image_raw" in names
    assert "/camera/infra2/image_raw" not in names


@pytest.mark.parametrize("points", ["0", "false"])
def test_without_points_there_are_none(make, points):
    text = PLUGIN.format(5, "").replace("<pointCloud>1<", f"<pointCloud>{points}<")
    described = make.sdf(f"""<model name="rs"><static>1</static><link name="link">
      {eye("depth", "depth", "R8G8B8")}</link>{text}</model>""")
    world = make.world(described)
    assert "/camera/depth/color/points" not in topic_names(world)
    assert "/camera/depth/image_raw" in topic_names(world)
