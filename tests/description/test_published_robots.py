"""Robots that others published load, with what is wrong with them said."""

import os
from pathlib import Path

import pytest
from tests.coded import raises

from cartwheel.codes.files import FILE_MISSING, INCLUDE_ABSENT, NOT_A_DESCRIPTION
from cartwheel.description import load, load_robot

ROOT = Path(__file__).parents[2]
CORPUS = Path(os.environ.get("CARTWHEEL_CORPUS", ROOT.parent / "shared" / "corpus"))

pytestmark = pytest.mark.skipif(
    not CORPUS.is_dir(), reason=f"no corpus of others' robots in {CORPUS}"
)

TURTLEBOT = "turtlebot3/turtlebot3_description/urdf/turtlebot3_"
ROBOTS = {
    f"{TURTLEBOT}burger.urdf.xacro": 7,
    f"{TURTLEBOT}burger_for_autorace.urdf.xacro": 10,
    f"{TURTLEBOT}burger_for_autorace_2020.urdf.xacro": 10,
    f"{TURTLEBOT}waffle.urdf.xacro": 13,
    f"{TURTLEBOT}waffle_for_open_manipulator.urdf.xacro": 13,
    f"{TURTLEBOT}waffle_pi.urdf.xacro": 11,
    f"{TURTLEBOT}waffle_pi_for_open_manipulator.urdf.xacro": 11,
    "andino/andino_description/urdf/andino.urdf.xacro": 12,
    "mir_robot/mir_description/urdf/mir.urdf.xacro": 19,
    "gazebo_ros_demos/rrbot_description/urdf/rrbot.xacro": 6,
    "linorobot2/linorobot2_description/urdf/robots/2wd.urdf.xacro": 10,
    "linorobot2/linorobot2_description/urdf/robots/4wd.urdf.xacro": 10,
    "linorobot2/linorobot2_description/urdf/robots/mecanum.urdf.xacro": 10,
    "urdf_sim_tutorial/urdf/10-firsttransmission.urdf.xacro": 16,
    "urdf_sim_tutorial/urdf/11-limittransmission.urdf.xacro": 16,
    "urdf_sim_tutorial/urdf/12-gripper.urdf.xacro": 16,
    "gazebo_plugins_tests/gazebo_plugins/test/multi_robot_scenario/xacro/p3dx/pioneer3dx.xacro": 14,
    "gazebo_plugins_tests/gazebo_plugins/test/tricycle_drive/xacro/tricycle/tricycle.xacro": 6,
}


@pytest.mark.parametrize(("name", "links"), ROBOTS.items(), ids=lambda value: str(value)[-40:])
def test_robots_load(name, links):
    robot = load_robot(CORPUS / name)
    world = any(joint.parent == "world" for joint in robot.joints)
    assert len(robot.links) == links
    assert len(robot.joints) == links - (not world)
    assert robot.mass > 0
    errors = [each for each in robot.diagnostics if each.severity == "error"]
    # Meshes of some megabytes are not in the corpus, nor is a package that holds nothing else.
    assert not [each for each in errors if "left_out" not in each.values]


def test_missing_meshes_of_the_waffle_are_named():
    path = CORPUS / f"{TURTLEBOT}waffle.urdf.xacro"
    (missing,) = [each for each in load(path).diagnostics if each.severity == "error"]
    assert missing.code is FILE_MISSING
    assert str(missing.origin).endswith("turtlebot3_waffle.urdf.xacro:23")
    assert "meshes/bases/waffle_base.stl" in str(missing.values["name"])
    assert missing.values["meant"] == "waffle_pi_base.stl"


def test_mir_s_friction_is_read_from_its_attributes():
    robot = load_robot(CORPUS / "mir_robot/mir_description/urdf/mir.urdf.xacro")
    assert robot.link("left_wheel_link").collisions[0].surface.mu1 == 200


def test_a_robot_is_loaded_without_the_parts_of_absent_packages():
    robot = load(CORPUS / "husky/husky_description/urdf/husky.urdf.xacro")
    absent = [each for each in robot.diagnostics if each.code is INCLUDE_ABSENT]
    (mount,) = (each for each in absent if each.values["name"] == "fath_pivot_mount_description")
    assert str(mount.origin).endswith("flir_blackfly_mount.urdf.xacro:3")
    assert {"base_link", "front_left_wheel_link"} <= {link.name for link in robot.links}


def test_files_of_macros_alone_say_so():
    with raises(NOT_A_DESCRIPTION, tag="robot"):
        load(CORPUS / "linorobot2/linorobot2_description/urdf/mech/base.urdf.xacro")
