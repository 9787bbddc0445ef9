"""Environment variables that every sourced ROS sets, without a sourced ROS."""

from pathlib import Path

import pytest

from cartwheel.codes.files import ENVIRONMENT_ASSUMED
from cartwheel.description.loading import open_description
from cartwheel.errors import DescriptionError

NAMES = ("ROS_VERSION", "ROS_DISTRO", "ROS_PYTHON_VERSION", "ROS_MASTER_URI")
BOTH = "".join(
    f'<buildtool_depend condition="$ROS_VERSION == {number}">{tool}</buildtool_depend>'
    for number, tool in ((1, "catkin"), (2, "ament_cmake"))
)


@pytest.fixture(autouse=True)
def _no_ros(monkeypatch):
    for name in NAMES:
        monkeypatch.delenv(name, raising=False)


def package(folder: Path, depend: str, *launches: str) -> None:
    (folder / "package.xml").write_text(f"<package><name>cart</name>{depend}</package>")
    (folder / "launch").mkdir()
    for each in launches:
        (folder / "launch" / each).write_text("")


def opened(folder: Path, text: str):
    file = folder / "cart.urdf.xacro"
    file.write_text(
        '<robot name="cart" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        f'<link name="{text}"/></robot>'
    )
    return open_description(file, {}, [])


def link(found) -> str:
    return found.root.all("link")[0].attributes["name"]


@pytest.mark.parametrize(
    ("depend", "launches", "version"),
    [
        ("<buildtool_depend>catkin</buildtool_depend>", (), "1 noetic 3"),
        ("<buildtool_depend>ament_cmake</buildtool_depend>", (), "2 humble 3"),
        (BOTH, ("gazebo.launch",), "1 noetic 3"),
        (BOTH, ("gazebo.launch.py",), "2 humble 3"),
        (BOTH, ("gazebo.launch", "gazebo.launch.py"), "2 humble 3"),
        ("", ("cart_launch.py", "config.yaml"), "2 humble 3"),
        ("", ("launch.py", "launch_config.yaml"), "2 humble 3"),
        ("", ("gazebo.launch", "launch_config.yaml", "move.py"), "1 noetic 3"),
    ],
)
def test_the_values_are_those_of_the_version_of_the_package(tmp_path, depend, launches, version):
    package(tmp_path, depend, *launches)
    found = opened(tmp_path, "$(env ROS_VERSION) $(env ROS_DISTRO) $(env ROS_PYTHON_VERSION)")
    assert link(found) == version


def test_each_value_is_reported_once(tmp_path):
    package(tmp_path, "<buildtool_depend>catkin</buildtool_depend>")
    found = opened(tmp_path, "$(env ROS_VERSION)$(env ROS_VERSION)$(env ROS_DISTRO)")
    told = [each for each in found.diagnostics if each.code is ENVIRONMENT_ASSUMED]
    assert [each.values["name"] for each in told] == ["ROS_VERSION", "ROS_DISTRO"]
    assert {each.values["ros"] for each in told} == {1.0}
    assert {each.severity for each in told} == {"info"}


def test_a_variable_that_is_set_is_used_without_a_message(tmp_path, monkeypatch):
    package(tmp_path, "<buildtool_depend>catkin</buildtool_depend>")
    monkeypatch.setenv("ROS_VERSION", "2")
    found = opened(tmp_path, "$(env ROS_VERSION)")
    assert link(found) == "2"
    assert not found.diagnostics


def test_the_default_of_an_optional_variable_is_used_if_the_version_is_unknown(tmp_path):
    assert link(opened(tmp_path, "$(optenv ROS_VERSION 1)")) == "1"
    package(tmp_path, "<buildtool_depend>ament_cmake</buildtool_depend>")
    assert link(opened(tmp_path, "$(optenv ROS_VERSION 1)")) == "2"


def test_a_variable_of_the_other_version_is_not_set(tmp_path):
    package(tmp_path, "<buildtool_depend>ament_cmake</buildtool_depend>")
    with pytest.raises(DescriptionError):
        opened(tmp_path, "$(env ROS_MASTER_URI)")
    assert link(opened(tmp_path, "$(optenv ROS_MASTER_URI none)")) == "none"
