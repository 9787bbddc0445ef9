"""Gazebo Classic's camera plugins: names, stereo pairs, triggers and unsupported tags."""

import numpy as np
import pytest
from tests.coded import coded
from tests.devices.cameras.sensors import (
    RED,
    focal,
    pixels_of,
    reds,
    sensor,
    take,
    topic_names,
)
from tests.devices.cameras.services import ROS1, configure, stamps

from cartwheel.codes import devices, running
from cartwheel.codes.graph import TOPICS_SHARED
from cartwheel.errors import GraphError, PluginError
from cartwheel.geometry import Pose

STEREO = {"left": "<pose>0 0.035 0 0 0 0</pose>", "right": "<pose>0 -0.035 0 0 0 0</pose>"}


@pytest.mark.parametrize(
    "filename", ["libgazebo_ros_multicamera.so", "libgazebo_ros_triggered_multicamera.so"]
)
def test_a_pair_sees_the_disparity_of_its_baseline(make, filename):
    plugin = "<cameraName>pair</cameraName><hackBaseline>0.07</hackBaseline>"
    model = sensor(kind="multicamera", lenses=STEREO, plugin=plugin, filename=filename, width=640)
    post = make.box("post", (0.01, 0.2, 0.2), static=True, colour=RED, pose=Pose((1, 0, 1)))
    world = make.world(make.sdf(model), post)
    boxes = [
        world.mailbox(f"/pair/{side}/{topic}")
        for topic in ("image_raw", "camera_info")
        for side in ("left", "right")
    ]
    if "triggered" in filename:
        for side in ("left", "right"):
            world.publish(f"/pair/{side}/image_trigger")
    world.run(0.1)
    left, right, left_info, right_info = (box.drain()[0] for box in boxes)
    assert left.header == right.header == left_info.header == right_info.header
    middles = []
    for message in (left, right):
        columns = np.nonzero(reds(pixels_of(message)).any(axis=0))[0]
        middles.append((columns[0] + columns[-1] + 1) / 2)
    f, depth = focal(640), 0.995
    assert middles[0] - middles[1] == pytest.approx(f * 0.07 / depth, abs=1.5)
    assert left_info.p[3] == 0
    assert right_info.p[3] == pytest.approx(-f * 0.07)


def test_ros2s_pair_takes_the_names_as_they_are(make):
    lenses = {"my_left": "", "my_right": ""}
    plugin = "<ros><namespace>r</namespace></ros><camera_name>pair</camera_name>"
    world = make.world(make.sdf(sensor(kind="multicamera", lenses=lenses, plugin=plugin)))
    assert {name for name in topic_names(world) if name.startswith("/r/")} == {
        f"/r/pair/{lens}/{topic}"
        for lens in lenses
        for topic in ("image_raw", "image_raw/compressed", "camera_info")
    }


@pytest.mark.parametrize(
    ("filename", "plugin"),
    [
        ("libgazebo_ros_triggered_camera.so", ROS1),
        ("libgazebo_ros_camera.so", "<camera_name>eye</camera_name><triggered>true</triggered>"),
    ],
)
def test_a_trigger_makes_one_image(make, filename, plugin):
    # Once in 100 s by its own rate.
    world = make.world(make.sdf(sensor(filename=filename, plugin=plugin, rate=0.01)))
    images = world.mailbox("/eye/image_raw", size=100)
    world.run(1.0)
    assert images.drain() == []
    for count in (1, 3):
        for _ in range(count):
            world.publish("/eye/image_trigger")
        asked = world.session.simulation.time_ns
        world.run(0.5)
        messages = images.drain()
        assert len(messages) == count
        # A step each, from the next one on. Gazebo counts triggers and draws one image for each,
        # all at different times.
        assert len(set(stamps(messages))) == count
        assert stamps(messages)[0] - asked <= 5_000_000
        assert stamps(messages)[-1] - asked <= count * 5_000_000


def test_ros2s_pair_has_one_trigger_for_both(make):
    plugin = "<ros/><camera_name>pair</camera_name><triggered>true</triggered>"
    world = make.world(make.sdf(sensor(kind="multicamera", lenses=STEREO, plugin=plugin)))
    boxes = [world.mailbox(f"/pair/{side}/image_raw") for side in STEREO]
    world.publish("/pair/image_trigger")
    world.run(0.1)
    (left,), (right,) = (box.drain() for box in boxes)
    assert left.header == right.header


def test_ros2_states_the_rectified_image(make):
    """Of the projection each number may be stated; what is not is that of K."""
    turn = "0.9 0.1 0 -0.1 0.9 0 0 0 1"
    plugin = f"""<ros/><camera_name>eye</camera_name><P_fx>300</P_fx><P_cy>111</P_cy><Tx>-21</Tx>
      <Ty>2</Ty><hack_baseline>0.5</hack_baseline><cx>150</cx>
      <rectification_matrix>{turn}</rectification_matrix>"""
    world = make.world(make.sdf(sensor(plugin=plugin)))
    info = take(world, "/eye/camera_info")
    f = focal()
    assert info.k == pytest.approx([f, 0, 150, 0, f, 120.5, 0, 0, 1])
    assert info.r == pytest.approx([float(word) for word in turn.split()])
    assert info.p == pytest.approx([300, 0, 150, -21, 0, f, 111, 2, 0, 0, 1, 0])
    assert not world.diagnostics
    wrong = plugin.replace(turn, "1 0 0")
    with pytest.raises(PluginError) as caught:
        make.world(make.sdf(sensor(plugin=wrong)))
    assert caught.value.code is devices.PLUGIN_PARAMETER_INVALID


def test_a_triggered_camera_has_no_rate(make):
    model = sensor(filename="libgazebo_ros_triggered_camera.so", plugin=ROS1)
    world = make.world(make.sdf(model))
    with pytest.raises(GraphError) as caught:
        configure(world, "/eye", imager_rate=5.0)
    assert caught.value.code is running.CAMERA_WITHOUT_RATE


def test_prosilica_streams(make):
    model = sensor(filename="libgazebo_ros_prosilica.so", plugin=ROS1)
    world = make.world(make.sdf(model))
    assert take(world, "/eye/image_raw").encoding == "rgb8"
    assert not world.diagnostics
    polled = make.world()
    polled.session.graph.parameters.set("/eye/trigger_mode", "polled")
    polled.session.spawn(make.sdf(model))
    (reported,) = polled.diagnostics
    assert reported.code is devices.PLUGIN_PARAMETER_IGNORED
    assert reported.values["parameter"] == "trigger_mode"


@pytest.mark.parametrize(
    ("plugin", "topics"),
    [
        ("", {"/cam/image_raw", "/cam/camera_info"}),
        ("<frameName>f</frameName>", {"/image_raw", "/camera_info"}),
        ("<frame_name>f</frame_name>", {"/cam/image_raw", "/cam/camera_info"}),
        (
            "<cameraName>a/b</cameraName><imageTopicName>/c/d</imageTopicName>",
            {"/c/d", "/a/b/camera_info"},
        ),
        (
            "<robotNamespace>r</robotNamespace><cameraName>a</cameraName>"
            "<imageTopicName>i</imageTopicName><cameraInfoTopicName>j</cameraInfoTopicName>",
            {"/r/a/i", "/r/a/j"},
        ),
    ],
)
def test_names(make, plugin, topics):
    world = make.world(make.sdf(sensor(plugin=plugin)))
    images = {
        topic.name
        for topic in world.session.graph.topics()
        if topic.type in ("sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo")
    }
    assert images == topics


def test_two_of_one_name_are_reported_once_each(make):
    world = make.world()
    for name in ("one", "two"):
        world.session.spawn(make.sdf(sensor(name=name, plugin=ROS1)))
    found = [d.code for d in world.diagnostics if d.severity == "warning"]
    assert found == [running.SERVICE_TAKEN, TOPICS_SHARED]
    box = world.mailbox("/eye/image_raw", size=100)
    world.run(1.0)
    assert len(box.drain()) == 62


@pytest.mark.parametrize("kind", ["wideanglecamera", "camera"])
def test_a_view_that_no_pinhole_has_is_reported(make, kind):
    world = make.world(make.sdf(sensor(kind=kind, fov=3.1)))
    assert coded(world, devices.CAMERA_VIEW_NARROWED, stated=3.1, used=2.8)
    count = 2 if kind == "wideanglecamera" else 1
    assert len(coded(world, devices.CAMERA_VIEW_NARROWED)) == count
    assert take(world, "/cam/camera_info").k[0] == pytest.approx(focal(320, 2.8))


@pytest.mark.parametrize("written", ["lens", "save", "visibility_mask"])
def test_what_is_not_done_is_reported(make, written):
    world = make.world(make.sdf(sensor(inside=f"<{written}>1</{written}>")))
    (reported,) = [d for d in world.diagnostics if d.severity == "warning"]
    assert reported.code is devices.SENSOR_SETTING_IGNORED
    assert reported.values["setting"] == written
    off = make.world(make.sdf(sensor(inside='<save enabled="false"/>')))
    assert not [d for d in off.diagnostics if d.severity == "warning"]
