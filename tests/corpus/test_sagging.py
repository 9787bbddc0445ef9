"""Legs that give way although controllers hold them, and those that start bent."""

import pytest
from tests.dialects.ros_control.arms import ROS1, ros2_joint, ros2_plugin, ros2_system, transmission

from cartwheel.codes.devices import (
    CONTROLLER_GAIN_TOO_LOW,
    DERIVATIVE_GAIN_TOO_HIGH,
    EFFORT_LIMIT_TOO_LOW,
    PLUGIN_UNKNOWN,
)
from cartwheel.codes.robot import JOINTS_UNDRIVEN
from cartwheel.corpus import try_robot

CORNERS = {"fl": (1, 1), "fr": (1, -1), "rl": (-1, 1), "rr": (-1, -1)}
JOINTS = [f"{name}_{part}" for name in CORNERS for part in ("hip", "knee")]
BODY = (
    '<link name="{name}"><inertial><origin xyz="{at}"/><mass value="{mass}"/>'
    '<inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial><collision>'
    '<origin xyz="{at}"/><geometry><box size="{size}"/></geometry></collision></link>'
)
JOINT = (
    '<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
    '<origin xyz="{at}" rpy="0 {pitch} 0"/><axis xyz="0 1 0"/>'
    '<limit lower="-2" upper="2" effort="{effort}" velocity="10"/><dynamics damping="1"/></joint>'
)


def quadruped(rest, *, bend=0.0, effort=200.0, mass=10.0):
    """Four legs of two beams of 0.3 m, bent by `bend` at the hip and by twice that at the knee."""
    parts = [BODY.format(name="body", at="0 0 0", mass=mass, i=0.3, size="0.8 0.5 0.1")]
    for name, (x, y) in CORNERS.items():
        for part, at, size in (
            ("thigh", "0 0 -0.15", "0.03 0.03 0.28"),
            ("shin", "0 0 -0.15", "0.1 0.05 0.3"),
        ):
            parts.append(BODY.format(name=f"{name}_{part}", at=at, mass=0.3, i=0.003, size=size))
        hip = {"name": f"{name}_hip", "parent": "body", "child": f"{name}_thigh", "effort": effort}
        knee = {"name": f"{name}_knee", "parent": f"{name}_thigh", "child": f"{name}_shin"}
        parts.append(JOINT.format(**hip, at=f"{0.3 * x} {0.2 * y} -0.05", pitch=bend))
        parts.append(JOINT.format(**knee, at="0 0 -0.3", pitch=-2 * bend, effort=effort))
    return f'<robot name="dog">{"".join(parts)}{rest}</robot>'


def tried(tmp_path, text, controllers=""):
    path, files = tmp_path / "dog.urdf", tmp_path / "hold.yaml"
    path.write_text(text)
    files.write_text(controllers)
    given = (files,) if controllers and files.name not in text else ()
    return try_robot(path, standing=4.0, controllers=given)


def ros1(kind, *, p, d):
    """The controllers of all joints, and what the description needs for them."""
    lines = (
        f"hold_{name}:\n  type: {kind}_controllers/JointPositionController\n  joint: {name}\n"
        f"  pid: {{p: {p}, i: 0.0, d: {d}}}\n"
        for name in JOINTS
    )
    hardware = "Effort" if kind == "effort" else "Velocity"
    transmissions = "".join(transmission(name, hardware) for name in JOINTS)
    return f"<gazebo>{ROS1}</gazebo>{transmissions}", "".join(lines)


@pytest.mark.parametrize(("p", "stands"), [(12.0, False), (2000.0, True)])
def test_gains_that_let_legs_give_way_are_the_reason_why_a_robot_sinks(tmp_path, p, stands):
    rest, controllers = ros1("effort", p=p, d=5.0)
    verdict = tried(tmp_path, quadruped(rest, bend=0.5), controllers)
    assert (verdict.stand.state == "yes") == stands
    found = [each.reason.code for each in verdict.faults if each.test == "stand"]
    assert found == ([] if stands else [CONTROLLER_GAIN_TOO_LOW])
    if not stands:
        (reason,) = (each.reason for each in verdict.faults if each.test == "stand")
        assert reason.values["sagged"] > 0.05


@pytest.mark.parametrize(
    ("plugin", "code"),
    [("libmy_own_gait.so", PLUGIN_UNKNOWN), ("libmy_own_sensor.so", JOINTS_UNDRIVEN)],
)
def test_an_unsupported_plugin_may_hold_joints_that_give_way(tmp_path, plugin, code):
    rest = f'<gazebo><plugin name="own" filename="{plugin}"/></gazebo>'
    verdict = tried(tmp_path, quadruped(rest, bend=0.5))
    (fault,) = (each for each in verdict.faults if each.test == "stand")
    assert fault.code is code
    assert fault.source == ("unknown" if code is PLUGIN_UNKNOWN else "file")


ROS2 = """controller_manager:
  ros__parameters:
    hold: {type: position_controllers/JointGroupPositionController}
hold:
  ros__parameters:
    joints: [%s]
"""


def started(angle, *, effort=200.0):
    """A robot whose ros2_control bends its legs at the start."""
    joints = []
    for name in JOINTS:
        value = angle if name.endswith("hip") else -2 * angle
        joint = ros2_joint(name).replace(
            '<state_interface name="position"/>',
            '<state_interface name="position">'
            f'<param name="initial_value">{value}</param></state_interface>',
        )
        joints.append(joint)
    plugin = f"<gazebo>{ros2_plugin('hold.yaml')}</gazebo>"
    return quadruped(ros2_system(*joints) + plugin, effort=effort)


def test_a_robot_that_ros2_control_bends_at_the_start_stands(tmp_path):
    verdict = tried(tmp_path, started(0.6), ROS2 % ", ".join(JOINTS))
    assert verdict.stand.sunk > 0.05
    assert verdict.stand.state == "yes"
    assert verdict.good, verdict.faults


def test_effort_limits_that_do_not_hold_the_weight_are_the_reason_why_a_robot_sinks(tmp_path):
    verdict = tried(tmp_path, started(0.6, effort=2.0), ROS2 % ", ".join(JOINTS))
    assert verdict.stand.state in ("sinks", "tips")
    (reason,) = (each.reason for each in verdict.faults if each.test == "stand")
    assert reason.code is EFFORT_LIMIT_TOO_LOW
    assert reason.values["sagged"] > 0.05


def test_a_derivative_gain_of_a_velocity_is_the_reason_why_a_robot_does_not_stand_still(tmp_path):
    rest, controllers = ros1("velocity", p=100.0, d=10.0)
    verdict = tried(tmp_path, quadruped(rest, bend=0.3), controllers)
    assert verdict.stand.state == "moves"
    (reason,) = (each.reason for each in verdict.faults if each.test == "stand")
    assert reason.code is DERIVATIVE_GAIN_TOO_HIGH
