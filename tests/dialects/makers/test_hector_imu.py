"""hector's IMU: its drift follows its own statistics."""

import math

import numpy as np
import pytest
from tests.devices.position.bodies import floating, unit, vector

from cartwheel.codes import devices
from cartwheel.errors import PluginError
from cartwheel.geometry import Pose, quat_from_rpy
from cartwheel.messages import message_class

G = 9.8


def hector(tags, rate=100):
    return unit(
        f"""<plugin name="i" filename="libhector_gazebo_ros_imu.so"><topicName>imu</topicName>
        <updateRate>{rate}</updateRate>{tags}</plugin>"""
    )


def test_hector_imu_reads_truth_when_it_has_no_errors(make, read):
    world = make.world(ground=None)
    turned = quat_from_rpy(0.1, 0.2, 0.7)
    world.session.spawn(make.sdf(hector("")), pose=Pose((0, 0, 100), turned))
    world.session.simulation.data.joint("unit::link").qvel[3:] = [0.0, 0.0, 0.5]
    message = read(world, "/imu", 0.1)[0]
    assert vector(message.linear_acceleration) == pytest.approx([0, 0, 0], abs=1e-6)
    assert vector(message.angular_velocity) == pytest.approx([0, 0, 0.5], abs=1e-6)
    reported = message.orientation
    assert (reported.x, reported.y, reported.z, reported.w) == pytest.approx(turned, abs=1e-9)


def test_hector_imus_noise_and_scale_are_as_stated(make, read):
    tags = """<rateGaussianNoise>0.1 0.2 0.3</rateGaussianNoise><accelOffset>1 2 3</accelOffset>
      <rateScaleError>2 2 2</rateScaleError>"""
    world = floating(make, hector(tags))
    world.session.simulation.data.joint("unit::link").qvel[5] = 0.5
    messages = read(world, "/imu", 20.0)
    rates = np.array([vector(m.angular_velocity) for m in messages])
    count = len(rates)
    assert rates.std(axis=0) == pytest.approx([0.1, 0.2, 0.3], rel=4 / math.sqrt(2 * count))
    assert rates.mean(axis=0) == pytest.approx([0, 0, 1.0], abs=4 * 0.3 / math.sqrt(count))
    accelerations = np.array([vector(m.linear_acceleration) for m in messages])
    assert accelerations == pytest.approx(np.tile([1.0, 2.0, 3.0], (count, 1)), abs=1e-6)
    assert np.diag(messages[0].angular_velocity_covariance.reshape(3, 3)) == pytest.approx(
        [0.01, 0.04, 0.09]
    )


def drift(make, read, seed, *, seconds=200.0, late=0.0, frequency=1.0):
    tags = f"""<rateDrift>0.1 0.1 0.1</rateDrift>
      <rateDriftFrequency>{frequency} {frequency} {frequency}</rateDriftFrequency>"""
    world = floating(make, hector(tags, rate=10), seed=seed)
    world.run(late)
    return np.array([vector(m.angular_velocity) for m in read(world, "/imu", seconds)])


def test_the_drift_is_a_gauss_markov_process(make, read):
    """Its standard deviation is that stated, and it forgets by e^(-f t)."""
    values = drift(make, read, 3, seconds=400.0)
    # Two time constants make about one independent sample.
    independent = 3 * 400.0 / 2
    assert values.std() == pytest.approx(0.1, rel=4 / math.sqrt(2 * independent))
    for lag in (1, 5, 10):
        correlation = np.mean(values[:-lag] * values[lag:]) / np.mean(values**2)
        assert correlation == pytest.approx(math.exp(-0.1 * lag), abs=0.15)


def test_the_drift_does_not_depend_on_who_listens_since_when(make, read):
    early = drift(make, read, 5, seconds=20.0)
    again = drift(make, read, 5, seconds=20.0)
    late = drift(make, read, 5, seconds=10.0, late=10.0)
    other = drift(make, read, 6, seconds=20.0)
    assert np.array_equal(early, again)
    assert np.array_equal(early[100:], late)
    assert not np.array_equal(early, other)


def test_calibration_takes_the_rates_drift_away_and_a_bias_can_be_set(make, read):
    tags = "<rateDrift>0.5 0.5 0.5</rateDrift><accelDrift>0.5 0.5 0.5</accelDrift>"
    world = floating(make, hector(tags))
    before = read(world, "/imu", 0.05)[-1]
    assert np.abs(vector(before.angular_velocity)).max() > 1e-3
    world.graph.service("/imu/calibrate").handler(None)
    after = read(world, "/imu", 0.05)[0]
    # It begins to wander again at once: by 0.5 √(2 dt / 3600 s) a period.
    assert np.abs(vector(after.angular_velocity)).max() < 0.01
    request = message_class("hector_gazebo_plugins/srv/SetBias_Request")
    three = message_class("geometry_msgs/msg/Vector3")
    world.graph.service("/imu/set_accel_bias").handler(request(bias=three(1.0, 2.0, 3.0)))
    biased = read(world, "/imu", 0.05)[0]
    assert vector(biased.linear_acceleration) == pytest.approx([1, 2, 3], abs=0.02)
    bias = read(world, "/imu/bias", 0.05)[0]
    assert vector(bias.linear_acceleration) == pytest.approx([1, 2, 3], abs=0.02)


def test_a_yaw_error_turns_the_orientation_about_the_vertical(make, read):
    world = floating(make, hector("<yawOffset>0.3</yawOffset>"), Pose((0, 0, 0)))
    reported = read(world, "/imu", 0.05)[0].orientation
    assert (reported.x, reported.y, reported.z, reported.w) == pytest.approx(
        quat_from_rpy(0, 0, 0.3), abs=1e-9
    )


def test_an_accelerometers_offset_tilts_what_it_takes_for_up(make, read):
    """Off by b along x it takes a direction b/g off for up: the pitch is wrong by b/g."""
    world = make.world(ground=None)
    world.session.spawn(make.sdf(hector("<accelOffset>0.098 0 0</accelOffset>")))
    reported = read(world, "/imu", 0.05)[0].orientation
    assert abs(2 * reported.y) == pytest.approx(0.098 / G, rel=1e-3)
    assert abs(reported.x) < 1e-9


@pytest.mark.parametrize(
    ("model", "parameter"),
    [
        (hector("<rateDrift>-1 0 0</rateDrift>"), "rateDrift"),
        (hector("<rateDrift>0.1</rateDrift>"), "rateDrift"),
        (unit('<plugin name="g" filename="libhector_gazebo_ros_gps.so"><drift>-1 0 0</drift>'
              "</plugin>"), "drift"),
    ],
)  # fmt: skip
def test_errors_without_sense_name_their_line(make, model, parameter):
    with pytest.raises(PluginError) as caught:
        floating(make, model)
    assert caught.value.code is devices.PLUGIN_PARAMETER_INVALID
    assert caught.value.values["parameter"] == parameter
    assert caught.value.origin is not None
