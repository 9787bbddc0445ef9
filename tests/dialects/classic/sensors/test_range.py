"""Range finders: the nearest of their rays."""

import math

import numpy as np
import pytest
from tests.devices.rays.range_finders import finder, messages, wall

from cartwheel.codes import devices
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Pose
from cartwheel.messages.singles import single


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
    assert (message.min_range, message.max_range) == (single(0.05), 4.0)


def test_what_is_not_said_is_as_in_gazebo(make):
    message = messages(make.world(make.sdf(finder(""))), "/range")[0]
    assert message.radiation_type == message.ULTRASOUND
    assert message.field_of_view == single(0.05)
    assert message.header.frame_id == "nose"


def test_nothing_reads_as_the_maximum_and_the_too_near_as_the_minimum(make):
    assert messages(make.world(make.sdf(finder())))[0].range == 4.0
    near = make.world(wall(make, 0.2), make.sdf(finder(least=0.3)))
    assert messages(near)[0].range == pytest.approx(0.3)


@pytest.mark.parametrize(("asked", "reported"), [("", 20), ("8", 8), ("100", 20)])
def test_the_slower_of_the_two_rates_counts(make, asked, reported):
    tags = "<topicName>front</topicName>" + (f"<updateRate>{asked}</updateRate>" if asked else "")
    assert len(messages(make.world(make.sdf(finder(tags))), seconds=2.0)) == 2 * reported + 1


@pytest.mark.parametrize(
    ("tags", "rays"),
    [
        ("<gaussianNoise>0.02</gaussianNoise>", ""),
        ("", "<noise><type>gaussian</type><mean>0</mean><stddev>0.02</stddev></noise>"),
    ],
)
def test_noise_is_of_the_range_not_of_the_rays(make, tags, rays):
    text = finder("<topicName>front</topicName>" + tags, rate=200, noise=rays)
    reported = messages(make.world(wall(make, 2.0), make.sdf(text)), seconds=5.0)
    readings = np.array([message.range for message in reported])
    count = len(readings)
    assert count == 1001
    # The least of 25 noisy rays would be 2 standard deviations short.
    assert readings.mean() == pytest.approx(2.0, abs=5 * 0.02 / math.sqrt(count))
    assert readings.std() == pytest.approx(0.02, rel=5 / math.sqrt(2 * count))


def test_noise_stays_within_the_limits(make):
    text = finder("<topicName>front</topicName><gaussianNoise>1</gaussianNoise>", rate=100)
    reported = messages(make.world(wall(make, 2.0), make.sdf(text)), seconds=2.0)
    readings = [message.range for message in reported]
    assert min(readings) >= 0.05
    assert max(readings) == 4.0


@pytest.mark.parametrize(
    "tags",
    [
        "<gaussianNoise>-1</gaussianNoise>",
        "<updateRate>-5</updateRate>",
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
