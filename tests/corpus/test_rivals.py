"""Joints that two plugins drive, as the reason why a robot does not follow its commands."""

import pytest
from tests.corpus.carts import cart, controlled, plugin, written
from tests.corpus.test_other_ros import CONTROL, CONTROLLER

from cartwheel.checks.checking import check
from cartwheel.codes.robot import WHEEL_AXIS_MISALIGNED, WHEEL_SEPARATION_MISMATCH
from cartwheel.codes.running import JOINT_DRIVEN_TWICE
from cartwheel.corpus import try_robot
from cartwheel.corpus.rivals import _variants
from cartwheel.description import load_robot

TRANSMISSION = (
    '<transmission name="{name}"><type>transmission_interface/SimpleTransmission</type>'
    '<joint name="{name}_joint"><hardwareInterface>hardware_interface/{kind}JointInterface'
    '</hardwareInterface></joint><actuator name="m"/></transmission>'
)
MANAGER = '<gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo>'


def managed(kind: str) -> str:
    """ROS 1's controller manager with both wheels, which no controller commands."""
    wheels = (TRANSMISSION.format(name=name, kind=kind) for name in ("left", "right"))
    return "".join(wheels) + MANAGER


def reasons(verdict):
    """The first reason of each test: a wrong size may be told besides."""
    return {each.test: each.code for each in reversed(verdict.faults)}


@pytest.mark.parametrize(
    ("separation", "turn"), [(0.2, JOINT_DRIVEN_TWICE), (0.5, JOINT_DRIVEN_TWICE)]
)
def test_hardware_that_holds_the_wheels_of_a_drive_is_why_it_is_slow(tmp_path, separation, turn):
    verdict = try_robot(
        written(tmp_path, cart(), plugin(separation), managed("Velocity")), standing=1.0
    )
    assert reasons(verdict) == {"drive": JOINT_DRIVEN_TWICE, "turn": turn}
    assert verdict.outcome == "file"


def test_hardware_that_holds_the_wheels_is_the_reason_although_their_size_is_wrong_too(tmp_path):
    """Without the hardware, the base drives at a tenth of the commanded speed."""
    path = written(tmp_path, cart(), plugin(), managed("Velocity"))
    size = "<wheelDiameter>0.1</wheelDiameter>"
    assert size in path.read_text()
    path.write_text(path.read_text().replace(size, "<wheelDiameter>1.0</wheelDiameter>"))
    verdict = try_robot(path, standing=1.0)
    assert reasons(verdict) == {"drive": JOINT_DRIVEN_TWICE, "turn": JOINT_DRIVEN_TWICE}


def test_hardware_without_controllers_does_not_hide_another_reason(tmp_path):
    reversed_wheel = cart().replace('<axis xyz="0 0 1"/>', '<axis xyz="0 0 -1"/>', 1)
    path = written(tmp_path, reversed_wheel, plugin(), managed("Velocity"))
    verdict = try_robot(path, standing=1.0)
    assert JOINT_DRIVEN_TWICE in {each.code for each in verdict.diagnostics}
    assert set(reasons(verdict).values()) == {WHEEL_AXIS_MISALIGNED}


@pytest.mark.parametrize("separation", [0.2, 0.5])
def test_effort_hardware_that_no_controller_commands_changes_nothing(tmp_path, separation):
    path = written(tmp_path, cart(), plugin(separation), managed("Effort"))
    verdict = try_robot(path, standing=1.0)
    assert JOINT_DRIVEN_TWICE not in {each.code for each in verdict.diagnostics}
    right = separation == 0.2
    assert reasons(verdict) == ({} if right else {"turn": WHEEL_SEPARATION_MISMATCH})


def test_a_controller_of_the_wheels_of_a_drive_is_why_it_is_slow(tmp_path):
    verdict = try_robot(written(tmp_path, cart(), plugin(), controlled(tmp_path)), standing=1.0)
    assert [(each.subject, each.code) for each in verdict.faults] == [
        ("/cmd_vel", JOINT_DRIVEN_TWICE)
    ] * 2


def test_a_controller_of_ros_1_is_why_a_drive_is_slow(tmp_path):
    """The file is not named by the manager, without which the robot is tested again."""
    file = tmp_path / "base.yaml"
    file.write_text(
        "base: {type: diff_drive_controller/DiffDriveController, left_wheel: left_joint,"
        " right_wheel: right_joint, wheel_separation: 0.2, wheel_radius: 0.05}\n"
    )
    path = written(tmp_path, cart(), plugin(), managed("Velocity"))
    verdict = try_robot(path, standing=1.0, controllers=[file])
    assert [(each.subject, each.code) for each in verdict.faults] == [
        ("/cmd_vel", JOINT_DRIVEN_TWICE)
    ] * 2


def test_a_wrong_size_explains_the_turn_rate_of_two_drives_before_their_number(tmp_path):
    again = plugin(0.4).replace('name="drive"', 'name="again"')
    verdict = try_robot(written(tmp_path, cart(), plugin(), again), standing=1.0)
    assert JOINT_DRIVEN_TWICE in {each.code for each in verdict.diagnostics}
    assert reasons(verdict) == {"turn": WHEEL_SEPARATION_MISMATCH}


def test_of_two_drives_only_the_last_one_has_an_effect(tmp_path):
    """In Gazebo, each drive commands its wheels in each update, with 0 if it has no command."""
    again = plugin().replace('name="drive"', 'name="again"')
    again = again.replace("</plugin>", "<commandTopic>second</commandTopic></plugin>")
    verdict = try_robot(written(tmp_path, cart(), plugin(), again), standing=1.0)
    moved = {each.topic: each.passes for each in verdict.drives}
    assert moved == {"/cmd_vel": False, "/second": True}
    assert all(abs(each.measured) < 1e-3 for each in verdict.drives if not each.passes)
    assert {(each.test, each.subject, each.code) for each in verdict.faults} == {
        ("drive", "/cmd_vel", JOINT_DRIVEN_TWICE),
        ("turn", "/cmd_vel", JOINT_DRIVEN_TWICE),
    }
    assert verdict.outcome == "file"


@pytest.mark.parametrize(("torques", "drives"), [((0.0001, 5), True), ((5, 0.0001), False)])
def test_of_two_drives_the_torque_of_the_last_one_counts(tmp_path, torques, drives):
    """In Gazebo, each drive also sets the torque of its wheels in each update."""
    first, second = (
        plugin().replace("</plugin>", f"<wheelTorque>{each}</wheelTorque></plugin>")
        for each in torques
    )
    second = second.replace('name="drive"', 'name="again"')
    verdict = try_robot(written(tmp_path, cart(), first, second), standing=1.0)
    assert [each.passes for each in verdict.drives] == [drives]


def test_transmissions_that_hold_the_wheels_are_tested_without_their_manager(tmp_path):
    """The manager also runs a controller, without which the drive may not steer."""
    arm = (
        '<link name="arm">'
        '<inertial><mass value="0.1"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" '
        'ixz="0" iyz="0"/>'
        '</inertial></link><joint name="arm_joint" type="revolute"><parent link="base"/>'
        '<child link="arm"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="5" '
        'velocity="5"/></joint>' + TRANSMISSION.format(name="arm", kind="Position")
    )
    robot = load_robot(written(tmp_path, cart(), plugin(), managed("Velocity"), arm))
    whole = len(robot.plugins), len(robot.transmissions)
    counts = [
        (len(each.plugins), len(each.transmissions))
        for each in _variants(robot, {"left_joint", "right_joint"})
    ]
    assert whole == (2, 3)
    assert counts == [(1, 3), (1, 3), (2, 1)]


PLANAR = (
    '<gazebo><plugin name="p" filename="libgazebo_ros_planar_move.so"><commandTopic>{topic}'
    "</commandTopic><odometryTopic>move/odom</odometryTopic></plugin></gazebo>"
)


@pytest.mark.parametrize(("topic", "moves"), [("cmd_vel", True), ("/cmd_vel", True), ("x", False)])
def test_planar_move_sets_the_velocity_of_a_robot_with_wheels(tmp_path, topic, moves):
    file = written(tmp_path, cart(), plugin(), PLANAR.format(topic=topic))
    reported = [each.values for each in check(file).findings if each.code is JOINT_DRIVEN_TWICE]
    assert [each["plugin"] for each in reported] == ["libgazebo_ros_planar_move.so"] * (not moves)
    verdict = try_robot(file, standing=0.5)
    assert all(drive.passes for drive in verdict.drives) == moves
    assert [(each.subject, each.code) for each in verdict.faults] == [
        ("/cmd_vel", JOINT_DRIVEN_TWICE)
    ] * (0 if moves else 2)
    assert verdict.outcome == ("good" if moves else "file")


def test_planar_move_hinders_a_controller_of_the_wheels(tmp_path):
    (tmp_path / "package.xml").write_text("<package><name>cart</name></package>")
    (tmp_path / "config").mkdir()
    text = CONTROLLER.replace("wheel_separation: 0.3", "wheel_separation: 0.2")
    (tmp_path / "config/base.yaml").write_text(text)
    file = written(tmp_path, cart(), CONTROL, PLANAR.format(topic="cmd_vel"))
    verdict = try_robot(file, standing=0.5)
    assert {(each.subject, each.code) for each in verdict.faults} == {
        ("/base/cmd_vel", JOINT_DRIVEN_TWICE)
    }
    assert verdict.outcome == "file"
