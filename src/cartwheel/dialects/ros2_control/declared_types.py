"""The types of the parameters that ROS 2's controllers declare.

Only parameters are listed that a controller declares with the same type in Humble and Jazzy, if it
exists in both. `CLASSIC` adds those that it declares only in Humble, which is the last version with
Gazebo Classic. Source: ros2_controllers.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

Type = Literal["double", "integer", "bool", "double_array", "string_array"]


def _types(
    *,
    doubles: str = "",
    integers: str = "",
    bools: str = "",
    double_lists: str = "",
    name_lists: str = "",
) -> dict[str, Type]:
    """The types by parameter. In a name, ``{joints}`` stands for each name in this parameter."""
    listed: tuple[tuple[Type, str], ...] = (
        ("double", doubles),
        ("integer", integers),
        ("bool", bools),
        ("double_array", double_lists),
        ("string_array", name_lists),
    )
    return {name: kind for kind, text in listed for name in text.split()}


_ODOMETRY = _types(
    integers="velocity_rolling_window_size",
    bools="open_loop enable_odom_tf",
    double_lists="pose_covariance_diagonal twist_covariance_diagonal",
)
_LIMITS = """
    linear.x.max_velocity linear.x.min_velocity linear.x.max_acceleration
    linear.x.min_acceleration linear.x.max_jerk linear.x.min_jerk
    angular.z.max_velocity angular.z.min_velocity angular.z.max_acceleration
    angular.z.min_acceleration angular.z.max_jerk angular.z.min_jerk
"""
_LIMITED = """
    linear.x.has_velocity_limits linear.x.has_acceleration_limits linear.x.has_jerk_limits
    angular.z.has_velocity_limits angular.z.has_acceleration_limits angular.z.has_jerk_limits
"""
_STEERING = _ODOMETRY | _types(
    doubles="reference_timeout wheelbase",
    bools="front_steering position_feedback",
    name_lists="""
        rear_wheels_names front_wheels_names rear_wheels_state_names front_wheels_state_names
        traction_joints_names steering_joints_names traction_joints_state_names
        steering_joints_state_names
    """,
)
_GRIPPER = _types(
    doubles="action_monitor_rate goal_tolerance max_effort stall_timeout stall_velocity_threshold",
    bools="allow_stalling",
)
_COMMANDS = _types(name_lists="joints")

CONTROLLERS: Mapping[str, Mapping[str, Type]] = {
    "diff_drive_controller/DiffDriveController": _ODOMETRY
    | _types(
        doubles=f"""
            wheel_separation wheel_radius wheel_separation_multiplier left_wheel_radius_multiplier
            right_wheel_radius_multiplier cmd_vel_timeout publish_rate {_LIMITS}
        """,
        bools=f"position_feedback publish_limited_velocity tf_frame_prefix_enable {_LIMITED}",
        name_lists="left_wheel_names right_wheel_names",
    ),
    "tricycle_controller/TricycleController": _ODOMETRY
    | _types(
        doubles="""
            wheelbase wheel_radius traction.max_velocity traction.min_velocity
            traction.max_acceleration traction.min_acceleration traction.max_deceleration
            traction.min_deceleration traction.max_jerk traction.min_jerk steering.max_position
            steering.min_position steering.max_velocity steering.min_velocity
            steering.max_acceleration steering.min_acceleration
        """,
        integers="cmd_vel_timeout",
        bools="odom_only_twist publish_ackermann_command",
    ),
    "ackermann_steering_controller/AckermannSteeringController": _STEERING
    | _types(
        doubles="""
            front_wheel_track rear_wheel_track front_wheels_radius rear_wheels_radius
            traction_track_width steering_track_width traction_wheels_radius
        """
    ),
    "bicycle_steering_controller/BicycleSteeringController": _STEERING
    | _types(doubles="front_wheel_radius rear_wheel_radius traction_wheel_radius"),
    "tricycle_steering_controller/TricycleSteeringController": _STEERING
    | _types(
        doubles="""
            wheel_track front_wheels_radius rear_wheels_radius traction_track_width
            traction_wheels_radius
        """
    ),
    "mecanum_drive_controller/MecanumDriveController": _types(
        doubles="""
            reference_timeout kinematics.wheels_radius
            kinematics.sum_of_robot_center_projection_on_X_Y_axis kinematics.base_frame_offset.x
            kinematics.base_frame_offset.y kinematics.base_frame_offset.theta
        """,
        bools="enable_odom_tf",
        double_lists="pose_covariance_diagonal twist_covariance_diagonal",
    ),
    "omni_wheel_drive_controller/OmniWheelDriveController": _types(
        doubles="robot_radius wheel_offset wheel_radius cmd_vel_timeout",
        bools="open_loop position_feedback enable_odom_tf tf_frame_prefix_enable",
        double_lists="diagonal_covariance.pose diagonal_covariance.twist",
        name_lists="wheel_names",
    ),
    "joint_trajectory_controller/JointTrajectoryController": _types(
        doubles="""
            action_monitor_rate cmd_timeout constraints.goal_time
            constraints.stopped_velocity_tolerance constraints.{joints}.trajectory
            constraints.{joints}.goal gains.{joints}.p gains.{joints}.i gains.{joints}.d
            gains.{joints}.i_clamp gains.{joints}.ff_velocity_scale
        """,
        bools="""
            allow_partial_joints_goal allow_integration_in_goal_trajectories open_loop_control
            allow_nonzero_velocity_at_trajectory_end
        """,
        name_lists="joints command_joints command_interfaces state_interfaces",
    ),
    "position_controllers/GripperActionController": _GRIPPER,
    "effort_controllers/GripperActionController": _GRIPPER
    | _types(doubles="gains.{joint}.p gains.{joint}.i gains.{joint}.d gains.{joint}.i_clamp"),
    "parallel_gripper_action_controller/GripperActionController": _GRIPPER
    | _types(doubles="max_velocity"),
    "pid_controller/PidController": _types(
        doubles="""
            gains.{dof_names}.p gains.{dof_names}.i gains.{dof_names}.d
            gains.{dof_names}.i_clamp_max gains.{dof_names}.i_clamp_min
            gains.{dof_names}.feedforward_gain
        """,
        bools="use_external_measured_states gains.{dof_names}.angle_wraparound",
        name_lists="dof_names reference_and_state_dof_names reference_and_state_interfaces",
    ),
    "position_controllers/JointGroupPositionController": _COMMANDS,
    "velocity_controllers/JointGroupVelocityController": _COMMANDS,
    "effort_controllers/JointGroupEffortController": _COMMANDS,
    "forward_command_controller/ForwardCommandController": _COMMANDS,
    "forward_command_controller/MultiInterfaceForwardCommandController": _types(
        name_lists="interface_names"
    ),
    "joint_state_broadcaster/JointStateBroadcaster": _types(
        bools="use_local_topics", name_lists="joints extra_joints interfaces"
    ),
    "imu_sensor_broadcaster/IMUSensorBroadcaster": _types(
        double_lists="""
            static_covariance_orientation static_covariance_angular_velocity
            static_covariance_linear_acceleration
        """,
    ),
}
"""The types of the parameters of each controller, by its own type."""

CLASSIC: Mapping[str, Mapping[str, Type]] = {
    "diff_drive_controller/DiffDriveController": _types(
        integers="wheels_per_side", bools="use_stamped_vel"
    ),
    "tricycle_controller/TricycleController": _types(bools="use_stamped_vel"),
    "joint_trajectory_controller/JointTrajectoryController": _types(doubles="state_publish_rate"),
}
"""Parameters that exist only in the versions of ROS 2 with Gazebo Classic."""

EVERY: Mapping[str, Type] = _types(integers="update_rate")
"""Parameters of each controller, and of the controller manager. Source: ros2_control."""
