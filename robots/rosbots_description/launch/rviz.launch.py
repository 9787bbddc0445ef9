"""Shows the robot of a running simulation in RViz.

Without a simulation, move the joints with the sliders of joint_state_publisher_gui:
ros2 launch rosbots_description rviz.launch.py sliders:=true
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import (
    Command,
    EqualsSubstitution,
    LaunchConfiguration,
    PathJoinSubstitution,
)
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description() -> LaunchDescription:
    share = FindPackageShare("rosbots_description")
    sliders = LaunchConfiguration("sliders")
    model = PathJoinSubstitution([share, "urdf", "rosbots.xacro"])
    description = ParameterValue(Command(["xacro ", model]), value_type=str)
    simulated = EqualsSubstitution(sliders, "false")
    return LaunchDescription(
        [
            DeclareLaunchArgument("sliders", default_value="false"),
            DeclareLaunchArgument(
                "rvizconfig",
                default_value=PathJoinSubstitution([share, "rviz", "rosbots_ros2.rviz"]),
            ),
            # Only without a simulation, which publishes the joint states of the wheels itself.
            Node(
                package="joint_state_publisher_gui",
                executable="joint_state_publisher_gui",
                condition=IfCondition(sliders),
            ),
            # Without a simulation, there is no odometry, so odom is placed at the robot.
            Node(
                package="tf2_ros",
                executable="static_transform_publisher",
                arguments=["--frame-id", "odom", "--child-frame-id", "base_footprint"],
                condition=IfCondition(sliders),
            ),
            # While this node runs, Cartwheel does not publish the description and transforms.
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[{"robot_description": description, "use_sim_time": simulated}],
            ),
            Node(
                package="rviz2",
                executable="rviz2",
                arguments=["-d", LaunchConfiguration("rvizconfig")],
                parameters=[{"use_sim_time": simulated}],
            ),
        ]
    )
