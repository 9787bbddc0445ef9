"""Plugins of Gazebo Classic in robots that are started in gz-sim, and the other way round."""

import pytest
from tests.corpus.carts import cart, plugin

from cartwheel.checks.checking import check
from cartwheel.codes.devices import PLUGIN_OF_OTHER_GAZEBO
from cartwheel.corpus import try_robot

LAUNCH = """<launch>
  <node pkg="robot_state_publisher" exec="robot_state_publisher">
    <param name="robot_description" value="$(command 'xacro $(find-pkg-share cart)/cart.urdf')"/>
  </node>
  <node pkg="{package}" exec="{spawner}" args="-topic robot_description"/>
</launch>
"""
GZ = {"package": "ros_gz_sim", "spawner": "create"}
CLASSIC = {"package": "gazebo_ros", "spawner": "spawn_entity.py"}
BARE = '<gazebo><plugin name="p" filename="{}">{}</plugin></gazebo>'
DRIVE = BARE.format(
    "gz-sim-diff-drive-system",
    "<left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>"
    "<wheel_separation>0.2</wheel_separation><wheel_radius>0.05</wheel_radius>",
)
CAMERA = (
    '<gazebo reference="base"><sensor name="c" type="camera">'
    '<plugin name="p" filename="libgazebo_ros_camera.so"><imageTopicName>i</imageTopicName>'
    "</plugin></sensor></gazebo>"
)


def robot(tmp_path, text, *launches):
    """A cart whose launch files start it in Gazebo."""
    folder = tmp_path / "cart"
    (folder / "launch").mkdir(parents=True)
    (folder / ".git").mkdir()
    (folder / "package.xml").write_text("<package><name>cart</name></package>")
    for number, launch in enumerate(launches):
        written = folder / "launch" / f"sim{number}.launch.xml"
        written.write_text(LAUNCH.format(**launch))
    path = folder / "cart.urdf"
    path.write_text(f'<robot name="cart">{cart()}{text}</robot>')
    return path


def found(path):
    return [each for each in check(path).findings if each.code is PLUGIN_OF_OTHER_GAZEBO]


@pytest.mark.parametrize(
    ("launches", "text", "expected"),
    [
        ([GZ], plugin(), ["warning"]),
        ([CLASSIC], plugin(), []),
        ([GZ, CLASSIC], plugin(), []),
        ([], plugin(), []),
        ([CLASSIC], DRIVE, ["warning"]),
        ([GZ], DRIVE, []),
        # Each Gazebo has its own plugin.
        ([GZ], DRIVE + plugin(), ["info"]),
        ([], DRIVE + plugin(), []),
        ([GZ], DRIVE + CAMERA, ["warning"]),
        ([GZ], BARE.format("libgazebo_ros_joint_state_publisher.so", "") + DRIVE, ["warning"]),
        # Perhaps built for gz-sim
        ([GZ], BARE.format("libgazebo_own_plugin.so", ""), []),
    ],
)
def test_a_plugin_that_the_started_gazebo_does_not_load(tmp_path, launches, text, expected):
    assert [each.severity for each in found(robot(tmp_path, text, *launches))] == expected


def test_a_robot_with_plugins_of_both_is_for_what_the_repository_starts(tmp_path):
    path = robot(tmp_path, DRIVE + CAMERA, GZ)
    other = path.with_name("other.urdf")
    other.write_text(path.read_text())
    assert found(other)
    other.write_text(path.read_text().replace(DRIVE, ""))
    assert not found(other)


def test_a_plugin_that_the_repository_builds_is_loaded(tmp_path):
    path = robot(tmp_path, plugin(), GZ)
    (path.parent / "CMakeLists.txt").write_text("add_library(gazebo_ros_diff_drive SHARED d.cc)")
    assert not found(path)


@pytest.mark.parametrize("launch", [GZ, CLASSIC])
def test_nothing_is_said_of_what_is_in_a_plugin_that_is_not_loaded(tmp_path, launch):
    wrong = plugin(separation=0.4, more="<noSuchTag>1</noSuchTag>")
    path = robot(tmp_path, wrong.replace(">left_joint<", ">no_such_joint<"), launch)
    codes = {each.code for each in check(path).findings if each.severity != "info"}
    assert (codes == {PLUGIN_OF_OTHER_GAZEBO}) is (launch is GZ)


@pytest.mark.wording
@pytest.mark.parametrize(
    ("launch", "text", "hint"),
    [
        (
            GZ,
            plugin(),
            'In gz-sim, write <plugin name="gz::sim::systems::DiffDrive" '
            'filename="gz-sim-diff-drive-system"><left_joint>left_joint</left_joint>'
            "<right_joint>right_joint</right_joint><wheel_separation>0.2</wheel_separation>"
            "<wheel_radius>0.05</wheel_radius></plugin>.",
        ),
        (
            CLASSIC,
            DRIVE,
            'In Gazebo Classic, write <plugin name="p" filename="libgazebo_ros_diff_drive.so">'
            "<left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>"
            "<wheel_separation>0.2</wheel_separation><wheel_diameter>0.1</wheel_diameter></plugin>.",
        ),
    ],
)
def test_the_advice_is_the_plugin_to_write(tmp_path, launch, text, hint):
    (finding,) = found(robot(tmp_path, text, launch))
    assert finding.hint == hint


@pytest.mark.parametrize(
    ("launch", "text", "faults"),
    [
        # The separation is wrong, but only for Gazebo Classic.
        (GZ, plugin(separation=0.4), [("plugin", PLUGIN_OF_OTHER_GAZEBO)]),
        (GZ, DRIVE + plugin(separation=0.4), []),
        (GZ, DRIVE, []),
        (CLASSIC, plugin(), []),
        (CLASSIC, DRIVE, [("plugin", PLUGIN_OF_OTHER_GAZEBO)]),
    ],
)
def test_a_plugin_that_should_move_a_robot_and_is_not_loaded(tmp_path, launch, text, faults):
    verdict = try_robot(robot(tmp_path, text, launch), standing=0.5)
    assert [(each.test, each.code) for each in verdict.faults] == faults
    assert bool(verdict.drives) is not bool(faults)


def test_a_manager_of_the_other_gazebo_starts_no_controller(tmp_path):
    control = (
        '<ros2_control name="s" type="system"><hardware><plugin>gazebo_ros2_control/GazeboSystem'
        '</plugin></hardware><joint name="left_joint"><command_interface name="velocity"/></joint>'
        "</ros2_control>" + BARE.format("libgazebo_ros2_control.so", "")
    )
    (fault,) = try_robot(robot(tmp_path, control, GZ), standing=0.5).faults
    assert (fault.test, fault.code) == ("controller", PLUGIN_OF_OTHER_GAZEBO)
