"""The stand-ins of Universal Robots' arms: frames, joints, and control."""

import math
import re

import pytest

import cartwheel as cw
from cartwheel.codes.files import STAND_IN_USED
from cartwheel.description import load_text
from cartwheel.description.files.package_folders import stand_ins
from cartwheel.description.model import RobotDescription
from cartwheel.geometry import rotate

JOINTS = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
FIGURES = {
    "ur3": ((0.1519, 0.24365, 0.21325, 0.11235, 0.08535, 0.0819), 10.63),
    "ur5": ((0.089159, 0.425, 0.39225, 0.10915, 0.09465, 0.0823), 21.0489),
    "ur10": ((0.1273, 0.612, 0.5723, 0.163941, 0.1157, 0.0922), 32.435),
    "ur3e": ((0.15185, 0.24355, 0.2132, 0.13105, 0.08535, 0.0921), 10.7985),
    "ur5e": ((0.1625, 0.425, 0.3922, 0.1333, 0.0997, 0.0996), 21.7),
    "ur10e": ((0.1807, 0.6127, 0.57155, 0.17415, 0.11985, 0.11655), 33.104),
    "ur16e": ((0.1807, 0.4784, 0.36, 0.17415, 0.11985, 0.11655), 31.26),
    "ur20": ((0.2363, 0.862, 0.7287, 0.201, 0.1593, 0.1543), 64.96),
    "ur30": ((0.2363, 0.637, 0.5037, 0.201, 0.1593, 0.1543), 63.147),
}
"""Lengths d1, a2, a3, d4, d5 and d6 of the maker's table, in m, and the mass of the arm in kg."""
FILES = "$(find ur_description)/config/{}/"
LINKS = (
    "shoulder_link", "upper_arm_link", "forearm_link", "wrist_1_link", "wrist_2_link",
    "wrist_3_link", "tool0",
)  # fmt: skip


def robot(body: str, file: str = "<string>") -> RobotDescription:
    read = load_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="world"/>'
        f"{body}</robot>",
        file=file,
    )
    assert isinstance(read, RobotDescription)
    assert {each.code for each in read.diagnostics} == {STAND_IN_USED}
    return read


def ros2(kind: str, more: str = "", folder: str = "") -> RobotDescription:
    """With the parameter files of a folder, by default those of the package."""
    file = f"{folder}robot.urdf.xacro"
    folder = folder or FILES.format(kind)
    return robot(
        '<xacro:include filename="$(find ur_description)/urdf/ur_macro.xacro"/>'
        f'<xacro:ur_robot name="ur" tf_prefix="a_" parent="world" '
        f'joint_limits_parameters_file="{folder}joint_limits.yaml" '
        f'kinematics_parameters_file="{folder}default_kinematics.yaml" '
        f'physical_parameters_file="{folder}physical_parameters.yaml" '
        f'visual_parameters_file="{folder}visual_parameters.yaml" {more}>'
        '<origin xyz="0 0 0"/></xacro:ur_robot>',
        file,
    )


def fixed(include: str, call: str) -> RobotDescription:
    return robot(
        f'<xacro:include filename="{include}"/>{call}<joint name="base_joint" type="fixed">'
        '<parent link="world"/><child link="a_base_link"/></joint>'
    )


def noetic(kind: str) -> RobotDescription:
    file = f"$(find ur_description)/urdf/inc/{kind}_macro.xacro"
    return fixed(file, f'<xacro:{kind}_robot prefix="a_"/>')


def kinetic(kind: str, limits: str = 'joint_limited="false"') -> RobotDescription:
    package = "ur_e_description" if kind.endswith("e") else "ur_description"
    file = f"$(find {package})/urdf/{kind}.urdf.xacro"
    return fixed(file, f'<xacro:{kind}_robot prefix="a_" {limits}/>')


@pytest.mark.parametrize("kind", FIGURES)
@pytest.mark.parametrize("of", [ros2, noetic], ids=["ros2", "noetic"])
def test_frames(of, kind):
    arm = of(kind)
    (d1, a2, a3, d4, d5, d6), mass = FIGURES[kind]
    # With all joints at zero, the arm is stretched out along x, and the tool points along -y.
    places = [
        (0, 0, d1), (0, 0, d1), (a2, 0, d1), (a2 + a3, d4, d1), (a2 + a3, d4, d1 - d5),
        (a2 + a3, d4 + d6, d1 - d5), (a2 + a3, d4 + d6, d1 - d5),
    ]  # fmt: skip
    for link, place in zip(LINKS, places, strict=True):
        assert arm.link(f"a_{link}").pose.position == pytest.approx(place, abs=1e-9), link
    tool = arm.link("a_tool0").pose.orientation
    assert rotate(tool, (0, 0, 1)) == pytest.approx((0, 1, 0), abs=1e-9)
    assert sum(link.inertial.mass for link in arm.links if link.inertial) == pytest.approx(mass)


@pytest.mark.parametrize("kind", ["ur3", "ur5", "ur10", "ur3e", "ur5e", "ur10e"])
def test_kinetic_has_the_same_tool(kind):
    old, new = kinetic(kind), noetic(kind)
    assert old.link("a_tool0").pose.position == pytest.approx(
        new.link("a_tool0").pose.position, abs=1e-9
    )
    assert old.link("a_ee_link").pose.position == old.link("a_tool0").pose.position
    for joint in JOINTS:
        one, other = old.joint(f"a_{joint}_joint").axis, new.joint(f"a_{joint}_joint").axis
        assert (one.effort, one.velocity) == (other.effort, other.velocity)


def test_limits():
    arm = noetic("ur3")
    axis = arm.joint("a_elbow_joint").axis
    assert (axis.lower, axis.upper) == pytest.approx((-math.pi, math.pi))
    assert (axis.effort, axis.velocity) == pytest.approx((28, math.pi))
    assert arm.joint("a_wrist_3_joint").type == "continuous"
    arm = kinetic("ur5", 'joint_limited="true" shoulder_lift_upper_limit="0.5"')
    assert arm.joint("a_shoulder_lift_joint").axis.upper == 0.5
    assert arm.joint("a_shoulder_lift_joint").axis.lower == pytest.approx(-math.pi)
    assert kinetic("ur5").joint("a_shoulder_lift_joint").axis.upper == pytest.approx(2 * math.pi)


def test_own_kinematics(tmp_path):
    source = stand_ins() / "ur_description" / "config" / "ur5e"
    for file in source.iterdir():
        text = file.read_text().replace("z: 0.1625", "z: 0.1631")
        (tmp_path / file.name).write_text(text)
    arm = ros2("ur5e", folder=f"{tmp_path}/")
    assert arm.link("a_shoulder_link").pose.position == pytest.approx((0, 0, 0.1631))


@pytest.mark.parametrize(
    ("more", "plugin"),
    [
        ('sim_gazebo="true"', "gazebo_ros2_control/GazeboSystem"),
        ('sim_ignition="true"', "ign_ros2_control/IgnitionSystem"),
        ('use_fake_hardware="true"', "mock_components/GenericSystem"),
        ("", None),
        ('sim_gazebo="true" generate_ros2_control_tag="false"', None),
    ],
)
def test_ros2_control(more, plugin):
    (*systems,) = ros2("ur5e", more).ros2_control
    found = [system.find("hardware").find("plugin").text for system in systems]
    assert found == ([plugin] if plugin else [])


CONTROLLERS = """
controller_manager:
  ros__parameters:
    update_rate: 100
    arm: {type: joint_trajectory_controller/JointTrajectoryController}
arm:
  ros__parameters:
    joints: [shoulder_pan_joint, shoulder_lift_joint, elbow_joint,
             wrist_1_joint, wrist_2_joint, wrist_3_joint]
    command_interfaces: [position]
    state_interfaces: [position, velocity]
"""


@pytest.mark.parametrize("simulator", ["gazebo", "ignition"])
def test_the_whole_arm_moves(make, tmp_path, simulator):
    """The launch files of the original package's users start this file with these arguments."""
    (tmp_path / "controllers.yaml").write_text(CONTROLLERS)
    world: cw.World = make.world()
    arm = world.spawn(
        stand_ins() / "ur_description" / "urdf" / "ur.urdf.xacro",
        arguments={
            "ur_type": "ur10e", "name": "ur", f"sim_{simulator}": "true",
            "simulation_controllers": tmp_path / "controllers.yaml",
        },
    )  # fmt: skip
    world.run(0.1)
    assert arm.joint("shoulder_lift_joint") == pytest.approx(-1.57, abs=0.01)
    goal = [0.5, -1.2, 0.8, -1.0, 0.3, 0.2]
    names = [f"{joint}_joint" for joint in JOINTS]
    world.publish(
        "/arm/joint_trajectory",
        joint_names=names,
        points=[{"positions": goal, "time_from_start": {"sec": 1, "nanosec": 0}}],
    )
    world.run(1.5)
    assert [arm.joint(name) for name in names] == pytest.approx(goal, abs=0.02)


WHOLE = [
    *(f"ur_description/urdf/{kind}.xacro" for kind in FIGURES),
    *(
        f"{package}/urdf/{kind}_{form}.urdf.xacro"
        for package, kinds in (
            ("ur_description", ("ur3", "ur5", "ur10")),
            ("ur_e_description", ("ur3e", "ur5e", "ur10e")),
        )
        for kind in kinds
        for form in ("robot", "joint_limited_robot")
    ),
]  # fmt: skip


@pytest.mark.parametrize("file", WHOLE)
def test_whole_arms(file):
    path = stand_ins() / file
    arm = load_text(path.read_text(), file=str(path))
    assert isinstance(arm, RobotDescription)
    assert [each for each in arm.diagnostics if each.severity != "info"] == []
    assert len(arm.transmissions) == len(JOINTS)
    assert arm.link("tool0")


def test_any_arm_of_noetic():
    path = stand_ins() / "ur_description" / "urdf" / "ur.xacro"
    folder = FILES.format("ur16e")
    arm = load_text(
        path.read_text(),
        file=str(path),
        arguments={
            "robot_model": "ur16e",
            "joint_limit_params": folder + "joint_limits.yaml",
            "kinematics_params": folder + "default_kinematics.yaml",
            "physical_params": folder + "physical_parameters.yaml",
        },
    )
    assert isinstance(arm, RobotDescription)
    assert arm.name == "ur16e_robot"


def test_every_file_is_tried():
    """Each macro of these packages is called above, and each whole arm is read."""
    names = {path.name for path in (stand_ins() / "ur_description" / "urdf").glob("*.xacro")}
    read = {file.split("/")[-1] for file in WHOLE}
    parts = {name for name in names - read if not re.search(r"ur\.(urdf\.)?xacro", name)}
    assert parts == {
        "ur_macro.xacro", "ur.ros2_control.xacro", "ur.transmission.xacro", "ur.gazebo.xacro",
        "common.gazebo.xacro", "ur3.urdf.xacro", "ur5.urdf.xacro", "ur10.urdf.xacro",
    }  # fmt: skip
