"""Packages that are not built: files are found where CMake would have installed them from."""

from __future__ import annotations

import pytest

from cartwheel.description import load
from cartwheel.description.files.install_rules import source_of
from cartwheel.description.model import RobotDescription

LISTS = """
project(arm)  # install(DIRECTORY wrong DESTINATION share/arm)
install(
  DIRECTORY description/urdf "description/ros2_control"
  DESTINATION share/${PROJECT_NAME}
)
install(DIRECTORY models/ DESTINATION share/arm/models FILES_MATCHING PATTERN "*.sdf")
install(DIRECTORY headers/ DESTINATION include/arm)
install(TARGETS arm DESTINATION lib/arm)
"""


@pytest.fixture
def arm(tmp_path):
    folder = tmp_path / "arm"
    for name in ("description/urdf", "description/ros2_control", "models", "headers/urdf"):
        (folder / name).mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>arm</name></package>")
    (folder / "CMakeLists.txt").write_text(LISTS)
    return folder


@pytest.mark.parametrize(
    ("installed", "source"),
    [
        ("urdf/arm.urdf", "description/urdf/arm.urdf"),
        ("ros2_control/a.xacro", "description/ros2_control/a.xacro"),
        ("models/a.sdf", "models/a.sdf"),
        ("models/b/a.sdf", "models/b/a.sdf"),
        ("urdf", "description/urdf"),
    ],
)
def test_installed_files_lie_elsewhere_in_the_source(arm, installed, source):
    place = arm / source
    if place.suffix:
        place.parent.mkdir(exist_ok=True)
        place.touch()
    assert source_of(arm / installed) == place


@pytest.mark.parametrize("name", ["urdf/none.urdf", "wrong/a", "include/a"])
def test_what_is_not_installed_stays_where_it_was_sought(arm, name):
    assert source_of(arm / name) == arm / name
    assert source_of(arm.parent / name) == arm.parent / name


def test_a_robot_of_a_package_that_is_not_built(arm):
    (arm / "description/ros2_control/a.xacro").write_text(
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="a"><visual><geometry>'
        '<mesh filename="package://arm/ros2_control/a.obj"/></geometry></visual></link></robot>'
    )
    (arm / "description/ros2_control/a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    robot = arm / "description/urdf/arm.urdf.xacro"
    robot.write_text(
        '<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<xacro:include filename="$(find arm)/ros2_control/a.xacro"/></robot>'
    )
    found = load(robot)
    assert isinstance(found, RobotDescription)
    assert found.links[0].visuals[0].shape.path == arm / "description/ros2_control/a.obj"
