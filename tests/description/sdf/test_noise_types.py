"""Types of noise that do not exist, with which Gazebo has no robot."""

import pytest
from tests.corpus.carts import cart, controlled, written

from cartwheel.codes.devices import NOISE_TYPE_UNKNOWN
from cartwheel.corpus import try_robot
from cartwheel.description import load_text

WHITE = "<noise type='white'/>"
CLASSIC = "libgazebo_ros_imu_sensor.so"


def sensor(kind, noise, plugin=""):
    inside = {
        "imu": f"<imu><angular_velocity><x>{noise}</x><y>{noise}</y></angular_velocity></imu>",
        "camera": f"<camera>{noise}</camera>",
        "gpu_lidar": f"<lidar>{noise}</lidar>",
        "ray": f"<ray>{noise}</ray>",
    }[kind]
    tag = f'<plugin name="p" filename="{plugin}"/>' if plugin else ""
    return f'<sensor name="s" type="{kind}">{inside}{tag}</sensor>'


def found(kind, noise, plugin="", *, sdf=False):
    tags = sensor(kind, noise, plugin)
    text = f'<robot name="r"><link name="l"/><gazebo reference="l">{tags}</gazebo></robot>'
    if sdf:
        text = f'<sdf version="1.7"><model name="r"><link name="l">{tags}</link></model></sdf>'
    return [each for each in load_text(text).diagnostics if each.code is NOISE_TYPE_UNKNOWN]


@pytest.mark.wording
@pytest.mark.parametrize(
    ("kind", "plugin", "severity", "effect"),
    [
        ("imu", "", "error", "gz-sim does not spawn the model"),
        ("camera", "", "error", "gz-sim does not spawn the model"),
        ("gpu_lidar", "", "warning", "the sensor has no noise"),
        ("imu", CLASSIC, "error", "Gazebo Classic crashes when the sensor measures"),
        ("ray", CLASSIC, "error", "Gazebo Classic crashes when the sensor measures"),
    ],
)
@pytest.mark.parametrize(
    "noise", ['<noise type="gausian"/>', "<noise><type>gausian</type></noise>"]
)
def test_an_unknown_type_is_reported_once(kind, plugin, severity, effect, noise):
    (each,) = found(kind, noise, plugin)
    assert [one.message for one in found(kind, noise, plugin, sdf=True)] == [each.message]
    assert (each.severity, each.values["meant"]) == (severity, "gaussian")
    assert each.message == f'noise of the type "gausian" does not exist, so {effect}'


@pytest.mark.parametrize(
    ("noise", "plugin", "known"),
    [
        ("none", "", True),
        ("gaussian_quantized", "", True),
        ("", "", True),
        ("Gaussian", "", True),
        ("Gaussian", CLASSIC, False),
        ("custom", "", False),
        ("custom", CLASSIC, True),
    ],
)
def test_the_simulators_know_different_types(noise, plugin, known):
    assert (not found("imu", f'<noise type="{noise}"/>', plugin)) == known


def test_a_robot_with_an_unknown_noise_is_not_loaded(tmp_path):
    """Its controllers run here, so that other faults are found as well."""
    tags = f'<gazebo reference="base">{sensor("imu", WHITE)}</gazebo>'
    verdict = try_robot(written(tmp_path, cart(), controlled(tmp_path), tags), standing=1.0)
    assert [(each.test, each.code, each.source) for each in verdict.faults] == [
        ("load", NOISE_TYPE_UNKNOWN, "file")
    ]
    assert [each.topic for each in verdict.drives] == ["/base/cmd_vel"]


def test_an_invalid_sensor_does_not_stop_the_controllers(tmp_path):
    noise = "<noise type='gaussian'><stddev>-1</stddev></noise>"
    tags = f'<gazebo reference="base">{sensor("imu", noise)}</gazebo>'
    verdict = try_robot(written(tmp_path, cart(), controlled(tmp_path), tags), standing=1.0)
    assert [each.topic for each in verdict.drives] == ["/base/cmd_vel"]
