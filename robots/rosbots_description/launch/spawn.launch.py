"""Spawns the robot in a running simulation: Cartwheel with --ros2, or Gazebo with gazebo_ros.

The launch file calls /spawn_entity with `ros2 service call`, which requires gazebo_msgs but not
gazebo_ros.
"""

import json

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import Command, LaunchConfiguration, PathJoinSubstitution
from launch_ros.substitutions import FindPackageShare

ARGUMENTS = {"model": "rosbots", "x": "0", "y": "0", "z": "0"}


def spawn(context: LaunchContext) -> list[ExecuteProcess]:
    share = FindPackageShare("rosbots_description")
    model = PathJoinSubstitution([share, "urdf", "rosbots.xacro"])
    given = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    request = {
        "name": given["model"],
        "xml": Command(["xacro ", model]).perform(context),
        "initial_pose": {"position": {axis: float(given[axis]) for axis in "xyz"}},
    }
    return [
        ExecuteProcess(
            cmd=[
                "ros2",
                "service",
                "call",
                "/spawn_entity",
                "gazebo_msgs/srv/SpawnEntity",
                # JSON is valid YAML on a single line.
                json.dumps(request),
            ],
            output="screen",
        )
    ]


def generate_launch_description() -> LaunchDescription:
    return LaunchDescription(
        [
            *(
                DeclareLaunchArgument(name, default_value=value)
                for name, value in ARGUMENTS.items()
            ),
            OpaqueFunction(function=spawn),
        ]
    )
