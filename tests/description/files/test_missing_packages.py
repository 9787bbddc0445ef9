"""A package that is not there: the others that are not there either, and how to get them."""

import pytest
from tests.coded import raises

from cartwheel.codes.files import FILE_MISSING
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


def missing(workspace, *includes, more=""):
    """The error for a robot that first includes a file of the package laser_x."""
    file = workspace / "mine" / "urdf" / "robot.xacro"
    file.write_text(XACRO.format("".join(INCLUDE.format(each) for each in includes) + more))
    with raises(FILE_MISSING, DescriptionError, kind="package", name="laser_x") as caught:
        load_robot(file)
    return caught.value


def others(workspace, *includes, more=""):
    return missing(workspace, *includes, more=more).values.get("others", ())


def test_all_are_named_at_once(workspace):
    (workspace / "yours" / "urdf" / "arm.xacro").write_text(
        XACRO.format('<link name="a"><mesh filename="package://grip_y/m.stl"/></link>')
    )
    (workspace / "mine" / "urdf" / "base.xacro").write_text(
        XACRO.format(INCLUDE.format("$(find imu_z)/imu.xacro"))
    )
    found = others(
        workspace,
        "$(find laser_x)/laser.xacro",
        "$(find yours)/urdf/arm.xacro",
        "base.xacro",
    )
    assert found == ("imu_z", "grip_y")


def test_what_stands_in_a_comment_is_not_named(workspace):
    comment = "<!-- $(find grip_y) -->"
    assert others(workspace, "$(find laser_x)/a.xacro", more=comment) == ()


@pytest.mark.wording
def test_the_hint_names_them_and_how_to_get_them(workspace, monkeypatch):
    one = missing(workspace, "$(find laser_x)/a.xacro").hint
    assert "Install the package with apt" in one
    assert "Also missing" not in one
    both = ("$(find laser_x)/a.xacro", "$(find grip_y)/b.xacro")
    assert "Also missing: grip_y. Install the packages with apt" in missing(workspace, *both).hint
    monkeypatch.setenv("ROS_DISTRO", "noetic")
    command = "sudo apt install ros-noetic-laser-x ros-noetic-grip-y. Or"
    assert command in missing(workspace, *both).hint


def test_files_that_include_each_other_end_the_search(workspace):
    for one, other in (("a", "b"), ("b", "a")):
        (workspace / "mine" / "urdf" / f"{one}.xacro").write_text(
            XACRO.format(INCLUDE.format(f"{other}.xacro"))
        )
    assert others(workspace, "$(find laser_x)/l.xacro", "a.xacro") == ()
