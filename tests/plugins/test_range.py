"""Range finders: the nearest of their rays."""

import math

import numpy as np
import pytest

from cartwheel.codes import devices
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Pose

RANGE = "libgazebo_ros_range.so"
SONAR = "libhector_gazebo_ros_sonar.so"


def finder(
    tags="<topicName>front</topicName>",
    *,
    filename=RANGE,
    rate=20,
    least=0.05,
    most=4.0,
    noise="",
):
    """Five by five rays, a quarter rad to each side."""
    angles = "<samples>5</samples><min_angle>-0.25</min_angle><max_angle>0.25</max_angle>"
    return f"""<model name="post"><static>true</static><pose>0 0 2 0 0 0</pose>
      <link name="nose"><sensor name="sonar" type="ray"><update_rate>{rate}</update_rate>
        <ray><scan><horizontal>{angles}</horizontal><vertical>{angles}</vertical></scan>
          <range><min>{least}</min><max>{most}</max></range>{noise}</ray>
        <plugin name="range" filename="{filename}">{tags}</plugin></sensor></link></model>"""


def wall(make, distance):
    return make.box("wall", (1, 10, 10), static=True, pose=Pose((distance + 0.5, 0, 0)))


def messages(world, topic="/front", seconds=0.2):
    inbox = world.mailbox(topic, size=10_000)
    world.run(seconds)
    inbox.close()
    return inbox.drain()


def test_it_reads_the_nearest_thing_ahead(make):
    """A post off the axis is nearer than the wall: the ray at -0.125 rad meets its face."""
    post = make.box("post_ahead", (0.1, 0.1, 8), static=True, pose=Pose((1.05, -0.1257, 0)))
    world = make.world(wall(make, 2.0), make.sdf(finder()))
    assert messages(world)[0].range == pytest.approx(2.0)
    world.session.spawn(post)
    assert messages(world)[-1].range == pytest.approx(1.0 / math.cos(0.125), rel=1e-6)


def test_the_message_says_what_the_tags_say(make):
    tags = """<topicName>front</topicName><frameName>sonar_link</frameName><fov>0.5</fov>
      <radiation>infrared</radiation>"""
    message = messages(make.world(make.sdf(finder(tags))))[0]
    assert message.header.frame_id == "sonar_link"
    assert message.radiation_type == message.INFRARED
    assert message.field_of_view == 0.5
    assert (message.min_range, message.max_range) == (0.05, 4.0)


def test_what_is_not_said_is_as_in_gazebo(make):
    message = messages(make.world(make.sdf(finder(""))), "/range")[0]
    assert message.radiation_type == message.ULTRASOUND
    assert message.field_of_view == 0.05
    assert message.header.frame_id == "nose"


def test_nothing_reads_as_the_maximum_and_the_too_near_as_the_minimum(make):
    assert messages(make.world(make.sdf(finder())))[0].range == 4.0
    near = make.world(wall(make, 0.2), make.sdf(finder(least=0.3)))
    assert messages(near)[0].range == pytest.approx(0.3)


@pytest.mark.parametrize(("asked", "told"), [("", 20), ("8", 8), ("100", 20)])
def test_the_slower_of_the_two_rates_counts(make, asked, told):
    tags = "<topicName>front</topicName>" + (f"<updateRate>{asked}</updateRate>" if asked else "")
    assert len(messages(make.world(make.sdf(finder(tags))), seconds=2.0)) == 2 * told


@pytest.mark.parametrize(
    ("tags", "rays"),
    [
        ("<gaussianNoise>0.02</gaussianNoise>", ""),
        ("", "<noise><type>gaussian</type><mean>0</mean><stddev>0.02</stddev></noise>"),
    ],
)
def test_noise_is_of_the_range_not_of_the_rays(make, tags, rays):
    text = finder("<topicName>front</topicName>" + tags, rate=200, noise=rays)
    told = messages(make.world(wall(make, 2.0), make.sdf(text)), seconds=5.0)
    readings = np.array([message.range for message in told])
    count = len(readings)
    assert count == 1000
    # The least of 25 noisy rays would be 2 standard deviations short.
    assert readings.mean() == pytest.approx(2.0, abs=5 * 0.02 / math.sqrt(count))
    assert readings.std() == pytest.approx(0.02, rel=5 / math.sqrt(2 * count))


def test_noise_stays_within_the_limits(make):
    text = finder("<topicName>front</topicName><gaussianNoise>1</gaussianNoise>", rate=100)
    told = messages(make.world(wall(make, 2.0), make.sdf(text)), seconds=2.0)
    readings = [message.range for message in told]
    assert min(readings) >= 0.05
    assert max(readings) == 4.0


def test_hectors_sonar(make):
    tags = "<topicName>sonar/front</topicName><frameId>ear</frameId><offset>0.1</offset>"
    world = make.world(wall(make, 2.0), make.sdf(finder(tags, filename=SONAR)))
    message = messages(world, "/sonar/front")[0]
    assert message.range == pytest.approx(2.1)
    assert message.header.frame_id == "ear"
    assert message.radiation_type == message.ULTRASOUND
    assert message.field_of_view == pytest.approx(0.5)


def test_a_drift_wanders_slowly_with_the_spread_that_is_asked_for(make):
    """A Gauss-Markov process of time constant T: the correlation over T is 1/e."""
    spread, constant, rate = 0.05, 0.5, 100
    tags = f"<drift>{spread}</drift><driftFrequency>{1 / constant}</driftFrequency>"
    world = make.world(wall(make, 2.0), make.sdf(finder(tags, filename=SONAR, rate=rate)))
    told = messages(world, "/sonar", seconds=200.0)
    errors = np.array([message.range for message in told]) - 2.0
    # As good as 200 s / 2 T independent values, and five standard errors.
    free = 200.0 / (2 * constant)
    assert errors.std() == pytest.approx(spread, rel=5 / math.sqrt(2 * free))
    lag = int(constant * rate)
    correlation = np.mean(errors[lag:] * errors[:-lag]) / errors.var()
    assert correlation == pytest.approx(math.exp(-1), abs=5 / math.sqrt(free))
    # From one reading to the next it moves little.
    assert np.abs(np.diff(errors)).max() < spread


@pytest.mark.parametrize(
    "tags",
    [
        "<gaussianNoise>-1</gaussianNoise>",
        "<updateRate>-5</updateRate>",
        "<radiation>radio</radiation>",
        "<fov>wide</fov>",
    ],
)
def test_tags_that_make_no_sense_are_refused(make, tags):
    with pytest.raises(CartwheelError) as error:
        make.world(make.sdf(finder(tags)))
    assert error.value.origin is not None


def test_of_several_numbers_the_first_counts_where_one_is_wanted(make):
    world = make.world(make.sdf(finder("<topicName>front</topicName><fov>0.5 0.4 0.3</fov>")))
    assert messages(world)[0].field_of_view == 0.5
    (warning,) = [
        each for each in world.diagnostics if each.code is devices.PLUGIN_PARAMETER_NOT_SINGLE
    ]
    assert warning.values["value"] == "0.5"
