"""Plugins that exist only in ROS 1 or only in ROS 2."""

import pytest
from tests.corpus.carts import cart, controlled, plugin, written

import cartwheel
from cartwheel.codes.devices import (
    CONTROLLERS_NOT_FOUND,
    PLUGIN_OF_OTHER_ROS,
    PLUGIN_PARAMETER_OBSOLETE,
)
from cartwheel.corpus import try_robot
from cartwheel.dialects.catalogue import PLUGINS
from cartwheel.dialects.ros_only import _REPLACEMENTS

CATKIN = "<buildtool_depend>catkin</buildtool_depend>"
AMENT = "<export><build_type>ament_cmake</build_type></export>"
BOTH = (
    '<depend condition="$ROS_VERSION == 1">roscpp</depend>'
    '<depend condition="$ROS_VERSION == 2">rclcpp</depend>'
)
BODY = (
    '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" '
    'ixy="0" ixz="0" iyz="0"/></inertial>'
    '<collision><geometry><box size="1 1 0.1"/></geometry></collision>'
)
ARM = (
    f'<link name="base">{BODY}</link><link name="arm">{BODY.replace("0.1", "0.2")}</link>'
    '<joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/>'
    '<origin xyz="0 0 1"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="9" velocity="1"/>'
    '</joint><transmission name="t"><type>transmission_interface/SimpleTransmission</type>'
    '<joint name="shoulder"><hardwareInterface>hardware_interface/PositionJointInterface'
    '</hardwareInterface></joint><actuator name="m"/></transmission>'
)

FIXED = (
    '<link name="world"/><joint name="floor" type="fixed"><parent link="world"/>'
    '<child link="base"/></joint>'
)


def robot(tmp_path, filename, stated, more=""):
    folder = tmp_path / "repository" / "arm"
    (folder / "urdf").mkdir(parents=True)
    (tmp_path / "repository" / ".git").mkdir()
    (folder / "package.xml").write_text(f"<package><name>arm</name>{stated}</package>")
    path = folder / "urdf" / "arm.urdf"
    plugin = f'<gazebo><plugin name="p" filename="{filename}">{more}</plugin></gazebo>'
    path.write_text(f'<robot name="arm">{ARM}{plugin}</robot>')
    return path


def found(path):
    return [each for each in cartwheel.check(path).findings if each.code is PLUGIN_OF_OTHER_ROS]


@pytest.mark.parametrize(
    ("filename", "stated", "ros"),
    [
        ("libgazebo_ros_control.so", AMENT, 2.0),
        ("libgazebo_ros_control.so", "<buildtool_depend>ament_cmake</buildtool_depend>", 2.0),
        ("libgazebo_ros_control.so", CATKIN, None),
        ("libgazebo_ros_control.so", CATKIN + AMENT, None),
        ("libgazebo_ros_control.so", f"{CATKIN}{AMENT}<depend>rclcpp</depend>", 2.0),
        ("libgazebo_ros2_control.so", f"{CATKIN}{AMENT}<run_depend>rospy</run_depend>", 1.0),
        ("libgazebo_ros_control.so", f"{CATKIN}{AMENT}{BOTH}", None),
        ("libgazebo_ros2_control.so", f"{CATKIN}{AMENT}{BOTH}", None),
        ("libgazebo_ros_control.so", f"{CATKIN}<depend>rclcpp</depend>", None),
        ("libgazebo_ros_control.so", f"<!-- {CATKIN} -->", None),
        ("libgazebo_ros_control.so", f"{CATKIN}<!-- {AMENT} -->", None),
        ("libgazebo_ros2_control.so", CATKIN, 1.0),
        ("libgazebo_ros2_control.so", AMENT, None),
        # In both versions
        ("libgazebo_ros_diff_drive.so", AMENT, None),
        ("libsomeones_own_control.so", AMENT, None),
    ],
)
def test_a_plugin_of_the_other_version_is_reported(tmp_path, filename, stated, ros):
    reported = found(robot(tmp_path, filename, stated))
    assert [each.values["ros"] for each in reported] == ([] if ros is None else [ros])


def test_a_plugin_that_the_repository_builds_is_not_reported(tmp_path):
    path = robot(tmp_path, "libgazebo_ros_range.so", AMENT)
    assert found(path)
    other = tmp_path / "repository" / "plugins"
    other.mkdir()
    (other / "package.xml").write_text("<package><name>plugins</name></package>")
    (other / "CMakeLists.txt").write_text("add_library(gazebo_ros_range SHARED src/range.cpp)")
    assert not found(path)


def test_a_manager_of_the_other_version_is_why_no_controller_starts(tmp_path):
    path = robot(tmp_path, "libgazebo_ros_control.so", AMENT)
    codes = {each.code for each in cartwheel.check(path).findings}
    assert PLUGIN_OF_OTHER_ROS in codes
    assert CONTROLLERS_NOT_FOUND not in codes
    (fault,) = [each for each in try_robot(path, standing=0.5).faults if each.test == "controller"]
    assert (fault.code, fault.source) == (PLUGIN_OF_OTHER_ROS, "file")


def test_a_manager_of_the_other_version_comes_before_missing_transmissions(tmp_path):
    path = robot(tmp_path, "libgazebo_ros_control.so", AMENT)
    text = path.read_text()
    start, end = text.index("<transmission"), text.index("</transmission>")
    path.write_text(text[:start] + text[end + len("</transmission>") :])
    (fault,) = [each for each in try_robot(path, standing=0.5).faults if each.test == "controller"]
    assert fault.code is PLUGIN_OF_OTHER_ROS


COMMANDED = """robot:
  states: {type: joint_state_controller/JointStateController, publish_rate: 50}
  shoulder_position: {type: position_controllers/JointPositionController, joint: shoulder}
"""


@pytest.mark.parametrize(("stated", "wrong"), [(AMENT, True), (CATKIN, False)])
def test_a_manager_of_the_other_version_moves_nothing_in_gazebo(tmp_path, stated, wrong):
    """Its controllers work in Cartwheel, which runs both managers."""
    space = "<robotNamespace>robot</robotNamespace>"
    path = robot(tmp_path, "libgazebo_ros_control.so", stated, space)
    (path.parents[1] / "config").mkdir()
    (path.parents[1] / "config" / "arm.yaml").write_text(COMMANDED)
    path.write_text(path.read_text().replace('<link name="base">', FIXED + '<link name="base">', 1))
    verdict = try_robot(path, standing=0.5)
    assert [each.arrived for each in verdict.reaches] == [True]
    expected = [("controller", PLUGIN_OF_OTHER_ROS, "file")] if wrong else []
    assert [(each.test, each.code, each.source) for each in verdict.faults] == expected


def test_a_manager_of_the_other_version_beside_one_that_drives_is_no_fault(tmp_path):
    (tmp_path / "package.xml").write_text(f"<package><name>cart</name>{AMENT}</package>")
    other = '<gazebo><plugin name="o" filename="libgazebo_ros_control.so"/></gazebo>'
    path = written(tmp_path, cart(), controlled(tmp_path), other)
    assert found(path)
    assert try_robot(path, standing=1.0).good


def test_a_drive_of_the_other_version_moves_nothing_in_gazebo(tmp_path):
    (tmp_path / "package.xml").write_text(f"<package><name>cart</name>{AMENT}</package>")
    names = "".join(
        f"<{side}{end}Joint>{side}_joint</{side}{end}Joint>"
        for side in ("left", "right")
        for end in ("Front", "Rear")
    )
    drive = plugin(more=names).replace("_diff_drive.so", "_skid_steer_drive.so")
    (fault,) = try_robot(written(tmp_path, cart(), drive), standing=1.0).faults
    assert (fault.test, fault.code, fault.source) == ("plugin", PLUGIN_OF_OTHER_ROS, "file")


def test_plugins_of_one_version_are_simulated_or_unknown():
    """No name is misspelt: most of these are plugins that Cartwheel simulates."""
    names = {name for each in _REPLACEMENTS.values() for name in each}
    unknown = {"gazebo_ros_f3d", "gazebo_ros_prosilica", "gazebo_ros_triggered_camera"}
    assert names - set(PLUGINS) <= unknown | {"gazebo_ros_triggered_multicamera"}


OLD = "<leftJoint>l_wheel</leftJoint><rightJoint>r_wheel</rightJoint>"
NEW = "<left_joint>l_wheel</left_joint><right_joint>r_wheel</right_joint>"
DEFAULT = "<left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>"
ROS = "<ros><namespace>bot</namespace></ros>"


@pytest.mark.parametrize(
    ("stated", "tags", "wrong"),
    [
        (AMENT, OLD, "leftJoint"),
        (AMENT, NEW, None),
        (AMENT, OLD + NEW, None),
        (CATKIN, NEW, "left_joint"),
        (CATKIN, ROS + NEW, "left_joint"),
        (CATKIN, OLD, None),
        # In ROS 1, the wheels have these names without a tag.
        (CATKIN, DEFAULT, None),
        ("", ROS + OLD, "leftJoint"),
        ("", OLD, None),
        ("", NEW, None),
    ],
)
def test_tags_of_the_other_version_are_reported(tmp_path, stated, tags, wrong):
    path = robot(tmp_path, "libgazebo_ros_diff_drive.so", stated, tags)
    assert [each.values["tag"] for each in found(path)] == ([wrong] if wrong else [])


@pytest.mark.parametrize("version", [1, 2])
def test_a_drive_with_the_tags_of_the_other_version_does_not_drive_in_gazebo(tmp_path, version):
    folder = tmp_path / "cart"
    folder.mkdir()
    stated = CATKIN if version == 1 else AMENT
    (folder / "package.xml").write_text(f"<package><name>cart</name>{stated}</package>")
    parts = cart().replace("left_joint", "l_wheel").replace("right_joint", "r_wheel")
    drive = plugin().replace("left_joint", "l_wheel").replace("right_joint", "r_wheel")
    verdict = try_robot(written(folder, parts, drive), standing=1.0)
    (driven,) = verdict.drives
    assert driven.passes
    wrong = [("plugin", PLUGIN_OF_OTHER_ROS, "file")] if version == 2 else []
    assert [(each.test, each.code, each.source) for each in verdict.faults] == wrong


@pytest.mark.parametrize(
    ("stated", "joint", "more", "tag"),
    [
        (AMENT, "left_joint", "", "max_wheel_torque"),
        (CATKIN, "leftJoint", "", "wheelTorque"),
        # The tags decide if the version of the package is unknown.
        ("", "left_joint", "", "max_wheel_torque"),
        ("", "leftJoint", "", "wheelTorque"),
        ("", "leftJoint", "<ros><namespace>/a</namespace></ros>", "max_wheel_torque"),
    ],
)
def test_the_tag_in_place_of_an_obsolete_one_is_that_of_the_version(
    tmp_path, *, stated, joint, more, tag
):
    tags = f"<{joint}>shoulder</{joint}><torque>20</torque>{more}"
    path = robot(tmp_path, "libgazebo_ros_diff_drive.so", stated, tags)
    (one,) = [e for e in cartwheel.check(path).findings if e.code is PLUGIN_PARAMETER_OBSOLETE]
    assert one.instead == f"<{tag}>20</{tag}>"
