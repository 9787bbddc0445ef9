"""Cameras changed while they run: calibration, rate, compression; formats; pairs and triggers."""

import io

import numpy as np
import pytest
from PIL import Image
from tests.coded import coded, raises
from tests.plugins.cameras import (
    RED,
    focal,
    pixels_of,
    reds,
    sensor,
    service_names,
    take,
    topic_names,
)

from cartwheel.codes import devices, running
from cartwheel.codes.graph import TOPIC_TYPE_MISMATCH
from cartwheel.errors import GraphError, PluginError
from cartwheel.geometry import Pose
from cartwheel.messages import from_dict, to_dict

ROS1 = "<cameraName>eye</cameraName>"


def call(world, name, type_name, request):
    """A service's response, its request given as a mapping."""
    future = world.session.graph.call(name, from_dict(f"{type_name}_Request", request))
    world.run(0.005)
    return future.result(timeout=10)


def configure(world, name, **values):
    fields = {bool: "bools", int: "ints", str: "strs", float: "doubles"}
    config = {}
    for key, value in values.items():
        config.setdefault(fields[type(value)], []).append({"name": key, "value": value})
    response = call(
        world, f"{name}/set_parameters", "dynamic_reconfigure/srv/Reconfigure", {"config": config}
    )
    return values_of(response.config)


def values_of(config):
    told = to_dict(config)
    return {
        item["name"]: item["value"]
        for field in ("bools", "ints", "strs", "doubles")
        for item in told[field]
    }


def stamps(messages):
    return [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in messages]


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
    told = take(world, f"{name}/parameter_descriptions")
    (group,) = told.groups
    defaults, least, most = (values_of(config) for config in (told.dflt, told.min, told.max))
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


def test_a_calibration_that_is_set_is_told_from_then_on(make):
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
    assert not refused.success
    assert "640 x 240" in refused.status_message
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
    (told,) = polled.diagnostics
    assert told.code is devices.PLUGIN_PARAMETER_IGNORED
    assert told.values["parameter"] == "trigger_mode"


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


def test_two_of_one_name_are_told_once_each(make):
    world = make.world()
    for name in ("one", "two"):
        world.session.spawn(make.sdf(sensor(name=name, plugin=ROS1)))
    (told,) = [d for d in world.diagnostics if d.severity == "warning"]
    assert told.code is running.SERVICE_TAKEN
    box = world.mailbox("/eye/image_raw", size=100)
    world.run(1.0)
    assert len(box.drain()) == 60


@pytest.mark.parametrize("kind", ["wideanglecamera", "camera"])
def test_a_view_that_no_pinhole_has_is_told(make, kind):
    world = make.world(make.sdf(sensor(kind=kind, fov=3.1)))
    assert coded(world, devices.CAMERA_VIEW_NARROWED, stated=3.1, used=2.8)
    count = 2 if kind == "wideanglecamera" else 1
    assert len(coded(world, devices.CAMERA_VIEW_NARROWED)) == count
    assert take(world, "/cam/camera_info").k[0] == pytest.approx(focal(320, 2.8))


@pytest.mark.parametrize("written", ["lens", "save", "visibility_mask"])
def test_what_is_not_done_is_told(make, written):
    world = make.world(make.sdf(sensor(inside=f"<{written}>1</{written}>")))
    (told,) = [d for d in world.diagnostics if d.severity == "warning"]
    assert told.code is devices.SENSOR_SETTING_IGNORED
    assert told.values["setting"] == written
    off = make.world(make.sdf(sensor(inside='<save enabled="false"/>')))
    assert not [d for d in off.diagnostics if d.severity == "warning"]


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
    (told,) = [d for d in world.diagnostics if d.severity == "warning"]
    assert told.code is running.RECONFIGURE_UNAVAILABLE
    world.model("cam_eye").delete()
    assert (topic_names(world), service_names(world)) == before
    # A topic of another type stands in the way of the last one that it opens.
    box = world.session.graph.mailbox("/eye/depth/camera_info", type_name="std_msgs/msg/Empty")
    taken = topic_names(world)
    with raises(TOPIC_TYPE_MISMATCH, topic="/eye/depth/camera_info"):
        world.session.spawn(make.sdf(sensor(kind="depth", plugin=ROS1)))
    assert (topic_names(world), service_names(world)) == (taken, before[1])
    box.close()
