"""Joints are commanded as their plugins and controllers allow it."""

import math
from dataclasses import replace

import pytest
from tests.corpus.test_flights import tried

from cartwheel.corpus.verdict import Reach

BASE = (
    '<link name="base"><inertial><mass value="{mass}"/>'
    '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial><collision>'
    '<geometry><box size="0.3 0.3 0.1"/></geometry></collision></link>'
)
LINK = (
    '<link name="{name}"><inertial><origin xyz="{at}"/><mass value="{mass}"/>'
    '<inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="{name}_joint" type="{kind}"><parent link="{parent}"/><child link="{name}"/>'
    '<origin xyz="{place}"/><axis xyz="{axis}"/>'
    '<limit lower="-3" upper="3" effort="200" velocity="100"/></joint>'
)
TRANSMISSION = (
    '<transmission name="{name}"><type>transmission_interface/SimpleTransmission</type>'
    '<joint name="{name}_joint"><hardwareInterface>hardware_interface/EffortJointInterface'
    '</hardwareInterface></joint><actuator name="{name}_motor"/></transmission>'
)
CONTROL = '<gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo>'


def link(name, parent, **more):
    values = {
        "at": "0 0 0", "mass": 0.2, "i": 1e-3, "kind": "continuous", "place": "0 0 0.2",
        "axis": "0 0 1",
    }  # fmt: skip
    return LINK.format(name=name, parent=parent, **(values | more))


def test_joints_are_commanded_by_their_numbers_in_actuators_messages(tmp_path):
    plugins = "".join(
        '<gazebo><plugin name="gz::sim::systems::JointController" '
        f'filename="gz-sim-joint-controller-system"><joint_name>{name}_joint</joint_name>'
        "<sub_topic>command/motor_speed</sub_topic><use_actuator_msg>true</use_actuator_msg>"
        f"<actuator_number>{number}</actuator_number></plugin></gazebo>"
        for name, number in (("left", 1), ("right", 0))
    )
    parts = link("left", "base", place="0 0.1 0.2") + link("right", "base", place="0 -0.1 0.2")
    verdict = tried(tmp_path, BASE.format(mass=5), parts, plugins)
    assert {spin.joint for spin in verdict.spins} == {"left_joint", "right_joint"}
    assert {spin.topic for spin in verdict.spins} == {"/model/aircraft/command/motor_speed"}
    assert verdict.good, verdict.faults


def test_an_index_that_no_message_can_have_takes_no_memory(tmp_path):
    plugin = (
        '<gazebo><plugin name="gz::sim::systems::JointController" '
        'filename="gz-sim-joint-controller-system"><joint_name>left_joint</joint_name>'
        "<use_actuator_msg>true</use_actuator_msg>"
        "<actuator_number>2147483647</actuator_number></plugin></gazebo>"
    )
    parts = link("left", "base", place="0 0.1 0.2")
    assert tried(tmp_path, BASE.format(mass=5), parts, plugin).spins == ()


def test_an_effort_is_measured_before_the_rest_of_the_arm_falls(tmp_path):
    """The torque for the light wrist is a thousandth of those by which the arm falls."""
    parts = link("upper", "base", kind="revolute", axis="0 1 0", at="0 0 0.3", mass=3, i=0.05)
    parts += link(
        "lower", "upper", kind="revolute", axis="0 1 0", at="0.2 0 0.3", mass=2, i=0.03,
        place="0 0 0.6",
    )  # fmt: skip
    parts += link(
        "wrist",
        "lower",
        kind="revolute",
        axis="1 0 0",
        at="0.02 0 0.01",
        mass=0.1,
        i=1e-5,
        place="0.1 0.05 0.5",
    )
    names = ("upper", "lower", "wrist")
    parts += "".join(TRANSMISSION.format(name=name) for name in names) + CONTROL
    file = tmp_path / "push.yaml"
    file.write_text(
        "".join(
            f"{name}:\n  type: effort_controllers/JointEffortController\n  joint: {name}_joint\n"
            for name in names
        )
    )
    verdict = tried(tmp_path, BASE.format(mass=50), parts, controllers=[file])
    assert {spin.joint for spin in verdict.spins} == {f"{name}_joint" for name in names}
    assert all(spin.follows for spin in verdict.spins), verdict.spins


def test_a_weak_velocity_controller_is_tested_at_a_higher_speed(tmp_path):
    """Its friction of 0.1 N m is not in the description of the joint: the wheel drags another."""
    parts = link("wheel", "base", i=0.01) + TRANSMISSION.format(name="wheel") + CONTROL
    brake = link("brake", "wheel", axis="0 0 1", place="0 0 0").replace(
        "<limit", '<dynamics friction="0.1"/><limit'
    )
    brake += (
        '<gazebo><plugin name="hold" filename="libroboticsgroup_gazebo_mimic_joint_plugin.so">'
        "<joint>wheel_joint</joint><mimicJoint>brake_joint</mimicJoint><multiplier>1</multiplier>"
        "</plugin></gazebo>"
    )
    file = tmp_path / "spin.yaml"
    file.write_text(
        "spin:\n  type: effort_controllers/JointVelocityController\n  joint: wheel_joint\n"
        "  pid: {p: 0.5, i: 0.01, d: 0.0}\n"
    )
    verdict = tried(tmp_path, BASE.format(mass=5), parts, brake, controllers=[file])
    (spin,) = verdict.spins
    # The error of 0.1 / 0.5 rad/s and more is 40 % at 0.5 rad/s, and a few percent at 20 rad/s.
    assert spin.commanded == 20.0
    assert spin.measured == pytest.approx(19.8, rel=0.05)
    assert verdict.good, verdict.faults


@pytest.mark.parametrize("rate", [0, 2])
def test_a_trajectory_sets_the_joints_of_a_plugin_without_forces(tmp_path, rate):
    plugin = (
        '<gazebo><plugin name="pose" filename="libgazebo_ros_joint_pose_trajectory.so">'
        f"<topicName>set_pose</topicName><updateRate>{rate}</updateRate></plugin></gazebo>"
    )
    arm = link("arm", "base", kind="revolute", axis="0 1 0", at="0 0 0.2")
    verdict = tried(tmp_path, BASE.format(mass=5), arm, plugin)
    (reach,) = verdict.reaches
    assert (reach.controller, reach.joint) == ("gazebo_ros_joint_pose_trajectory", "arm_joint")
    assert abs(reach.target) == pytest.approx(0.2, abs=0.01)
    assert abs(reach.error) < 0.02
    assert verdict.moves


def test_a_robot_on_a_floating_joint_of_the_world_stands_on_the_ground(tmp_path):
    world = (
        '<link name="world"/><joint name="free" type="floating"><parent link="world"/>'
        '<child link="base"/></joint>'
    )
    verdict = tried(tmp_path, world, BASE.format(mass=5))
    assert verdict.stand.state == "yes"
    assert abs(verdict.stand.sunk) < 0.01
    assert verdict.good, verdict.faults


def test_a_robot_that_defines_a_material_twice_does_not_load(tmp_path):
    material = '<material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>'
    verdict = tried(tmp_path, material * 2, BASE.format(mass=5))
    (fault,) = verdict.faults
    assert (fault.test, fault.code.name, fault.source) == ("load", "name-taken", "file")


WHEEL = (
    '<link name="{name}">'
    '<inertial><mass value="0.3"/><inertia ixx="3e-4" iyy="4e-4" izz="3e-4" ixy="0" '
    'ixz="0" iyz="0"/>'
    '</inertial><collision><origin rpy="1.5707963 0 0"/><geometry><cylinder radius="0.08"'
    ' length="0.03"/></geometry></collision></link>'
    '<joint name="{name}_joint" type="continuous"><parent link="base"/><child link="{name}"/>'
    '<origin xyz="{x} {y} -0.02"/><axis xyz="0 {axis} 0"/></joint>'
)


@pytest.mark.parametrize(
    "limit", ["", '<limit lower="-1e4" upper="1e4" effort="10" velocity="10"/>']
)
def test_wheels_that_are_mounted_in_opposite_directions_roll_forward_together(tmp_path, limit):
    """At equal speeds they would turn the robot, and weak motors cannot let its tyres slide.

    Each wheel carries 40 N. To turn the robot, it must slide with a torque of up to 40 N x 0.08 m,
    which needs an error of 3.2 rad/s. The test allows 0.025 rad/s, and 1 rad/s at 20 rad/s.
    """
    parts, content = BASE.format(mass=15) + CONTROL, ""
    for end, x in (("front", 0.3), ("rear", -0.3)):
        for side, y, axis in (("left", 0.18, 1), ("right", -0.18, -1)):
            name = f"{end}_{side}"
            wheel = WHEEL.format(name=name, x=x, y=y, axis=axis)
            if limit:
                wheel = wheel.replace("continuous", "revolute").replace(
                    "</joint>", f"{limit}</joint>"
                )
            parts += wheel + TRANSMISSION.format(name=name)
            content += (
                f"{name}: {{type: effort_controllers/JointVelocityController, "
                f"joint: {name}_joint, pid: {{p: 1, i: 0, d: 0}}}}\n"
            )
    path = tmp_path / "wheels.yaml"
    path.write_text(content)
    verdict = tried(tmp_path, parts, controllers=[path])
    assert len(verdict.spins) == 4
    assert verdict.good, verdict.faults


def test_joints_that_meet_the_ground_together_are_commanded_alone(tmp_path):
    """Both beams are 0.5 m long, at 0.6 m: together, their tip is there after 1 s at 0.5 rad/s."""
    tip = (
        '<collision><origin xyz="0.5 0 0"/><geometry><sphere radius="0.03"/></geometry></collision>'
        "</link>"
    )
    parts = link("upper", "base", mass=1.0, place="0.2 0 0.6", axis="0 1 0", kind="revolute")
    parts += link(
        "lower", "upper", mass=1.0, place="0.5 0 0", axis="0 1 0", kind="revolute"
    ).replace("</link>", tip)
    plugins = "".join(
        '<gazebo><plugin name="p" filename="gz-sim-joint-controller-system"><joint_name>'
        f"{name}_joint</joint_name></plugin></gazebo>"
        for name in ("upper", "lower")
    )
    verdict = tried(tmp_path, BASE.format(mass=200), parts.replace('"-3"', '"-0.1"'), plugins)
    assert {spin.joint for spin in verdict.spins} == {"upper_joint", "lower_joint"}
    assert all(spin.commanded > 0 for spin in verdict.spins)
    assert verdict.good, verdict.faults


@pytest.mark.parametrize(("reached", "arrives"), [(0.03, False), (0.06, True)])
def test_a_short_way_is_not_within_the_tolerance_of_a_long_one(reached, arrives):
    short = Reach(controller="c", joint="j", start=0.0, target=0.1, reached=reached, angular=True)
    assert short.arrived == arrives
    assert replace(short, target=0.2, reached=0.1).arrived


def test_a_joint_with_a_short_way_has_more_time(tmp_path):
    """Damping slows it down, so that it moves half of its way in 7 s."""
    time_constant, way = 10.0, 0.1
    part = link("turn", "base", kind="revolute", place="0 0 0.2", i=0.001)
    part = part.replace("<limit", f'<dynamics damping="{10 * time_constant}"/><limit')
    part = part.replace('velocity="100"', f'velocity="{way}"')
    file = tmp_path / "turn.yaml"
    kind = "effort_controllers/JointPositionController"
    file.write_text(f"turn: {{type: {kind}, joint: turn_joint, pid: {{p: 10.0, i: 0.0, d: 0.0}}}}")
    parts = BASE.format(mass=5), part, TRANSMISSION.format(name="turn"), CONTROL
    (reach,) = tried(tmp_path, *parts, controllers=[file]).reaches
    assert abs(reach.target - reach.start) == pytest.approx(way)
    assert reach.arrived
    moved = abs(reach.reached - reach.start) / way
    assert moved == pytest.approx(1 - math.exp(-7.0 / time_constant), abs=0.05)
