"""Settings of all sensors: errors with drift and rounding, and the axes of messages."""

import math

import numpy as np
import pytest
from tests.coded import coded, named
from tests.devices.cameras.sensors import pixels_of, sensor, take
from tests.devices.position.bodies import spherical

from cartwheel.codes import devices, running
from cartwheel.description import load_text
from cartwheel.geometry import Pose

FIELD = (2e-5, 1e-6, -4e-5)
"""T."""
RATE = 100
STEP = 1 / RATE


def noise(kind="gaussian", **tags):
    inside = "".join(f"<{tag}>{value}</{tag}>" for tag, value in tags.items())
    return f"<noise><type>{kind}</type>{inside}</noise>"


def magnetometer(error="", *, link="link", topic="m"):
    axes = "".join(f"<{axis}>{error}</{axis}>" for axis in "xyz")
    return f"""<link name="{link}"><sensor name="same" type="magnetometer">
      <update_rate>{RATE}</update_rate><topic>{topic}</topic>
      <magnetometer>{axes}</magnetometer></sensor></link>"""


def standing(make, *links, **more):
    model = f'<model name="post"><static>1</static>{"".join(links)}</model>'
    return make.world(make.sdf(model), ground=None, magnetic_field=FIELD, **more)


def reported(world, seconds, topic="/m"):
    box = world.mailbox(topic, size=100_000)
    world.run(seconds)
    box.close()
    return box.drain()


def fields(messages):
    vectors = [message.magnetic_field for message in messages]
    return np.array([(each.x, each.y, each.z) for each in vectors])


def messages_of(world):
    return [each.message for each in world.diagnostics]


# -- errors


def test_a_bias_wanders_and_forgets(make):
    """A Gauss-Markov process of the stated density: its variance comes to density² time / 2."""
    density, time = 1e-3, 0.5
    error = noise(dynamic_bias_stddev=density, dynamic_bias_correlation_time=time)
    wandered = fields(reported(standing(make, magnetometer(error)), 100.0)) - FIELD
    assert wandered[0].tolist() == [0, 0, 0]
    deviation = density * math.sqrt(time / 2)
    settled = wandered[5 * RATE :]
    # Three axes of 95 s hold some 3 * 95 / (2 * 0.5) values that know nothing of each other.
    assert settled.std() == pytest.approx(deviation, rel=5 / math.sqrt(2 * 285))
    steps = np.diff(wandered, axis=0)
    keep = math.exp(-STEP / time)
    expected = deviation * math.sqrt(2 * (1 - keep))
    assert steps.std() == pytest.approx(expected, rel=5 / math.sqrt(2 * steps.size))


def test_where_a_bias_is_does_not_depend_on_who_listens_since_when(make):
    error = noise(dynamic_bias_stddev=1, dynamic_bias_correlation_time=2, stddev=0.1)
    first, second = (standing(make, magnetometer(error)) for _ in range(2))
    early = fields(reported(first, 3.0))
    second.run(2.0)
    late = fields(reported(second, 1.0))
    assert len(late) == RATE
    assert np.array_equal(early[-RATE:], late)


def test_after_a_reset_a_bias_begins_anew(make):
    error = noise(dynamic_bias_stddev=1, dynamic_bias_correlation_time=2)
    world = standing(make, magnetometer(error))
    assert abs(fields(reported(world, 5.0))[-1] - FIELD).max() > 1e-3
    world.reset()
    assert fields(reported(world, 0.1))[0] == pytest.approx(FIELD)


def test_what_is_quantised_is_a_multiple_of_the_precision(make):
    error = noise("gaussian_quantized", stddev=2.0, precision=0.5)
    values = fields(reported(standing(make, magnetometer(error)), 2.0))
    assert np.array_equal(values, np.round(values / 0.5) * 0.5)
    assert len(np.unique(values)) > 5


@pytest.mark.parametrize("error", [noise(stddev=1, precision=0.5), noise(dynamic_bias_stddev=1)])
def test_an_error_without_effect_is_reported_with_its_line(make, error):
    world = standing(make, magnetometer(error))
    found = coded(world, devices.SENSOR_SETTING_IGNORED)
    assert len(found) == 3
    assert all(each.origin is not None and each.origin.line == 3 for each in found)


@pytest.mark.parametrize(
    "wrong", [{"dynamic_bias_stddev": -1}, {"dynamic_bias_correlation_time": "long"}]
)
def test_an_error_without_sense_leaves_its_sensor_out(make, wrong):
    (tag,) = wrong
    world = standing(make, magnetometer(noise(**wrong)))
    assert coded(world, running.PLUGIN_LEFT_OUT, parameter=tag)


def test_sensors_of_one_name_on_two_links_have_errors_of_their_own(make):
    error = noise(stddev=1)
    links = [magnetometer(error, link=name, topic=name) for name in ("left", "right")]
    world = standing(make, *links)
    boxes = [world.mailbox(f"/{name}", size=100) for name in ("left", "right")]
    world.run(0.5)
    left, right = (fields(box.drain()) for box in boxes)
    assert len(left) == len(right) == RATE / 2 + 1
    assert abs(left - right).min() > 0


def test_a_range_has_the_bias_of_its_sensor(make):
    error = noise(bias_mean=0.1, bias_stddev=0, mean=0.03)
    ray = f"""<link name="link"><sensor name="s" type="ray"><pose>0 0 1 0 0 0</pose>
      <update_rate>10</update_rate><ray><scan><horizontal><samples>1</samples></horizontal></scan>
      <range><min>0.1</min><max>5</max></range>{error}</ray>
      <plugin name="p" filename="libgazebo_ros_range.so"><topicName>range</topicName></plugin>
      </sensor></link>"""
    wall = make.box("wall", (1, 4, 4), static=True, pose=Pose((2.5, 0, 0)))
    model = make.sdf(f'<model name="post"><static>1</static>{ray}</model>')
    (value,) = {message.range for message in reported(make.world(wall, model), 1.0, "/range")}
    assert abs(value - 2.03) == pytest.approx(0.1)


def test_an_image_without_noise_by_its_type_has_none(make):
    """Numbers are there, but the type is none."""
    wall = make.box("wall", (1, 9, 9), static=True, pose=Pose((3, 0, 1)))

    def seen(kind):
        model = sensor(width=40, height=30, inside=noise(kind, mean=0.3, stddev=0.2))
        return pixels_of(take(make.world(wall, make.sdf(model), ground=None), "/cam/image_raw"))

    assert len(np.unique(seen("none")[..., 0])) == 1
    assert len(np.unique(seen("pink")[..., 0])) == 1
    assert len(np.unique(seen("gaussian")[..., 0])) > 20


def test_a_camera_with_invalid_noise_is_left_out(make):
    model = make.sdf(sensor(inside=noise(stddev=-0.1)))
    assert not [each for link in model.links for each in link.sensors]
    (error,) = [each for each in model.diagnostics if each.severity == "error"]
    assert error.values["left_out"] == "sensor"
    assert error.origin is not None


def test_an_unknown_format_is_colours_and_reported(make):
    world = make.world(make.sdf(sensor(width=8, height=6, form="CMYK")))
    message = take(world, "/cam/image_raw")
    assert (message.encoding, message.step) == ("rgb8", 24)
    assert coded(world, devices.IMAGE_FORMAT_UNKNOWN, format="CMYK")


# -- axes

TURN = (0.3, -0.2, 1.1)
"""Roll, pitch and yaw of the unit in the world."""
HEADING = 0.4
"""By which the world's x is turned from the east to the north."""


def about(axis, angle):
    """A rotation's matrix about x, y or z."""
    cos, sin = math.cos(angle), math.sin(angle)
    matrix = np.eye(3)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix[[i, i, j, j], [i, j, i, j]] = cos, -sin, sin, cos
    return matrix


def fixed(roll, pitch, yaw):
    return about("z", yaw) @ about("y", pitch) @ about("x", roll)


def matrix_of(q):
    x, y, z, w = q.x, q.y, q.z, q.w
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


IN_THE_WORLD = fixed(*TURN)
EASTWARD = about("z", HEADING) @ IN_THE_WORLD
"""Columns: the unit's axes along east, north and up."""


NORTH_WEST_UP = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]])
NORTH_EAST_DOWN = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
"""Rows: their axes along east, north and up."""


def oriented(make, inside):
    """The messages of a unit, and its world."""
    model = f"""<model name="post"><static>1</static><pose>0 0 1 {" ".join(map(str, TURN))}</pose>
      <link name="link"><sensor name="s" type="imu"><topic>imu</topic><update_rate>10</update_rate>
      <imu>{inside}</imu></sensor></link></model>"""
    place = spherical(40, 10, heading=math.degrees(HEADING))
    world = make.world(make.sdf(model), ground=None, spherical_coordinates=place)
    return reported(world, 0.2, "/imu")[0], world


@pytest.mark.parametrize(
    ("frame", "expected"),
    [
        ("", IN_THE_WORLD),
        ("<localization>CUSTOM</localization>", IN_THE_WORLD),
        ("<custom_rpy>0.5 -0.3 2</custom_rpy>", fixed(0.5, -0.3, 2).T @ IN_THE_WORLD),
        ("<localization>ENU</localization>", EASTWARD),
        ("<localization>NWU</localization>", NORTH_WEST_UP @ EASTWARD),
        ("<localization>NED</localization>", NORTH_EAST_DOWN @ EASTWARD),
    ],
)
def test_an_orientation_is_published_in_the_axes_that_are_set(make, frame, expected):
    message, world = oriented(
        make, f"<orientation_reference_frame>{frame}</orientation_reference_frame>"
    )
    assert matrix_of(message.orientation) == pytest.approx(expected, abs=1e-6)
    # Rates and accelerations stay in the unit's own.
    felt = message.linear_acceleration
    assert (felt.x, felt.y, felt.z) == pytest.approx(IN_THE_WORLD.T @ [0, 0, 9.8], abs=1e-6)
    assert messages_of(world) == []


@pytest.mark.parametrize(
    "frame",
    [
        "<localization>GRAV_UP</localization><grav_dir_x>1 0 0</grav_dir_x>",
        '<custom_rpy parent_frame="base">0 0 1</custom_rpy>',
    ],
)
def test_axes_that_are_not_there_are_reported(make, frame):
    message, world = oriented(
        make, f"<orientation_reference_frame>{frame}</orientation_reference_frame>"
    )
    assert matrix_of(message.orientation) == pytest.approx(IN_THE_WORLD, abs=1e-6)
    (warning,) = world.diagnostics
    assert warning.code is devices.SENSOR_SETTING_IGNORED


@pytest.mark.parametrize(
    "frame",
    [
        "<localization>UP</localization>",
        "<custom_rpy>1 2</custom_rpy>",
        "<custom_rpy>1 2 nan</custom_rpy>",
    ],
)
def test_axes_without_sense_leave_the_sensor_out(make, frame):
    model = f"""<model name="post"><static>1</static><link name="link"><sensor name="s" type="imu">
      <topic>imu</topic><imu><orientation_reference_frame>{frame}</orientation_reference_frame>
      </imu></sensor></link></model>"""
    world = make.world(make.sdf(model), ground=None)
    cause = devices.PLUGIN_PARAMETER_INVALID.number
    assert coded(world, running.PLUGIN_LEFT_OUT, plugin="s", cause=cause)


def test_a_unit_without_orientation_says_so(make):
    """sensor_msgs/Imu: the first element of its covariance is -1 then."""
    message, _ = oriented(make, "<enable_orientation>false</enable_orientation>")
    assert message.orientation_covariance[0] == -1
    assert matrix_of(message.orientation) == pytest.approx(np.eye(3))
    with_it, _ = oriented(make, "<enable_orientation>true</enable_orientation>")
    assert with_it.orientation_covariance[0] == 0


# -- tags

EVERYTHING = f"""<sensor name="s" type="camera" xmlns:x="http://example.org/">
  <pose relative_to="link">0 0 1 0 0 0</pose><update_rate>5</update_rate>
  <always_on>1</always_on><visualize>1</visualize><topic>t</topic><gz_frame_id>f</gz_frame_id>
  <enable_metrics>0</enable_metrics><x:y>1</x:y>
  <camera name="a"><pose>0 0 0 0 0 0</pose><horizontal_fov>1</horizontal_fov>
    <image><width>9</width><height>9</height><format>L8</format><anti_aliasing>4</anti_aliasing>
    </image><clip><near>1</near><far>2</far></clip><save enabled="0"><path>/p</path></save>
    <depth_camera><output>depths</output><clip><near>1</near><far>2</far></clip></depth_camera>
    {noise(mean=0, stddev=0)}
    <distortion><k1>0</k1><k2>0</k2><k3>0</k3><p1>0</p1><p2>0</p2><center>0.5 0.5</center>
    </distortion><optical_frame_id>o</optical_frame_id><camera_info_topic>i</camera_info_topic>
    <triggered>0</triggered><trigger_topic>t</trigger_topic><visibility_mask>1</visibility_mask>
  </camera><camera name="b"/>
  <imu>{
    "".join(
        f"<{what}><x>{noise(stddev=1)}</x></{what}>"
        for what in ("angular_velocity", "linear_acceleration")
    )
}</imu>
  <force_torque><frame>child</frame><measure_direction>child_to_parent</measure_direction>
    <force><x>{noise(stddev=1)}</x></force></force_torque>
  <contact><collision>a</collision><collision>b</collision><topic>t</topic></contact>
  <plugin name="p" filename="libp.so"><anything/></plugin>
  <plugin name="q" filename="libq.so"><anything/></plugin>
</sensor>"""
RAYS = """<sensor name="s" type="ray"><ray><scan>
  <horizontal><samples>9</samples><resolution>1</resolution><min_angle>0</min_angle>{}</horizontal>
  <vertical><samples>9</samples></vertical></scan>
  <range><min>1</min><max>2</max><resolution>0.01</resolution></range></ray>{}</sensor>"""


def said_of(text):
    described = load_text(
        f"""<sdf version="1.7"><model name="m"><link name="link">{text}</link></model></sdf>""",
        file="test.sdf",
    )
    return [named(each) for each in described.diagnostics if each.code.name != "not-simulated"]


@pytest.mark.parametrize("text", [EVERYTHING, RAYS.format("<max_angle>1</max_angle>", "")])
def test_of_what_a_sensor_may_have_nothing_is_said(text):
    assert said_of(text) == []


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (
            RAYS.format("<max_angel>1</max_angel>", ""),
            "tag-ignored max_angle",
        ),
        (
            RAYS.format("", "<ray/>"),
            "tag-repeated",
        ),
        (
            RAYS.format("", "<origin xyz='0 0 1'/>"),
            "tag-ignored",
        ),
        (
            EVERYTHING.replace('<camera name="b"/>', '<camera name="b" fov="2"/>'),
            "tag-ignored",
        ),
        (
            EVERYTHING.replace("<near>1</near><far>2</far>", "<near>1</near><fare>2</fare>", 1),
            "tag-ignored far",
        ),
    ],
)
def test_what_nobody_reads_in_a_sensor_is_reported(text, code):
    assert said_of(text) == [code]
