"""Launch files that start a robot in Gazebo together with the driver of a real one."""

import pytest

from cartwheel.description.launches import chosen, launches_near

LAUNCH = """from launch import LaunchDescription
from launch.substitutions import Command
from launch_ros.actions import Node

FILE = get_package_share_directory('arm') + '/arm.urdf.xacro'


def generate_launch_description():
    return LaunchDescription([
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             namespace='real',
             parameters=[{{'robot_description': Command(['xacro ', FILE, ' sim:=false'])}}]),
        Node(package='controller_manager', executable='ros2_control_node', namespace='real'),
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             namespace='gz',
             parameters=[{{'robot_description': Command(['xacro ', FILE, ' sim:=true'])}}]),
        Node(package='ros_gz_sim', executable='create', namespace='gz',
             arguments=['-topic', '{topic}']),
    ])
"""


@pytest.fixture
def arm(tmp_path):
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "arm.urdf.xacro").write_text('<robot name="arm"><link name="base"/></robot>')
    (tmp_path / "launch").mkdir()
    return tmp_path


@pytest.mark.parametrize(
    ("topic", "simulated", "sim"),
    [
        ("robot_description", {"true": True, "false": False}, "true"),
        ("/real/robot_description", {"true": False, "false": True}, "false"),
        # It is unknown which one is spawned.
        ("description", {"true": True, "false": True}, "false"),
    ],
)
def test_of_two_descriptions_the_one_that_is_spawned_is_chosen(arm, topic, simulated, sim):
    (arm / "launch/sim.launch.py").write_text(LAUNCH.format(topic=topic))
    found = launches_near(arm)
    assert {each.arguments["sim"]: each.simulated for each in found} == simulated
    assert {each.managers for each in found} == {frozenset({"real"})}
    use = chosen(arm / "arm.urdf.xacro", found)
    assert use is not None
    assert use.arguments == {"sim": sim}


def test_other_robots_of_the_launch_file_are_those_that_are_spawned(arm):
    """An argument is in the name of the file, of which there is one for each robot."""
    for name in ("small", "large"):
        text = f'<robot name="{name}"><link name="base"/></robot>'
        (arm / f"arm_{name}.urdf.xacro").write_text(text)
    text = LAUNCH.format(topic="robot_description")
    name = "LaunchConfiguration('model')"
    parts = f"'xacro ', get_package_share_directory('arm'), '/arm_', {name}, '.urdf.xacro"
    declared = "DeclareLaunchArgument('model', default_value='small'),"
    text = text.replace("'xacro ', FILE, '", parts).replace("([\n", f"([\n        {declared}\n", 1)
    (arm / "launch/sim.launch.py").write_text(text)
    found = launches_near(arm)
    for robot in ("small", "large"):
        use = chosen(arm / f"arm_{robot}.urdf.xacro", found)
        assert use is not None
        assert (use.arguments, use.simulated) == ({"sim": "true"}, True)
