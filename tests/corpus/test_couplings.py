"""Joints that follow each other are commanded together."""

import pytest

from cartwheel.codes.devices import CONTROLLER_GAIN_TOO_LOW
from cartwheel.corpus import try_robot
from cartwheel.corpus.couplings import consistent, slopes
from cartwheel.simulation.models.couplings import Coupling

FINGER = (
    '<link name="{name}"><inertial><mass value="0.1"/>'
    '<inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="{name}_joint" type="revolute"><parent link="palm"/><child link="{name}"/>'
    '<origin xyz="0 {y} 0"/><axis xyz="0 0 1"/>'
    '<limit lower="{lower}" upper="{upper}" effort="5" velocity="5"/>'
    '<dynamics damping="0.05" friction="{friction}"/></joint>'
    '<transmission name="{name}"><type>transmission_interface/SimpleTransmission</type>'
    '<joint name="{name}_joint"><hardwareInterface>hardware_interface/{kind}JointInterface'
    '</hardwareInterface></joint><actuator name="{name}_motor"/></transmission>'
)
GRIPPER = (
    '<robot name="gripper"><link name="world"/><link name="palm"><inertial><mass value="1"/>'
    '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>'
    '<joint name="stand" type="fixed"><parent link="world"/><child link="palm"/></joint>'
    '{fingers}<gazebo><plugin name="control" filename="libgazebo_ros_control.so"/>'
    '<plugin name="mimic" filename="libroboticsgroup_gazebo_mimic_joint_plugin.so">'
    "<joint>left_joint</joint><mimicJoint>right_joint</mimicJoint><multiplier>-1</multiplier>"
    "</plugin></gazebo></robot>"
)


def tried(tmp_path, kind, controllers, *, friction=0.0):
    limits = {"left": (0.1, -0.5, 0.5), "right": (-0.1, -0.5, 0.5)}
    fingers = "".join(
        FINGER.format(
            name=name, y=y, lower=lower, upper=upper, kind=kind,
            friction=friction if name == "left" else 0.0,
        )
        for name, (y, lower, upper) in limits.items()
    )  # fmt: skip
    path = tmp_path / "gripper.urdf"
    path.write_text(GRIPPER.format(fingers=fingers))
    (tmp_path / "control.yaml").write_text(controllers)
    return try_robot(path, standing=1.0, controllers=[tmp_path / "control.yaml"])


def test_a_joint_that_mimics_another_one_is_not_commanded_against_it(tmp_path):
    verdict = tried(
        tmp_path,
        "Position",
        "fingers:\n  type: position_controllers/JointTrajectoryController\n"
        "  joints: [left_joint, right_joint]\n",
    )
    left, right = verdict.reaches
    assert right.target == pytest.approx(-left.target, abs=1e-6)
    assert abs(left.target) == pytest.approx(0.2, abs=1e-3)
    assert abs(left.error) < 1e-3
    assert verdict.good, verdict.faults


def test_the_friction_of_a_joint_also_holds_those_that_follow_it(tmp_path):
    gains = "{p: 0.5, d: 0.01}"
    verdict = tried(
        tmp_path,
        "Effort",
        "fingers:\n  type: effort_controllers/JointTrajectoryController\n"
        f"  joints: [left_joint, right_joint]\n  gains: {{left_joint: {gains},"
        f" right_joint: {gains}}}\n",
        friction=0.15,
    )
    left, right = verdict.reaches
    # At 0.15 rad from the target, 0.5 N m/rad of two motors no longer overcome the friction.
    assert abs(right.error) == pytest.approx(0.15, abs=0.01)
    assert right.sag == left.sag == pytest.approx(0.3, abs=0.01)
    assert {fault.code for fault in verdict.faults} == {CONTROLLER_GAIN_TOO_LOW}


def test_joints_follow_each_other_in_chains_and_from_both_ends():
    coupled = [
        Coupling(follower="b", leader="a", ratio=-2.0, offset=0.1),
        Coupling(follower="b", leader="c", ratio=4.0, offset=0.0),
        Coupling(follower="e", leader="d", ratio=1.0, offset=0.0),
    ]
    commanded = {"a": 0.0, "c": 0.0, "e": 0.0}
    assert consistent(("a", 0.2), commanded, coupled) == pytest.approx({"a": 0.2, "c": -0.075})
    assert consistent(("c", -0.075), commanded, coupled) == pytest.approx({"c": -0.075, "a": 0.2})
    # For each radian of c, a moves by 2.
    assert slopes("c", commanded, coupled) == pytest.approx({"c": 1.0, "a": 0.5})
