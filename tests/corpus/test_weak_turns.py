"""Wheels that have to slide in a turn, with gains too low for that."""

import pytest
from tests.corpus.carts import written

from cartwheel.codes.devices import CONTROLLER_GAIN_TOO_LOW
from cartwheel.codes.robot import SKID_STEERING
from cartwheel.corpus import try_robot

BASE = (
    '<link name="base">'
    '<inertial><mass value="20"/><inertia ixx="0.5" iyy="0.5" izz="0.5" ixy="0" ixz="0" iyz="0"/>'
    '</inertial><collision><geometry><box size="0.4 0.3 0.05"/></geometry></collision></link>'
)
WHEEL = (
    '<link name="{n}">'
    '<inertial><mass value="0.5"/><inertia ixx="1e-3" iyy="1e-3" izz="2e-3" ixy="0" '
    'ixz="0" iyz="0"/>'
    '</inertial><collision><geometry><cylinder radius="0.1" length="0.04"/></geometry></collision>'
    '</link><joint name="{n}_joint" type="continuous"><parent link="base"/><child link="{n}"/>'
    '<origin xyz="{x} {y} 0" rpy="-1.5708 0 0"/><axis xyz="0 0 1"/></joint>'
    '<transmission name="{n}"><type>transmission_interface/SimpleTransmission</type>'
    '<joint name="{n}_joint"><hardwareInterface>hardware_interface/VelocityJointInterface'
    '</hardwareInterface></joint><actuator name="m"/></transmission>'
)
MANAGER = '<gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo>'
CONTROLLER = """base:
  type: diff_drive_controller/DiffDriveController
  left_wheel: [fl_joint, rl_joint]
  right_wheel: [fr_joint, rr_joint]
  wheel_separation: 0.4
  wheel_radius: 0.1
gazebo_ros_control:
  pid_gains:
"""


@pytest.mark.parametrize(
    ("gain", "reason"), [(3.0, CONTROLLER_GAIN_TOO_LOW), (300.0, SKID_STEERING)]
)
def test_a_gain_too_low_for_wheels_to_slide_is_why_a_robot_turns_slowly(tmp_path, gain, reason):
    """mu N r is 5.4 N m, and the wheels are commanded 0.8 rad/s: 2.4 N m, or 240 N m."""
    places = {"fl": (0.2, 0.2), "rl": (-0.2, 0.2), "fr": (0.2, -0.2), "rr": (-0.2, -0.2)}
    wheels = "".join(WHEEL.format(n=name, x=x, y=y) for name, (x, y) in places.items())
    gains = "".join(f"    {name}_joint: {{p: {gain}, i: 0.0, d: 0.0}}\n" for name in places)
    (tmp_path / "base.yaml").write_text(CONTROLLER + gains)
    path = written(tmp_path, BASE, wheels, MANAGER)
    verdict = try_robot(path, standing=1.0, controllers=[tmp_path / "base.yaml"])
    (fault,) = [each for each in verdict.faults if each.test == "turn"]
    assert (fault.code, fault.source) == (reason, "file")
    if reason is CONTROLLER_GAIN_TOO_LOW:
        assert fault.reason.values["sliding"] == pytest.approx(9.8 * 22 / 4 * 0.1)


@pytest.mark.parametrize(("slip", "source"), [(0.01, "unknown"), (1e-7, "file")])
def test_how_wheels_with_slip_slide_is_unknown(tmp_path, slip, source):
    """Gazebo's wheels with slip may roll, although others with the same friction slide."""
    places = {"fl": (0.2, 0.2), "rl": (-0.2, 0.2), "fr": (0.2, -0.2), "rr": (-0.2, -0.2)}
    parts = []
    for name, (x, y) in places.items():
        parts.append(
            f'<link name="{name}"><pose>{x} {y} 0.1 -1.5708 0 0</pose><inertial><mass>0.5</mass>'
            "<inertia><ixx>1e-3</ixx><iyy>1e-3</iyy><izz>2e-3</izz></inertia></inertial>"
            '<collision name="c"><geometry><cylinder><radius>0.1</radius><length>0.04</length>'
            f"</cylinder></geometry><surface><friction><ode><slip1>{slip}</slip1></ode></friction>"
            f'</surface></collision></link><joint name="{name}_joint" type="revolute"><parent>base'
            f"</parent><child>{name}</child><axis><xyz>0 0 1</xyz></axis></joint>"
        )
    path = tmp_path / "model.sdf"
    path.write_text(
        '<sdf version="1.9"><model name="robot"><link name="base"><pose>0 0 0.1 0 0 0</pose>'
        "<inertial><mass>20</mass><inertia><ixx>0.5</ixx><iyy>0.5</iyy><izz>0.5</izz></inertia>"
        f'</inertial></link>{"".join(parts)}<plugin filename="gz-sim-diff-drive-system" '
        'name="gz::sim::systems::DiffDrive"><left_joint>fl_joint</left_joint><left_joint>rl_joint'
        "</left_joint><right_joint>fr_joint</right_joint><right_joint>rr_joint</right_joint>"
        "<wheel_separation>0.4</wheel_separation><wheel_radius>0.1</wheel_radius><topic>cmd_vel"
        "</topic></plugin></model></sdf>"
    )
    verdict = try_robot(path, standing=1.0)
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("turn", SKID_STEERING, source)
    assert (fault.reason.values.get("slip") is True) == (source == "unknown")
