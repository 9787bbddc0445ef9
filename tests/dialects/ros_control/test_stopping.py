"""Transmissions of joints that do not exist in Gazebo, which stop its controller manager."""

import pytest
from tests.dialects.ros_control.arms import ROS1, beam, robot, transmission

from cartwheel.checks.checking import check
from cartwheel.codes.devices import INTERFACE_UNKNOWN, TRANSMISSION_JOINT_UNKNOWN
from cartwheel.codes.running import CONTROLLER_NOT_STARTED
from cartwheel.corpus import try_robot
from cartwheel.description import load_robot
from cartwheel.dialects.ros_control.interfaces import transmissions

TIP = (
    '<link name="tip"/><joint name="tip_joint" type="{kind}"><parent link="{parent}"/>'
    '<child link="tip"/></joint>'
)
PRESERVED = '<gazebo reference="tip_joint"><preserveFixedJoint>1</preserveFixedJoint></gazebo>'
DRIVEN = transmission("tip_joint", "Effort")
INTERFACE = DRIVEN[DRIVEN.index("<hardwareInterface>") : DRIVEN.index("</joint>")]
ACTUATOR = '<actuator name="m_tip_joint"/>'
BOTH = f'<actuator name="m_tip_joint">{INTERFACE}</actuator>'
LAUNCH = """<launch><include file="$(find gazebo_ros)/launch/empty_world.launch"/>
  <param name="robot_description" command="$(find xacro)/xacro '$(find arm)/robots/arm.urdf'"/>
  <node pkg="gazebo_ros" type="spawn_model" name="s"
    args="-urdf -param robot_description -model arm"/>
  <rosparam file="$(find arm)/config/arm.yaml"/>
  <node pkg="controller_manager" type="spawner" name="c" args="hold lost"/></launch>"""
YAML = """hold: {type: position_controllers/JointPositionController, joint: beam_joint}
lost: {type: lost/Controller, joint: beam_joint}
"""


def fixed(kind="fixed", parent="beam"):
    return TIP.format(kind=kind, parent=parent)


def arm(*parts, plugin=ROS1):
    body = beam("beam", "world") + transmission("beam_joint", "Position")
    return robot(body + "".join(parts), plugin)


@pytest.mark.parametrize(
    ("parts", "stops"),
    [
        ((fixed(), DRIVEN), True),
        ((DRIVEN,), True),
        ((fixed("floating"), DRIVEN), True),
        ((fixed(), PRESERVED, DRIVEN), False),
        ((fixed(parent="world"), DRIVEN), False),
        ((fixed(), DRIVEN.replace(INTERFACE, "")), False),
        ((fixed(), DRIVEN.replace(ACTUATOR, "")), False),
        ((fixed(), DRIVEN.replace(ACTUATOR, BOTH)), True),
    ],
    ids=["fixed", "absent", "floating", "kept", "world", "interface", "actuator", "both"],
)
def test_a_joint_that_gazebo_lacks_stops_the_manager_if_the_transmission_is_read(
    tmp_path, parts, stops
):
    path = tmp_path / "arm.urdf"
    path.write_text(arm(*parts))
    notes = transmissions(load_robot(path))[1]
    (note,) = [each for each in notes if each.code is TRANSMISSION_JOINT_UNKNOWN]
    assert note.values["stops"] is stops
    found = [each for each in check(path).findings if each.code is TRANSMISSION_JOINT_UNKNOWN]
    assert [each.values["stops"] for each in found] == [stops]


@pytest.mark.parametrize(
    ("name", "messages"),
    [
        ("hardware_interface/PositionJointInterface", 0),
        ("VelocityJointInterface", 0),
        ("hardware_interface/PosVelJointInterface", 1),
        ("JointStateInterface", 1),
        ("hardware_interface/PositonJointInterface", 1),
    ],
)
def test_an_interface_that_the_default_hardware_lacks_stops_the_manager(tmp_path, name, messages):
    path = tmp_path / "arm.urdf"
    lacking = transmission("beam_joint", "Position").replace(
        "hardware_interface/PositionJointInterface", name
    )
    path.write_text(robot(beam("beam", "world") + lacking, ROS1))
    description = load_robot(path)
    for found in (transmissions(description)[1], check(path).findings):
        stopping = [each for each in found if each.code is INTERFACE_UNKNOWN]
        assert [each.severity for each in stopping] == ["error"] * messages
        assert all(each.values["stops"] for each in stopping)
    assert not transmissions(description, several=True)[1] or "Positon" in name


@pytest.mark.parametrize("kind", ["other/RobotHWSim", "gazebo_ros_control/DefaultRobotHWSim"])
def test_another_hardware_decides_for_itself(tmp_path, kind):
    path = tmp_path / "arm.urdf"
    tag = f"<robotSimType>{kind}</robotSimType></plugin>"
    path.write_text(arm(fixed(), DRIVEN, plugin=ROS1.replace("</plugin>", tag)))
    found = [each for each in check(path).findings if each.code is TRANSMISSION_JOINT_UNKNOWN]
    assert [each.values["stops"] for each in found] == ["Default" in kind]


@pytest.mark.parametrize("kept", [False, True])
def test_the_stopped_manager_is_the_reason_why_no_controller_starts(tmp_path, kept):
    """What else is wrong with a controller does not matter."""
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "robots/arm.urdf": arm(fixed(), DRIVEN, PRESERVED * kept),
        "config/arm.yaml": YAML,
        "launch/sim.launch": LAUNCH,
    }
    for name, text in files.items():
        file = tmp_path / "arm" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    verdict = try_robot(tmp_path / "arm/robots/arm.urdf", standing=1.0)
    found = [(each.test, each.code) for each in verdict.faults]
    assert found == [("controller", CONTROLLER_NOT_STARTED if kept else TRANSMISSION_JOINT_UNKNOWN)]
    assert kept or verdict.outcome == "file"
