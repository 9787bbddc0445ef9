"""A package that is not there: the others that are not there either, and how to get them."""

import pytest

from cartwheel.description import load_robot
from cartwheel.errors import DescriptionError

XACRO = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}</robot>'
INCLUDE = '<xacro:include filename="{}"/>'


@pytest.fixture
def workspace(tmp_path, monkeypatch):
    """A package with a robot, and one that it includes from."""
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    for name in ("mine", "yours"):
        folder = tmp_path / "src" / name / "urdf"
        folder.mkdir(parents=True)
        (folder.parent / "package.xml").write_text(f"<package><name>{name}</name></package>")
    return tmp_path / "src"


def hint_of(workspace, *includes):
    file = workspace / "mine" / "urdf" / "robot.xacro"
    file.write_text(XACRO.format("".join(INCLUDE.format(each) for each in includes)))
    with pytest.raises(DescriptionError) as caught:
        load_robot(file)
    assert caught.value.code.name == "file-missing"
    assert caught.value.values["name"] == "laser_x"
    return caught.value.hint


def test_all_are_named_at_once(workspace):
    (workspace / "yours" / "urdf" / "arm.xacro").write_text(
        XACRO.format('<link name="a"><mesh filename="package://grip_y/m.stl"/></link>')
    )
    (workspace / "mine" / "urdf" / "base.xacro").write_text(
        XACRO.format(INCLUDE.format("$(find imu_z)/imu.xacro"))
    )
    hint = hint_of(
        workspace,
        "$(find laser_x)/laser.xacro",
        "$(find yours)/urdf/arm.xacro",
        "base.xacro",
    )
    assert "Also missing: imu_z, grip_y. Get them with apt" in hint


def test_what_stands_in_a_comment_is_not_named(workspace):
    file = workspace / "mine" / "urdf" / "robot.xacro"
    file.write_text(
        XACRO.format(INCLUDE.format("$(find laser_x)/a.xacro") + "<!-- $(find grip_y) -->")
    )
    with pytest.raises(DescriptionError) as caught:
        load_robot(file)
    assert "grip_y" not in str(caught.value)
    assert "Get it with apt" in str(caught.value)


def test_with_a_sourced_ros_the_command_is_ready(workspace, monkeypatch):
    monkeypatch.setenv("ROS_DISTRO", "noetic")
    hint = hint_of(workspace, "$(find laser_x)/a.xacro", "$(find grip_y)/b.xacro")
    assert "sudo apt install ros-noetic-laser-x ros-noetic-grip-y; or" in hint


def test_files_that_include_each_other_end_the_search(workspace):
    for one, other in (("a", "b"), ("b", "a")):
        (workspace / "mine" / "urdf" / f"{one}.xacro").write_text(
            XACRO.format(INCLUDE.format(f"{other}.xacro"))
        )
    hint = hint_of(workspace, "$(find laser_x)/l.xacro", "a.xacro")
    assert "Also missing" not in hint
