"""Derivative gains of controllers of positions that command velocities."""

import pytest
import yaml
from tests.dialects.ros_control.arms import (
    ROS1,
    beam,
    robot,
    ros2_joint,
    ros2_parameters,
    ros2_plugin,
    ros2_system,
    transmission,
)

from cartwheel.checks.checking import check
from cartwheel.codes.devices import DERIVATIVE_GAIN_TOO_HIGH
from cartwheel.corpus import try_robot

LIMIT = 'lower="-3" upper="3" effort="1000" velocity="20"'
TRAJECTORY = "joint_trajectory_controller/JointTrajectoryController"


def ros1(folder, kind, **parameters):
    path, file = folder / "arm.urdf", folder / "move.yaml"
    body = beam("beam", "world", axis="0 0 1", limit=LIMIT)
    path.write_text(robot(body + transmission("beam_joint", "Velocity"), ROS1))
    file.write_text(
        yaml.safe_dump({"move": {"type": f"velocity_controllers/{kind}", **parameters}})
    )
    return path, (file,)


def ros2(folder, interfaces, d, **more):
    path, file = folder / "arm.urdf", folder / "move.yaml"
    system = ros2_system(ros2_joint("beam_joint", *interfaces))
    body = beam("beam", "world", axis="0 0 1", limit=LIMIT)
    path.write_text(robot(body + system, ros2_plugin(file)))
    move = {
        "type": TRAJECTORY,
        "joints": ["beam_joint"],
        "command_interfaces": interfaces,
        "state_interfaces": ["position", "velocity"],
        "gains": {"beam_joint": {"p": 10.0, "d": d}},
        **more,
    }
    file.write_text(yaml.safe_dump(ros2_parameters(move=move)))
    return path, ()


def reported(path, files):
    findings = check(path, controller_files=files).findings
    return [each.values["joint"] for each in findings if each.code is DERIVATIVE_GAIN_TOO_HIGH]


def of_ros1(folder, d, *, trajectory=False):
    gains = {"p": 10.0, "i": 0.0, "d": d}
    if trajectory:
        given = {"joints": ["beam_joint"], "gains": {"beam_joint": gains}}
        return ros1(folder, "JointTrajectoryController", **given)
    return ros1(folder, "JointPositionController", joint="beam_joint", pid=gains)


@pytest.mark.parametrize("d", [0.9, 5.0])
@pytest.mark.parametrize("kind", ["position", "trajectory", "ros2"])
def test_a_joint_oscillates_with_the_reported_gains_only(tmp_path, kind, d):
    if kind == "ros2":
        path, files = ros2(tmp_path, ["velocity"], d)
    else:
        path, files = of_ros1(tmp_path, d, trajectory=kind == "trajectory")
    assert reported(path, files) == ["beam_joint"] * (d > 1)
    verdict = try_robot(path, standing=1.0, controllers=files or None)
    (reach,) = verdict.reaches
    assert reach.arrived == (d < 1)
    assert [each.code for each in verdict.faults] == [DERIVATIVE_GAIN_TOO_HIGH] * (d > 1)


@pytest.mark.parametrize("d", [0.0, 0.5, 0.94, 1.0, 1.5, 20.0])
def test_what_is_reported_oscillates_with_an_ideal_motor(tmp_path, d):
    """The joint has the commanded velocity from one update to the next; 1 - p h / 2 is 0.95."""
    p, h = 10.0, 0.01
    x, v = 1.0, 0.0
    for _ in range(4000):
        v = -p * x - d * v
        x = min(max(x + h * v, -1e6), 1e6)
    assert reported(*ros2(tmp_path, ["velocity"], d)) == ["beam_joint"] * (abs(v) > 1.0)


def test_a_gain_that_has_no_effect_on_a_velocity_is_not_reported(tmp_path):
    assert reported(*ros2(tmp_path, ["position", "velocity"], 5.0)) == []
    assert reported(*ros2(tmp_path, ["effort"], 5.0)) == []
    assert reported(*ros2(tmp_path, ["velocity"], 5.0, open_loop_control=True)) == []
    assert reported(*ros2(tmp_path, ["velocity"], 1.0)) == ["beam_joint"]
    assert reported(*ros2(tmp_path, ["velocity"], -5.0)) == []
