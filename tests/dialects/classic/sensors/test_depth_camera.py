"""Depths and points against the pinhole model: planes and boxes whose depths a formula gives."""

import io
import math
import struct

import numpy as np
import pytest
from PIL import Image
from tests.coded import coded
from tests.devices.cameras.depths import DEPTH, KINECT, far_below, kinect
from tests.devices.cameras.sensors import (
    RED,
    cloud_of,
    depths_of,
    pixels_of,
    rays,
    reds,
    sensor,
    service_names,
    take,
    topic_names,
)

from cartwheel.codes import devices
from cartwheel.geometry import Pose


def test_a_sensor_without_a_lens_has_sdf_s_own(make):
    bare = kinect()
    begin, end = bare.index("<camera name"), bare.index("</camera>") + len("</camera>")
    world = make.world(make.sdf(bare[:begin] + bare[end:]), ground=None)
    image = take(world, "/k/depth/image_raw")
    assert (image.width, image.height) == (320, 240)
    focal = take(world, "/k/depth/camera_info").k[0]
    assert focal == pytest.approx(160 / math.tan(1.047 / 2), rel=1e-3)
    (reported,) = coded(world, devices.SENSOR_INCOMPLETE, missing="camera")
    assert reported.severity == "warning"


@pytest.mark.parametrize("distance", [0.5, 2.0, 4.9])
def test_a_wall_has_one_depth_all_over(make, distance):
    """Along the optical axis, whatever the pixel's own ray is."""
    wall = make.box("wall", (0.1, 60, 60), static=True, pose=Pose((distance + 0.05, 0, 1)))
    world = make.world(make.sdf(kinect(near=0.1, far=50.0)), wall, ground=None)
    depths = depths_of(take(world, "/k/depth/image_raw"))
    # A step of a buffer of 24 bits, in which depths are stored inversely; and two of a float.
    step = distance**2 * (1 / 0.1 - 1 / 50) / 2**24
    assert np.abs(depths - distance).max() <= step + 2 * np.spacing(np.float32(distance))


def test_the_grounds_depth_is_that_of_the_formula(make):
    world = make.world(
        make.sdf(
            kinect(
                "<cameraName>k</cameraName><pointCloudCutoffMax>30</pointCloudCutoffMax>",
                pose="0 0 1 0 0.3 0",
            )
        )
    )
    depths = depths_of(take(world, "/k/depth/image_raw"))
    expected = far_below(1.0, tilt=0.3)
    seen = expected < 30
    assert np.isnan(depths[expected > 31]).all()
    assert seen.any()
    np.testing.assert_allclose(depths[expected < 29.9], expected[expected < 29.9], rtol=2e-4)


@pytest.mark.parametrize(
    ("filename", "tags", "near", "far"),
    [
        (KINECT, "", 0.4, 5.0),
        (DEPTH, "", 0.4, math.inf),
        (KINECT, "<pointCloudCutoff>2</pointCloudCutoff>", 2.0, 5.0),
        (DEPTH, "<pointCloudCutoffMax>3</pointCloudCutoffMax>", 0.4, 3.0),
    ],
)
def test_cutoffs(make, filename, tags, near, far):
    """The ground from an eye that looks straight at the horizon has all depths."""
    world = make.world(
        make.sdf(
            kinect(f"<cameraName>k</cameraName>{tags}", filename, pose="0 0 0.1 0 0 0", near=0.05)
        )
    )
    depths = depths_of(take(world, "/k/depth/image_raw"))
    expected = far_below(0.1)
    reported = ~np.isnan(depths)
    assert reported.any()
    low, high = 1.01 * near, 0.99 * min(far, 50.0)
    assert reported[(expected > low) & (expected < high)].all()
    assert not reported[(expected < 0.99 * near) | (expected > 1.01 * far)].any()
    assert depths[reported].min() > near
    assert depths[reported].max() < far


def test_millimetres(make):
    wall = make.box("wall", (0.1, 60, 60), static=True, pose=Pose((2.05, 0, 1)))
    tags = "<cameraName>k</cameraName><useDepth16UC1Format>true</useDepth16UC1Format>"
    message = take(make.world(make.sdf(kinect(tags)), wall), "/k/depth/image_raw")
    assert (message.encoding, message.step, message.is_bigendian) == ("16UC1", 640, 0)
    assert np.abs(np.asarray(message.data).view("<u2").astype(int) - 2000).max() <= 1
    nothing = take(make.world(make.sdf(kinect(tags)), ground=None), "/k/depth/image_raw")
    assert not np.asarray(nothing.data).any()


def test_points_are_where_things_are(make):
    """In the optical frame: x right, y down, z ahead; with the colour that the image has there."""
    post = make.box("post", (0.2, 0.3, 0.4), static=True, colour=RED, pose=Pose((2.1, 0.5, 1.2)))
    world = make.world(
        make.sdf(kinect("<cameraName>k</cameraName><frameName>eye</frameName>")), post
    )
    boxes = {
        name: world.mailbox(f"/k/{name}")
        for name in ("points", "ir/image_raw", "depth/image_raw", "depth/camera_info")
    }
    world.run(0.1)
    cloud_message, image, depth, info = (box.drain()[0] for box in boxes.values())
    assert cloud_message.header == image.header == depth.header == info.header
    assert cloud_message.header.frame_id == "eye"
    assert [(f.name, f.offset, f.datatype, f.count) for f in cloud_message.fields] == [
        ("x", 0, 7, 1),
        ("y", 4, 7, 1),
        ("z", 8, 7, 1),
        ("rgb", 16, 7, 1),
    ]
    assert (cloud_message.point_step, cloud_message.row_step) == (32, 320 * 32)
    assert (cloud_message.height, cloud_message.width) == (240, 320)
    assert not cloud_message.is_dense
    cloud, pixels, depths = cloud_of(cloud_message), pixels_of(image), depths_of(depth)
    red = reds(pixels)
    assert red.sum() > 500
    # The post's front is at y from 0.35 to 0.65 and z from 1.0 to 1.4 of the world, the eye at
    # z 1; a pixel is 2 / 279 m there.
    pixel = 2.0 / (320 / (2 * math.tan(0.52)))
    front = red & (np.abs(cloud["z"] - 2.0) < 1e-3)
    assert cloud["x"][front].min() == pytest.approx(-0.65, abs=pixel)
    assert cloud["x"][front].max() == pytest.approx(-0.35, abs=pixel)
    assert cloud["y"][front].min() == pytest.approx(-0.4, abs=pixel)
    assert cloud["y"][front].max() == pytest.approx(0.0, abs=pixel)
    right, down = rays()
    reported = ~np.isnan(depths)
    assert np.array_equal(np.isnan(cloud["x"]), ~reported)
    np.testing.assert_allclose(
        cloud["x"][reported], (right * depths)[reported], rtol=1e-5, atol=1e-6
    )
    np.testing.assert_allclose(
        cloud["y"][reported], (down * depths)[reported], rtol=1e-5, atol=1e-6
    )
    packed = np.ascontiguousarray(cloud["rgb"]).view(np.uint32)
    assert np.array_equal(packed >> 16 & 255, pixels[..., 0])
    assert np.array_equal(packed >> 8 & 255, pixels[..., 1])
    assert np.array_equal(packed & 255, pixels[..., 2])
    assert not (packed >> 24).any()


def test_topics_and_services_are_gazebos(make):
    world = make.world(make.sdf(kinect()))
    own = {name for name in topic_names(world) if name.startswith("/k/")}
    plain = {"depth/camera_info", "depth/image_raw", "ir/camera_info", "ir/image_raw", "points"}
    packed = {"ir/image_raw/compressed", "ir/image_raw/compressedDepth"}
    reported = {
        f"{base}parameter_{kind}"
        for base in ("", *(f"{name}/" for name in packed))
        for kind in ("descriptions", "updates")
    }
    assert own == {f"/k/{name}" for name in plain | packed | reported}
    assert {name for name in service_names(world) if name.startswith("/k/")} == {
        "/k/set_camera_info",
        "/k/set_parameters",
        "/k/ir/image_raw/compressed/set_parameters",
        "/k/ir/image_raw/compressedDepth/set_parameters",
    }


def test_one_picture_serves_all(make):
    world = make.world(make.sdf(kinect()))
    drawn = []
    renderer = world.session.simulation.engine.renderer
    draw = renderer._draw
    renderer._draw = lambda *a: drawn.append(1) or draw(*a)
    boxes = [world.mailbox("/k/depth/camera_info", size=100)]
    world.run(1.0)
    assert len(boxes[0].drain()) == 31
    assert not drawn
    boxes += [world.mailbox(f"/k/{name}", size=100) for name in ("ir/image_raw", "points")]
    world.run(1.0)
    assert [len(box.drain()) for box in boxes[1:]] == [30, 30]
    assert len(drawn) == 30


def test_colours_alone_cost_no_depth(make):
    world = make.world(make.sdf(kinect()))
    renderer = world.session.simulation.engine.renderer
    renderer.render_with_depth = None
    assert take(world, "/k/ir/image_raw").encoding == "rgb8"


ROS2 = """<ros><namespace>robot</namespace>
  <remapping>/robot/eye/points:=/robot/eye/depth/color/points</remapping>
  <remapping>eye/camera_info:=reported</remapping></ros>
  <camera_name>eye</camera_name><frame_name>optical</frame_name>
  <min_depth>1.0</min_depth><max_depth>3.0</max_depth>"""


def test_ros2s_camera_does_depths_by_the_sensors_type(make):
    world = make.world(make.sdf(sensor(kind="depth", plugin=ROS2, pose="0 0 0.5 0 0 0")))
    own = {name for name in topic_names(world) if name.startswith("/robot/")}
    assert own == {
        "/robot/eye/image_raw",
        "/robot/eye/image_raw/compressed",
        "/robot/reported",
        "/robot/eye/depth/image_raw",
        "/robot/eye/depth/image_raw/compressedDepth",
        "/robot/eye/depth/camera_info",
        "/robot/eye/depth/color/points",
    }
    message = take(world, "/robot/eye/depth/image_raw")
    assert (message.header.frame_id, message.encoding, message.step) == ("optical", "32FC1", 1280)
    depths, expected = depths_of(message), far_below(0.5)
    assert (depths[expected < 0.99] == -np.inf).all()
    assert (depths[expected > 3.03] == np.inf).all()
    between = (expected > 1.01) & (expected < 2.97)
    np.testing.assert_allclose(depths[between], expected[between], rtol=1e-3)
    cloud = cloud_of(take(world, "/robot/eye/depth/color/points"))
    for axis in "xyz":
        assert np.array_equal(np.isposinf(cloud[axis]), np.isposinf(depths))
        assert np.array_equal(np.isneginf(cloud[axis]), np.isneginf(depths))


def test_compressed_depths_are_read_back(make):
    """As compressed_depth_image_transport decodes: depth = a / (step - b)."""
    model = sensor(kind="depth", plugin="<camera_name>eye</camera_name>", pose="0 0 0.5 0 0 0")
    world = make.world(make.sdf(model))
    raw = world.mailbox("/eye/depth/image_raw")
    packed = take(world, "/eye/depth/image_raw/compressedDepth")
    depths = depths_of(raw.drain()[0])
    assert packed.format == "32FC1; compressedDepth png"
    data = packed.data.tobytes()
    kind, a, b = struct.unpack("<iff", data[:12])
    assert kind == 1
    steps = np.asarray(Image.open(io.BytesIO(data[12:]))).astype(float)
    assert steps.shape == (240, 320)
    reported = np.isfinite(depths) & (depths < 10)
    assert np.array_equal(steps > 0, reported)
    found = a / (steps[reported] - b)
    # A step less or more, at depth z z² / a.
    assert (np.abs(found - depths[reported]) <= 1.01 * depths[reported] ** 2 / a + 1e-6).all()


def test_what_gazebo_11_does_not_publish_is_reported(make):
    tags = "<cameraName>k</cameraName><normalsTopicName>n</normalsTopicName>"
    world = make.world(make.sdf(kinect(tags, DEPTH)))
    (reported,) = [d for d in world.diagnostics if d.severity == "warning"]
    assert reported.code is devices.PLUGIN_PARAMETER_IGNORED
    assert reported.values["parameter"] == "normalsTopicName"
    assert reported.origin is not None
