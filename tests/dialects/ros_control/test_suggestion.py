"""Which files are offered to a robot whose controllers nobody starts."""

import pytest
from tests.dialects.ros_control.arms import ROS1, beam, robot, ros2_joint, ros2_plugin, transmission
from tests.dialects.ros_control.arms import ros2_system as system

from cartwheel.description import load_robot
from cartwheel.dialects.ros_control.selection import selection_near
from cartwheel.dialects.ros_control.suggestion import suggested

ROS1_FILE = """
c:
  type: position_controllers/JointPositionController
  joint: beam_joint
"""
ROS2_FILE = """
controller_manager:
  ros__parameters:
    c: {type: position_controllers/JointGroupPositionController}
c:
  ros__parameters:
    joints: ["$(var prefix)beam_joint"]
"""
OTHERS = """
controller_manager:
  ros__parameters:
    c: {type: position_controllers/JointGroupPositionController}
c:
  ros__parameters:
    joints: [another]
"""


@pytest.fixture
def workspace(tmp_path):
    """A package with the robot, and one beside it with files of both ROS."""
    for name in ("arm_description", "arm_bringup"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "package.xml").write_text(f"<package><name>{name}</name></package>")
    config = tmp_path / "arm_bringup" / "config"
    config.mkdir()
    for name, text in (("one", ROS1_FILE), ("two", ROS2_FILE), ("others", OTHERS)):
        (config / f"{name}.yaml").write_text(text)
    return tmp_path


def names(workspace, text):
    path = workspace / "arm_description" / "arm.urdf"
    path.write_text(text)
    return [file.name for file in suggested(load_robot(path))]


def test_a_robot_of_ros_control_gets_the_file_of_its_joints(workspace):
    text = robot(beam("beam", "world") + transmission("beam_joint", "Position"), ROS1)
    assert names(workspace, text) == ["one.yaml"]


def test_files_outside_folders_named_config_are_offered_if_there_are_no_others(workspace):
    text = robot(beam("beam", "world") + transmission("beam_joint", "Position"), ROS1)
    own = workspace / "arm_description"
    for folder in ("launch", "build"):
        (own / folder).mkdir()
        (own / folder / f"{folder}.yaml").write_text(ROS1_FILE)
    (own / "launch" / "joints.yaml").write_text("angles: {another: 1}")
    assert names(workspace, text) == ["one.yaml"]
    (workspace / "arm_bringup" / "config" / "one.yaml").unlink()
    assert names(workspace, text) == ["launch.yaml"]


def test_controllers_of_the_own_package_are_those_of_the_robot(workspace):
    """Other robots in the packages beside it have joints with equal names."""
    text = robot(beam("beam", "world") + transmission("beam_joint", "Position"), ROS1)
    broadcaster = "s:\n  type: joint_state_controller/JointStateController\n"
    (workspace / "arm_bringup" / "config" / "states.yaml").write_text(broadcaster)
    own = workspace / "arm_description" / "config"
    own.mkdir()
    (own / "own.yaml").write_text(ROS1_FILE)
    assert sorted(names(workspace, text)) == ["own.yaml", "states.yaml"]
    # A file that only publishes states is not enough.
    (own / "own.yaml").write_text(broadcaster)
    assert sorted(names(workspace, text)) == ["one.yaml", "own.yaml", "states.yaml"]


def test_states_of_a_package_without_controllers_for_the_robot_are_of_another_robot(workspace):
    """A workspace contains packages of many robots, and such a controller fits each of them."""
    lone = workspace / "other_robot"
    (lone / "config").mkdir(parents=True)
    (lone / "package.xml").write_text("<package><name>other_robot</name></package>")
    states = "s:\n  type: joint_state_controller/JointStateController\n"
    (lone / "config" / "states.yaml").write_text(states)
    text = robot(beam("beam", "world") + transmission("beam_joint", "Position"), ROS1)
    assert names(workspace, text) == ["one.yaml"]
    (workspace / "arm_bringup" / "config" / "one.yaml").unlink()
    assert names(workspace, text) == []


def test_a_joint_after_an_argument_of_the_launch_file_is_one_of_the_robots(workspace):
    with_argument = ROS1_FILE.replace("beam_joint", "$(arg prefix)_joint")
    (workspace / "arm_bringup" / "config" / "one.yaml").write_text(with_argument)
    text = robot(beam("beam", "world") + transmission("beam_joint", "Position"), ROS1)
    assert names(workspace, text) == ["one.yaml"]
    # The name after the argument must end the name of a joint.
    other = with_argument.replace("_joint", "_hinge")
    (workspace / "arm_bringup" / "config" / "one.yaml").write_text(other)
    assert names(workspace, text) == []


@pytest.mark.parametrize("own", ["", "gone.yaml"])
def test_so_does_one_of_ros2_control_that_names_no_file_or_one_that_is_not_there(workspace, own):
    body = beam("beam", "world") + system(ros2_joint("beam_joint"))
    assert names(workspace, robot(body, ros2_plugin(own))) == ["two.yaml"]


def test_one_that_names_its_files_needs_no_others(workspace):
    body = beam("beam", "world") + system(ros2_joint("beam_joint"))
    own = workspace / "arm_bringup" / "config" / "two.yaml"
    assert names(workspace, robot(body, ros2_plugin(own))) == []


def test_without_a_manager_nothing_could_be_started(workspace):
    body = beam("beam", "world") + system(ros2_joint("beam_joint"))
    assert names(workspace, robot(body, "")) == []


def test_controllers_of_wheels_that_a_plugin_drives_would_hold_them(workspace):
    drive = """<plugin name="d" filename="libgazebo_ros_diff_drive.so">
      <leftJoint>beam_joint</leftJoint></plugin>"""
    body = beam("beam", "world") + transmission("beam_joint", "Position")
    assert names(workspace, robot(body, ROS1 + drive)) == []
    # A launch file loads them also in Gazebo, together with the gains of joints.
    file = workspace / "arm_bringup" / "config" / "one.yaml"
    loaded = load_robot(workspace / "arm_description" / "arm.urdf")
    assert suggested(loaded, among=[file]) == [file]


@pytest.mark.parametrize(
    "joints",
    [
        '["$(var prefix)beam_joint"]',
        '["$(var prefix) beam_joint"]',
        r'["beam\x5fjoint"]',
        "[beam_joint]",
    ],
)
def test_a_name_is_found_however_it_is_written(workspace, joints):
    (workspace / "arm_bringup" / "config" / "others.yaml").write_text(
        OTHERS.replace("[another]", joints)
    )
    text = robot(
        beam("left beam", "world") + beam("beam", "world") + system(ros2_joint("beam_joint")),
        ros2_plugin(),
    )
    assert "others.yaml" in names(workspace, text)


@pytest.mark.parametrize("joints", ["[]", '["$(var prefix)finger"]'])
def test_a_file_for_other_joints_is_not_offered(workspace, joints):
    (workspace / "arm_bringup" / "config" / "others.yaml").write_text(
        OTHERS.replace("[another]", joints)
    )
    text = robot(beam("beam", "world") + system(ros2_joint("beam_joint")), ros2_plugin())
    assert "others.yaml" not in names(workspace, text)


@pytest.mark.parametrize("commands", [False, True])
def test_a_launch_file_of_another_part_counts_if_it_starts_controllers_of_the_joints(
    workspace, commands
):
    """Many packages start the controller that publishes all joint states in a file of its own."""
    bringup = workspace / "arm_bringup"
    (bringup / "config" / "states.yaml").write_text(
        "s:\n  type: joint_state_controller/JointStateController\n"
    )
    (bringup / "launch").mkdir()
    loads = "".join(
        f'<rosparam file="$(find arm_bringup)/config/{name}.yaml"/>'
        for name in ["states"] + ["one"] * commands
    )
    (bringup / "launch" / "states.launch").write_text(
        f'<launch>{loads}<node name="n" pkg="controller_manager" type="spawner" args="s"/></launch>'
    )
    path = workspace / "arm_description" / "arm.urdf"
    path.write_text(robot(beam("beam", "world") + transmission("beam_joint", "Position"), ROS1))
    selected = selection_near(load_robot(path))
    assert {file.name for file in selected.files} == {"states.yaml", "one.yaml"}
    assert selected.names == (("s",) if commands else ())


@pytest.mark.parametrize(
    "stated",
    ["/home/author/ws/install/share/arm_description/config/own.yaml", "config/own.yaml"],
)
def test_a_file_that_is_stated_for_another_computer_is_enough(workspace, stated):
    """The manager takes it from the description's package, so no others are offered."""
    own = workspace / "arm_description" / "config"
    own.mkdir()
    plugin = ros2_plugin(stated)
    text = robot(beam("beam", "world") + system(ros2_joint("beam_joint", ["position"])), plugin)
    assert names(workspace, text) == ["two.yaml"]
    (own / "own.yaml").write_text(ROS2_FILE)
    assert names(workspace, text) == []
