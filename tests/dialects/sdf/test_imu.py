"""The noise of imu sensors."""

import math

import numpy as np
import pytest
from tests.devices.position.bodies import floating, unit, vector

from cartwheel.codes import devices, running

IMU_NOISE = """<imu><angular_velocity><z><noise type="gaussian"><mean>0</mean>
  <stddev>0.05</stddev></noise></z></angular_velocity><linear_acceleration><x>
  <noise type="gaussian"><mean>0</mean><stddev>0.2</stddev><bias_mean>1.0</bias_mean>
  <bias_stddev>0.0</bias_stddev></noise></x></linear_acceleration></imu>"""


@pytest.mark.parametrize(
    ("plugin", "topic"),
    [
        ('<plugin name="p" filename="libgazebo_ros_imu_sensor.so"><ros><remapping>~/out:=data'
         "</remapping></ros></plugin>", "/data"),
        ('<plugin name="p" filename="libgazebo_ros_imu_sensor.so"><ros/></plugin>', "/p/out"),
        ("<topic>imu</topic>", "/imu"),
    ],
)  # fmt: skip
def test_an_imu_sensors_noise_is_its_own_by_axis(make, read, plugin, topic):
    sensor = f"""<sensor name="s" type="imu"><update_rate>100</update_rate>{IMU_NOISE}{plugin}
      </sensor>"""
    world = floating(make, unit(sensor=sensor))
    messages = read(world, topic, 20.0)
    count = len(messages)
    assert count == 2001
    rates = np.array([vector(m.angular_velocity) for m in messages])
    accelerations = np.array([vector(m.linear_acceleration) for m in messages])
    tolerance = 4 / math.sqrt(2 * count)
    assert rates[:, 2].std() == pytest.approx(0.05, rel=tolerance)
    assert not rates[:, :2].any()
    assert accelerations[:, 0].std() == pytest.approx(0.2, rel=tolerance)
    # A bias has either sign.
    assert abs(accelerations[:, 0].mean()) == pytest.approx(1.0, abs=4 * 0.2 / math.sqrt(count))
    assert messages[0].angular_velocity_covariance[8] == pytest.approx(0.05**2)
    assert messages[0].linear_acceleration_covariance[0] == pytest.approx(0.2**2)


def test_a_sensor_of_invalid_noise_is_left_out(make):
    model = unit(
        sensor='<sensor name="s" type="imu"><topic>t</topic><imu><angular_velocity><x>'
        '<noise type="gaussian"><stddev>-1</stddev></noise></x></angular_velocity></imu></sensor>'
    )
    world = floating(make, model)
    (reported,) = [each for each in world.diagnostics if each.severity == "error"]
    assert reported.code is running.PLUGIN_LEFT_OUT
    assert reported.values["plugin"] == "s"
    assert reported.values["cause"] == devices.PLUGIN_PARAMETER_INVALID.number
