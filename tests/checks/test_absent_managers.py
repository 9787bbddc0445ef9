"""Controllers that a launch file starts for a robot that has no controller manager in Gazebo."""

import pytest
from tests.dialects.ros_control.arms import beam, robot, ros2_joint, ros2_system, transmission

import cartwheel
from cartwheel.codes.devices import HARDWARE_WITHOUT_PLUGIN
from cartwheel.corpus import try_robot

SPAWN = (
    'Node(package="gazebo_ros", executable="spawn_entity.py", '
    'arguments=["-topic", "robot_description", "-entity", "arm"])'
)
WRAPPER = SPAWN.replace("gazebo_ros", "arm").replace("spawn_entity.py", "spawn_arm")
CONTROLLER = (
    'Node(package="controller_manager", executable="spawner", arguments=["arm_controller"])'
)
COMMAND = 'ExecuteProcess(cmd=["ros2", "control", "load_controller", "--set-state", "active", "a"])'
GAZEBO = 'get_package_share_directory("gazebo_ros") + "/launch/gazebo.launch.py"'
MANAGER = 'Node(package="controller_manager", executable="ros2_control_node")'
OTHER = 'IncludeLaunchDescription(get_package_share_directory("other_arm") + "/arm.launch.py")'
SECOND = (
    'Node(package="robot_state_publisher", executable="robot_state_publisher", namespace="b", '
    'parameters=[{"robot_description": Command(["xacro ", share + "/other.urdf"])}])'
)
LAUNCH = """
def generate_launch_description():
    share = get_package_share_directory("arm")
    return LaunchDescription([
        IncludeLaunchDescription(PythonLaunchDescriptionSource({gazebo})),
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{{"robot_description": Command(["xacro ", share + "/arm.urdf"])}}]),
        {nodes},
    ])
"""
UNKNOWN = '<plugin filename="libmy_mover.so" name="m"/>'


def package(folder, nodes, plugin="", gazebo=GAZEBO, part=""):
    (folder / "launch").mkdir()
    (folder / ".gitignore").write_text("")
    (folder / "package.xml").write_text(
        "<package><name>arm</name><buildtool_depend>ament_cmake</buildtool_depend></package>"
    )
    text = robot(beam("beam", "world") + part, plugin)
    (folder / "arm.urdf").write_text(text)
    (folder / "other.urdf").write_text(text)
    (folder / "launch" / "gazebo.launch.py").write_text(
        LAUNCH.format(gazebo=gazebo, nodes=", ".join(nodes))
    )
    return folder / "arm.urdf"


def found(path):
    return [e for e in cartwheel.check(path).findings if e.code is HARDWARE_WITHOUT_PLUGIN]


@pytest.mark.parametrize(
    ("nodes", "more", "reported"),
    [
        ((SPAWN, CONTROLLER), {}, True),
        ((SPAWN, CONTROLLER), {"part": transmission("beam_joint", "Effort")}, True),
        ((WRAPPER, COMMAND), {}, True),
        # Nothing spawns the robot: it may be a model of the world.
        ((CONTROLLER,), {}, False),
        ((SPAWN, CONTROLLER.replace("arm_controller", "joint_state_broadcaster")), {}, False),
        ((SPAWN, CONTROLLER, MANAGER), {}, False),
        # These may contain the controller manager, or another robot with one.
        ((SPAWN, CONTROLLER, OTHER), {}, False),
        ((SPAWN, CONTROLLER, SECOND), {}, False),
        ((SPAWN, CONTROLLER), {"plugin": UNKNOWN}, False),
    ],
)
def test_controllers_whose_joints_are_unknown_need_a_manager(tmp_path, nodes, more, reported):
    path = package(tmp_path, nodes, **more)
    assert len(found(path)) == reported
    verdict = try_robot(path, standing=1.0)
    faults = [(e.test, e.source) for e in verdict.faults if e.code is HARDWARE_WITHOUT_PLUGIN]
    assert faults == [("controller", "file")] * reported
    assert not reported or (verdict.outcome == "file" and verdict.should_move)


def test_the_launch_file_that_spawns_the_robot_counts_beside_one_with_a_manager(tmp_path):
    path = package(tmp_path, (SPAWN, CONTROLLER))
    (tmp_path / "arm.yaml").write_text("controller_manager: {ros__parameters: {update_rate: 50}}")
    manager = MANAGER.replace("_node", '_node", parameters=[share + "/arm.yaml"], name="m', 1)
    (tmp_path / "launch" / "real.launch.py").write_text(
        LAUNCH.format(gazebo=GAZEBO, nodes=", ".join((manager, CONTROLLER)))
    )
    assert len(found(path)) == 1


def test_hardware_of_gazebo_without_its_plugin_is_reported_once(tmp_path):
    path = package(tmp_path, (SPAWN, CONTROLLER), part=ros2_system(ros2_joint("beam_joint")))
    assert len(found(path)) == 1


def test_the_launch_file_of_gazebo_is_not_that_of_the_robot_with_the_same_name(tmp_path):
    """Without gazebo_ros, the robot's package does not stand for it."""
    package(tmp_path, (SPAWN, CONTROLLER))
    text = LAUNCH.format(gazebo=GAZEBO, nodes=SPAWN).replace("arm.urdf", "other.urdf")
    (tmp_path / "launch" / "other.launch.py").write_text(text)
    assert not found(tmp_path / "other.urdf")
    assert try_robot(tmp_path / "other.urdf", standing=1.0).launch.spawned == ()
