"""hector's barometer: heights, and pressures by its formula."""

import numpy as np
import pytest

from cartwheel.errors import PluginError


def drone(make, tags=""):
    return make.sdf(f"""<model name="drone"><pose>0 0 120 0 0 0</pose><link name="link">
      <inertial><mass>1</mass></inertial></link>
      <joint name="bolt" type="fixed"><parent>world</parent><child>link</child></joint>
      <plugin name="b" filename="libhector_gazebo_ros_baro.so"><updateRate>10</updateRate>{tags}
      </plugin></model>""")


def test_it_publishes_its_height_and_the_pressure_at_its_altitude(make, read):
    world = make.world(drone(make, "<elevation>400</elevation><qnh>1000</qnh>"))
    heights = world.mailbox("/pressure_height")
    reported = read(world, "/altimeter", 1.0)
    assert len(reported) == 11
    assert [message.point.z for message in heights.drain()] == [120.0] * 11
    assert reported[-1].altitude == 520
    assert reported[-1].qnh == 1000
    assert reported[-1].pressure == pytest.approx(1000 * (1 - 520 / 44330) ** 5.263157)
    assert reported[-1].header.frame_id == "link"
    # The standard atmosphere has a little less at 520 m, 939.7 hPa where the sea has 1000.
    assert reported[-1].pressure == pytest.approx(939.7, abs=0.3)


def test_its_errors_are_of_the_height(make, read):
    tags = "<offset>2</offset><gaussianNoise>0.5</gaussianNoise><scaleError>1.1</scaleError>"
    world = make.world(drone(make, tags + "<frameId>air</frameId>"))
    reported = read(world, "/pressure_height", 60.0)
    heights = np.array([message.point.z for message in reported])
    # The mean of n is known to sigma / sqrt(n), four of which it stays within.
    assert heights.mean() == pytest.approx(120 * 1.1 + 2, abs=4 * 0.5 / np.sqrt(len(reported)))
    assert heights.std() == pytest.approx(0.5, rel=0.15)
    assert reported[0].header.frame_id == "air"


def test_an_empty_topic_is_none(make):
    world = make.world(drone(make, "<topicName></topicName>"))
    names = {topic.name for topic in world.graph.topics()}
    assert "/altimeter" in names
    assert "/pressure_height" not in names


def test_a_noise_below_zero_is_refused(make):
    with pytest.raises(PluginError) as caught:
        make.world().session.spawn(drone(make, "<gaussianNoise>-1</gaussianNoise>"))
    assert caught.value.values["parameter"] == "gaussianNoise"
