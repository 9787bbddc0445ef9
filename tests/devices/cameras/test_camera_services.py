"""Cameras changed while they run: calibration, rate, compression and formats."""

import io

import numpy as np
import pytest
from PIL import Image
from tests.coded import raises
from tests.devices.cameras.sensors import (
    RED,
    pixels_of,
    sensor,
    service_names,
    take,
    topic_names,
)
from tests.devices.cameras.services import ROS1, call, configure, stamps, values_of

from cartwheel.codes import running
from cartwheel.codes.graph import TOPIC_TYPE_MISMATCH
from cartwheel.errors import GraphError
from cartwheel.geometry import Pose
from cartwheel.messages import to_dict


def test_topics_and_services_are_gazebos(make):
    """What a real Gazebo 11 listed for a camera of ROS 1."""
    world = make.world(make.sdf(sensor(plugin=ROS1)))
    assert {name for name in service_names(world) if name.startswith("/eye/")} == {
        "/eye/set_camera_info",
        "/eye/set_parameters",
        "/eye/image_raw/compressed/set_parameters",
        "/eye/image_raw/compressedDepth/set_parameters",
    }
    bases = ("", "image_raw/compressed/", "image_raw/compressedDepth/")
    assert {name for name in topic_names(world) if name.startswith("/eye/")} == {
        "/eye/camera_info",
        "/eye/image_raw",
        "/eye/image_raw/compressed",
        "/eye/image_raw/compressedDepth",
        *(f"/eye/{base}parameter_{kind}" for base in bases for kind in ("descriptions", "updates")),
    }


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        # type, level, default, least and most, as a real Gazebo 11 printed them.
        ("/eye", {"imager_rate": ("double", 3, 2.0, 1.0, 50.0)}),
        (
            "/eye/image_raw/compressed",
            {
                "enable": ("bool", 0, True, False, True),
                "format": ("str", 0, "jpeg", "", ""),
                "jpeg_quality": ("int", 0, 80, 1, 100),
                "jpeg_progressive": ("bool", 0, False, False, True),
                "jpeg_optimize": ("bool", 0, False, False, True),
                "jpeg_restart_interval": ("int", 0, 0, 0, 65535),
                "png_level": ("int", 0, 9, 1, 9),
            },
        ),
        (
            "/eye/image_raw/compressedDepth",
            {
                "enable": ("bool", 0, True, False, True),
                "format": ("str", 0, "png", "", ""),
                "depth_max": ("double", 0, 10.0, 1.0, 100.0),
                "depth_quantization": ("double", 0, 100.0, 1.0, 150.0),
                "png_level": ("int", 0, 1, 1, 9),
            },
        ),
    ],
)
def test_parameters_are_described_as_gazebo_does(make, name, expected):
    world = make.world(make.sdf(sensor(plugin=ROS1)))
    reported = take(world, f"{name}/parameter_descriptions")
    (group,) = reported.groups
    defaults, least, most = (
        values_of(config) for config in (reported.dflt, reported.min, reported.max)
    )
    assert {
        p.name: (p.type, p.level, defaults[p.name], least[p.name], most[p.name])
        for p in group.parameters
    } == expected
    assert [p.name for p in group.parameters] == list(expected)
    assert all(p.description for p in group.parameters)


def test_imager_rate_acts(make):
    world = make.world(make.sdf(sensor(plugin=ROS1)))
    assert values_of(take(world, "/eye/parameter_updates")) == {"imager_rate": 30.0}
    box = world.mailbox("/eye/camera_info", size=1000)
    assert configure(world, "/eye", imager_rate=10.0) == {"imager_rate": 10.0}
    world.run(0.2)
    box.drain()
    world.run(2.0)
    messages = box.drain()
    assert len(messages) == 20
    assert set(np.diff(stamps(messages)).tolist()) == {100_000_000}
    assert configure(world, "/eye", imager_rate=1000.0) == {"imager_rate": 50.0}
    box.drain()
    world.run(2.0)
    assert len(box.drain()) == 100


def test_a_calibration_that_is_set_is_published_from_then_on(make):
    world = make.world(make.sdf(sensor(plugin=f"{ROS1}<frameName>optics</frameName>")))
    before = to_dict(take(world, "/eye/camera_info"))
    given = {
        "header": {"frame_id": "elsewhere"},
        "height": 240,
        "width": 320,
        "distortion_model": "plumb_bob",
        "d": [0.1, 0.2, 0.3, 0.4, 0.5],
        "k": [300.0, 0.0, 150.0, 0.0, 301.0, 110.0, 0.0, 0.0, 1.0],
        "r": [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        "p": [305.0, 0.0, 151.0, 0.0, 0.0, 306.0, 111.0, 0.0, 0.0, 0.0, 1.0, 0.0],
    }
    service = ("/eye/set_camera_info", "sensor_msgs/srv/SetCameraInfo")
    answer = call(world, *service, {"camera_info": given})
    assert (answer.success, answer.status_message) == (True, "")
    after = to_dict(take(world, "/eye/camera_info"))
    for name in ("d", "k", "r", "p", "distortion_model", "height", "width"):
        assert after[name] == given[name]
    assert after["header"]["frame_id"] == "optics"
    assert after["header"]["stamp"] != before["header"]["stamp"]
    refused = call(world, *service, {"camera_info": given | {"width": 640}})
    assert not refused.success and refused.status_message
    assert to_dict(take(world, "/eye/camera_info"))["k"] == given["k"]


def compressed(world):
    message = take(world, "/eye/image_raw/compressed")
    return message, Image.open(io.BytesIO(message.data.tobytes()))


def test_compression_is_what_is_set(make):
    post = make.box("post", (0.4, 0.4, 0.4), static=True, colour=RED, pose=Pose((2, 0.1, 1)))
    world = make.world(make.sdf(sensor(plugin=ROS1)), post)
    name = "/eye/image_raw/compressed"
    message, image = compressed(world)
    assert (message.format, image.format) == ("rgb8; jpeg compressed bgr8", "JPEG")
    fine = len(message.data)
    configure(world, name, jpeg_quality=10)
    assert len(compressed(world)[0].data) < 0.85 * fine
    configure(world, name, jpeg_progressive=True)
    assert compressed(world)[1].info.get("progressive")
    configure(world, name, jpeg_progressive=False, jpeg_restart_interval=4)
    # The marker that defines the interval: 4 bytes of length, then the number.
    assert b"\xff\xdd\x00\x04\x00\x04" in compressed(world)[0].data.tobytes()
    configure(world, name, format="png")
    message, image = compressed(world)
    assert (message.format, image.format) == ("rgb8; png compressed bgr8", "PNG")
    raw = pixels_of(take(world, "/eye/image_raw"))
    assert np.array_equal(np.asarray(image), raw)
    small = len(message.data)
    configure(world, name, png_level=1)
    assert len(compressed(world)[0].data) > small
    configure(world, name, enable=False)
    box = world.mailbox(name)
    world.run(0.5)
    assert box.drain() == []
    box.close()
    configure(world, name, enable=True)
    with pytest.raises(GraphError) as caught:
        configure(world, name, format="gif")
    assert caught.value.code is running.IMAGE_COMPRESSION_UNKNOWN
    assert compressed(world)[1].format == "PNG"


def test_parameters_set_before_count(make):
    """As a launch file sets them."""
    world = make.world()
    world.session.graph.parameters.set("/eye/image_raw/compressed/format", "png")
    world.session.spawn(make.sdf(sensor(plugin=ROS1)))
    assert compressed(world)[1].format == "PNG"


ENCODINGS = {
    "R8G8B8": ("rgb8", 3),
    "RGB8": ("rgb8", 3),
    "rgb8": ("rgb8", 3),
    "BGR_INT8": ("bgr8", 3),
    "L8": ("mono8", 1),
    "L16": ("mono16", 2),
    "R16G16B16": ("rgb16", 6),
    "BAYER_RGGB8": ("bayer_rggb8", 1),
    "BAYER_BGGR8": ("bayer_bggr8", 1),
    "BAYER_GBRG8": ("bayer_gbrg8", 1),
    "BAYER_GRBG8": ("bayer_grbg8", 1),
}


@pytest.mark.parametrize("form", ENCODINGS)
def test_formats(make, form):
    post = make.box("post", (0.4, 0.4, 0.4), static=True, colour=RED, pose=Pose((2, 0.1, 1)))
    rgb = pixels_of(take(make.world(make.sdf(sensor()), post), "/cam/image_raw"))
    world = make.world(make.sdf(sensor(form=form, plugin=ROS1)), post)
    message = take(world, "/eye/image_raw")
    encoding, size = ENCODINGS[form]
    assert (message.encoding, message.step) == (encoding, 320 * size)
    assert (message.is_bigendian, len(message.data)) == (0, 320 * 240 * size)
    data = np.asarray(message.data)
    grey = rgb @ np.array([0.299, 0.587, 0.114])
    if encoding == "rgb8":
        assert np.array_equal(data.reshape(rgb.shape), rgb)
    elif encoding == "bgr8":
        assert np.array_equal(data.reshape(rgb.shape)[..., ::-1], rgb)
    elif encoding == "mono8":
        assert np.abs(data.reshape(240, 320) - grey).max() <= 0.51
    elif encoding == "mono16":
        assert np.abs(data.view("<u2").reshape(240, 320) / 257 - grey).max() <= 0.51
    elif encoding == "rgb16":
        assert np.array_equal(data.view("<u2").reshape(rgb.shape), rgb.astype(int) * 257)
    else:
        # The letters name the filters of the upper left four pixels, row by row.
        mosaic = data.reshape(240, 320)
        for index, letter in enumerate(encoding.removeprefix("bayer_")[:4]):
            row, column = divmod(index, 2)
            channel = rgb[row::2, column::2, "rgb".index(letter)]
            assert np.array_equal(mosaic[row::2, column::2], channel)
    packed, image = compressed(world)
    assert packed.format.startswith(f"{encoding}; jpeg compressed ")
    assert image.mode == ("RGB" if size % 3 == 0 else "L")
    assert image.size == (320, 240)


def test_noise_is_alike_in_the_three_colours(make):
    noise = "<noise><type>gaussian</type><mean>0.1</mean><stddev>0.05</stddev></noise>"
    world = make.world(make.sdf(sensor(inside=noise)), ground=None, background=(0.4, 0.4, 0.4, 1))
    pixels = pixels_of(take(world, "/cam/image_raw")).astype(float)
    assert np.ptp(pixels, axis=-1).max() == 0
    assert pixels.mean() == pytest.approx((0.4 + 0.1) * 255, abs=1)
    assert pixels.std() == pytest.approx(0.05 * 255, rel=0.02)


def test_a_camera_leaves_nothing_behind(make):
    world = make.world()
    before = (topic_names(world), service_names(world))
    model = sensor(kind="depth", filename="libgazebo_ros_openni_kinect.so", plugin=ROS1)
    world.session.spawn(make.sdf(model))
    assert (topic_names(world), service_names(world)) != before
    world.model("cam_eye").delete()
    assert (topic_names(world), service_names(world)) == before


def test_a_camera_that_cannot_be_made_leaves_nothing_behind(make):
    world = make.world()
    world.session.graph.parameters.set("/eye/image_raw/compressed/jpeg_quality", "fine")
    before = (topic_names(world), service_names(world))
    with_preset = sensor(plugin=ROS1)
    world.session.spawn(make.sdf(with_preset))
    (reported,) = [d for d in world.diagnostics if d.severity == "warning"]
    assert reported.code is running.RECONFIGURE_UNAVAILABLE
    world.model("cam_eye").delete()
    assert (topic_names(world), service_names(world)) == before
    # A topic of another type stands in the way of the last one that it opens.
    box = world.session.graph.mailbox("/eye/depth/camera_info", type_name="std_msgs/msg/Empty")
    taken = topic_names(world)
    with raises(TOPIC_TYPE_MISMATCH, topic="/eye/depth/camera_info"):
        world.session.spawn(make.sdf(sensor(kind="depth", plugin=ROS1)))
    assert (topic_names(world), service_names(world)) == (taken, before[1])
    box.close()
