"""Folders without a package.xml that are meant by the names of packages."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.coded import coded

from cartwheel.checks import check
from cartwheel.codes.files import FILE_ELSEWHERE, FILE_MISSING, PACKAGE_WITHOUT_MANIFEST
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.repositories import root_of
from cartwheel.description.launches import LaunchSearch, launches_near

LINK = """<link name="base"><inertial><mass value="1"/>
<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
<visual><geometry><mesh filename="package://{}/meshes/base.stl"/></geometry></visual></link>"""
LAUNCH = """<launch>
<param name="robot_description" textfile="$(find bot)/urdf/robot.urdf"/>
<rosparam command="load" file="$(find bot)/config/controllers.yaml"/>
<node name="c" pkg="controller_manager" type="spawner" args="arm"/>
<node name="s" pkg="gazebo_ros" type="spawn_model" args="-urdf -param robot_description"/>
</launch>"""
MESH = """solid m
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid m
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A repository with the files of a package, but without package.xml."""
    folder = tmp_path / "thesis"
    for name in ("config", "launch", "meshes", "urdf"):
        (folder / name).mkdir(parents=True)
    (folder / "meshes/base.stl").write_text(MESH)
    (folder / "config/controllers.yaml").write_text("arm: {type: a/JointController}")
    (folder / "urdf/robot.urdf").write_text(f'<robot name="r">{LINK.format("bot")}</robot>')
    return folder


def packages(folder: Path) -> Packages:
    return Packages(folder / "urdf/robot.urdf", environment={})


def test_the_files_of_a_folder_state_the_name_of_its_package(folder: Path) -> None:
    assert packages(folder).find("bot") == folder
    found = check(folder / "urdf/robot.urdf").findings
    (said,) = coded(found, PACKAGE_WITHOUT_MANIFEST)
    assert said.severity == "warning"
    assert said.origin is not None
    assert said.origin.line == 3
    assert not coded(found, FILE_MISSING)
    assert not coded(found, FILE_ELSEWHERE)


def test_a_launch_file_loads_the_controllers_of_the_folder(folder: Path) -> None:
    (folder / "launch/spawn.launch").write_text(LAUNCH)
    (use,) = launches_near(folder)
    assert use.description == folder / "urdf/robot.urdf"
    assert use.controllers == (folder / "config/controllers.yaml",)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("CMakeLists.txt", "cmake_minimum_required(VERSION 3.0)\nproject(other_bot)"),
        ("setup.py", "package_name = 'other_bot'\nsetup(name=package_name)"),
    ],
)
def test_the_build_states_the_name_of_a_package(folder: Path, name: str, text: str) -> None:
    assert packages(folder).found("other_bot") is None
    (folder / name).write_text(text)
    assert packages(folder).found("other_bot") == folder


def test_other_packages_are_not_found_in_the_folder(folder: Path) -> None:
    # Most of its files are not here, and one of Gazebo's may be a copy.
    (folder / "launch/more.launch").write_text(
        "<launch><!-- $(find arm)/urdf/robot.urdf $(find arm)/urdf/a.urdf $(find arm)/b.urdf "
        "$(find gazebo_ros)/launch/more.launch $(find bot)/../thesis/urdf/robot.urdf --></launch>"
    )
    search = packages(folder)
    assert [search.found(name) for name in ("arm", "gazebo_ros", "bot")] == [None, None, folder]


def test_a_package_comes_first(folder: Path) -> None:
    package = folder.parent / "bot_of_others"
    package.mkdir()
    (package / "package.xml").write_text("<package><name>bot</name></package>")
    search = packages(folder)
    assert search.find("bot") == package
    assert not coded(search.moves(), PACKAGE_WITHOUT_MANIFEST)


def test_a_folder_with_packages_is_none_itself(folder: Path) -> None:
    (folder / "arm").mkdir()
    (folder / "arm/package.xml").write_text("<package><name>arm</name></package>")
    assert packages(folder).found("bot") is None


def test_a_folder_with_the_name_of_the_package_is_reported(folder: Path) -> None:
    own = folder.rename(folder.parent / "bot")
    search = packages(own)
    assert search.find("bot") == own
    assert len([*coded(search.moves(), PACKAGE_WITHOUT_MANIFEST)]) == 1


def test_launch_files_of_a_folder_that_stands_for_a_package_are_the_robots_own(
    folder: Path,
) -> None:
    """A downloaded archive has no .git either."""
    (folder / "launch/spawn.launch").write_text(LAUNCH)
    robot = folder / "urdf/robot.urdf"
    assert root_of(robot) == folder
    for given in (None, folder, folder.parent):
        own = LaunchSearch(given=given).of(robot)
        assert own.folder == folder
        assert [each.controllers for each in own.launches] == [
            (folder / "config/controllers.yaml",)
        ]
