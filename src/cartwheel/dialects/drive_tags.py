"""Tags that drive plugins of several dialects share: sizes, rates, topics, frames and variances."""

from __future__ import annotations

from typing import Any

from cartwheel.devices.drives.drive import DriveConfig
from cartwheel.devices.drives.odometry import OdometryConfig, planar_covariance
from cartwheel.dialects.tags import tag
from cartwheel.geometry import Array
from cartwheel.simulation import Part

# The functions return Any, as `tag` does, because a field with a tag can have any type. Each takes
# the names of the tag, because plugins differ in the spellings that they accept.


def wheel_separation(*names: str, default: float) -> Any:
    """The distance between wheels across the robot, m."""
    doc = "Distance between the left and right wheels."
    return tag(*names, default=default, unit="m", role="wheel_separation", doc=doc)


def wheel_diameter(*names: str, default: float) -> Any:
    """The diameter of the wheels, m."""
    doc = "Diameter of all wheels."
    return tag(*names, default=default, unit="m", role="wheel_diameter", doc=doc)


def command_topic(*names: str) -> Any:
    """The topic of the commands."""
    return tag(*names, default="cmd_vel", role="command_topic", doc="Topic of the Twist commands.")


def odometry_topic(*names: str) -> Any:
    """The topic of the odometry."""
    return tag(*names, default="odom", role="topic", doc="Topic of the odometry.")


def odometry_frame(*names: str) -> Any:
    """The frame ID of the odometry."""
    return tag(*names, default="odom", role="odometry_frame", doc="Frame ID of the odometry.")


def base_frame(*names: str, default: str = "base_footprint") -> Any:
    """The link whose pose is published."""
    return tag(
        *names,
        default=default,
        role="frame",
        doc="Link whose pose is published as odometry. If no link has this name, the root link "
        "is used.",
    )


def control_rate(*names: str, least: float | None = 0.0) -> Any:
    """The rate of the commands and of all messages, Hz."""
    return tag(
        *names,
        default=100.0,
        unit="Hz",
        least=least,
        doc="Rate at which commands are applied and messages are published. If 0, both happen "
        "at every simulation step.",
    )


def odometry_rate(*names: str) -> Any:
    """The rate of the odometry alone, Hz."""
    return tag(
        *names,
        default=20.0,
        unit="Hz",
        doc="Publish rate of the odometry and its transform. If 0 or negative, neither is "
        "published.",
    )


def publish_odometry(*names: str) -> Any:
    """Whether there are messages of the odometry."""
    return tag(*names, default=True, doc="Whether to publish the odometry as messages.")


def publish_transform(*names: str, default: bool) -> Any:
    """Whether the odometry is a transform, too."""
    return tag(
        *names, default=default, doc="Whether to publish the odometry as a transform on `/tf`."
    )


def position_variance(name: str, default: float, *, least: float | None = None) -> Any:
    """The variance of a coordinate of the position, m², whose tag ends with the axis."""
    axis = name[-1]
    doc = f"Variance of the {axis} position in the odometry."
    return tag(name, default=default, unit="m²", least=least, doc=doc)


def yaw_variance(name: str, default: float) -> Any:
    """The variance of the yaw angle, rad²."""
    return tag(name, default=default, unit="rad²", doc="Variance of the yaw angle in the odometry.")


def covariance(config: Any) -> Array:
    """Returns the covariance that the three variances describe, shape (36,).

    Args:
        config: Parameters with the fields `covariance_x`, `covariance_y` and `covariance_yaw`.
    """
    return planar_covariance(config.covariance_x, config.covariance_y, config.covariance_yaw)


def commands_only(part: Part) -> DriveConfig:
    """Returns the topics of a drive that publishes no odometry."""
    root = part.description.canonical_link
    return DriveConfig(
        command_topic="cmd_vel",
        control_rate=0.0,
        odometry=OdometryConfig(topic=None, frame="odom", base=root, transform=False),
    )
