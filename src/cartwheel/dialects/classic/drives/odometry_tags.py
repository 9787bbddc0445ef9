"""Tags that the drive plugins of Gazebo Classic share: topics, frames and variances."""

from __future__ import annotations

from typing import Any

from cartwheel.dialects.tags import tag

# The functions return Any, as `tag` does, because a field with a tag can have any type.


def command_topic() -> Any:
    """The topic of the commands."""
    return tag(
        "commandTopic", "command_topic", default="cmd_vel", doc="Topic of the Twist commands."
    )


def odometry_topic() -> Any:
    """The topic of the odometry."""
    return tag(
        "odometryTopic",
        "odometry_topic",
        default="odom",
        role="topic",
        doc="Topic of the odometry.",
    )


def odometry_frame() -> Any:
    """The frame ID of the odometry."""
    return tag("odometryFrame", "odometry_frame", default="odom", doc="Frame ID of the odometry.")


def base_frame(default: str) -> Any:
    """The link whose pose is published."""
    return tag(
        "robotBaseFrame",
        "robot_base_frame",
        default=default,
        role="frame",
        doc="Link whose pose is published as odometry. If no link has this name, the root link "
        "is used.",
    )


def position_variance(axis: str, default: float) -> Any:
    """The variance of a coordinate of the position, m²."""
    return tag(
        f"covariance_{axis}",
        default=default,
        unit="m²",
        doc=f"Variance of the {axis} position in the odometry.",
    )


def yaw_variance(default: float) -> Any:
    """The variance of the yaw angle, rad²."""
    return tag(
        "covariance_yaw",
        default=default,
        unit="rad²",
        doc="Variance of the yaw angle in the odometry.",
    )
