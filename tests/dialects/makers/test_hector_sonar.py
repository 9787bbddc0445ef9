"""hector's sonar: an offset, and a drift that changes slowly."""

import math

import numpy as np
import pytest
from tests.devices.rays.range_finders import finder, messages, wall

SONAR = "libhector_gazebo_ros_sonar.so"


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
    reported = messages(world, "/sonar", seconds=200.0)
    errors = np.array([message.range for message in reported]) - 2.0
    # As good as 200 s / 2 T independent values, and five standard errors.
    free = 200.0 / (2 * constant)
    assert errors.std() == pytest.approx(spread, rel=5 / math.sqrt(2 * free))
    lag = int(constant * rate)
    correlation = np.mean(errors[lag:] * errors[:-lag]) / errors.var()
    assert correlation == pytest.approx(math.exp(-1), abs=5 / math.sqrt(free))
    # From one reading to the next it moves little.
    assert np.abs(np.diff(errors)).max() < spread
