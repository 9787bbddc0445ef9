"""Environment variables of ROS in launch files, without a sourced ROS."""

import pytest
from tests.coded import coded

from cartwheel.codes.files import ENVIRONMENT_ASSUMED
from cartwheel.description.launches import launches_near, read_launch

XML = """<launch><arg name="kind" value="{value}"/>
  <param name="robot_description" command="xacro $(find bot)/urdf/$(arg kind).xacro"/>
  <node pkg="gazebo_ros" type="spawn_model" name="s" args="-urdf -param robot_description"/>
</launch>"""
PYTHON = """import os
def generate_launch_description():
    return LaunchDescription([
        Node(package="gazebo_ros", executable="spawn_entity.py", arguments=[
            "-file", os.path.join(get_package_share_directory("bot"), "urdf", {value})])])
"""
JOINED = """def generate_launch_description():
    return LaunchDescription([
        Node(package="gazebo_ros", executable="spawn_entity.py", arguments=["-file", [
            FindPackageShare("bot"), "/urdf/", EnvironmentVariable("ROS_DISTRO"), ".xacro"]])])
"""


@pytest.fixture
def started(tmp_path, monkeypatch):
    for name in ("ROS_DISTRO", "ROS_VERSION"):
        monkeypatch.delenv(name, raising=False)
    folder = tmp_path / "bot"
    (folder / "urdf").mkdir(parents=True)
    (folder / "launch").mkdir()
    (folder / "package.xml").write_text("<package><name>bot</name></package>")
    for name in ("noetic", "humble", "foxy"):
        text = '<robot name="bot"><link name="base"/></robot>'
        (folder / "urdf" / f"{name}.xacro").write_text(text)

    def run(name, text):
        file = folder / "launch" / name
        file.write_text(text)
        start = read_launch(file, {})
        return start.models[0].description.stem, coded(start, ENVIRONMENT_ASSUMED)

    return run


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("sim.launch", XML.format(value="$(env ROS_DISTRO)"), "noetic"),
        ("sim.launch", XML.format(value="$(optenv ROS_DISTRO foxy)"), "noetic"),
        ("sim.launch", XML.format(value="$(eval env('ROS_DISTRO'))"), "noetic"),
        ("sim.launch.xml", XML.format(value="$(env ROS_DISTRO)"), "humble"),
        ("sim.launch.py", PYTHON.format(value='os.environ["ROS_DISTRO"] + ".xacro"'), "humble"),
        ("sim.launch.py", PYTHON.format(value='os.getenv("ROS_DISTRO") + ".xacro"'), "humble"),
        (
            "sim.launch.py",
            PYTHON.format(
                value='"foxy.xacro" if os.environ.get("ROS_DISTRO") == "foxy" else "humble.xacro"'
            ),
            "humble",
        ),
        (
            "sim.launch.py",
            JOINED,
            "humble",
        ),
    ],
)
def test_a_variable_of_ros_has_its_value_in_the_version_of_the_file(started, name, text, expected):
    model, (note,) = started(name, text)
    assert model == expected
    assert (note.severity, note.values["name"], note.values["value"]) == (
        "info",
        "ROS_DISTRO",
        expected,
    )


def test_a_variable_that_is_set_is_used(started, monkeypatch):
    monkeypatch.setenv("ROS_DISTRO", "foxy")
    assert started("sim.launch.py", PYTHON.format(value='os.environ["ROS_DISTRO"] + ".xacro"')) == (
        "foxy",
        [],
    )


COMMAND = """<launch>
  <arg name="made" default="$(find xacro)/xacro --inorder $(env PLACE_OF_ROBOTS)/{file}"/>
  <param name="robot_description" command="$(arg made)"/>
  <node pkg="gazebo_ros" type="spawn_model" name="s" args="-urdf -param robot_description"/>
</launch>"""


@pytest.mark.parametrize(
    ("file", "found"),
    [("robots/cart.xacro", True), ("robots/other.xacro", False), ("cart.xacro", False)],
)
def test_a_folder_in_an_unset_variable_is_one_around_the_launch_file(
    tmp_path, monkeypatch, file, found
):
    monkeypatch.delenv("PLACE_OF_ROBOTS", raising=False)
    root = tmp_path / "repository"
    for name in (".git", "launch", "robots"):
        (root / name).mkdir(parents=True)
    # Outside of the repository.
    (tmp_path / "robots").mkdir()
    for path in (root / "robots" / "cart.xacro", tmp_path / "robots" / "other.xacro"):
        path.write_text('<robot name="cart"><link name="base"/></robot>')
    launch = root / "launch" / "sim.launch"
    launch.write_text(COMMAND.format(file=file))
    uses = [each for each in launches_near(root, ()) if each.description is not None]
    assert [(each.description, each.simulated) for each in uses] == (
        [(root / file, True)] if found else []
    )
