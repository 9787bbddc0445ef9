"""``libgazebo_ros_planar_move.so``: a drive without wheels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.drives.odometry import NO_COVARIANCE, OdometryConfig, planar_covariance
from cartwheel.devices.drives.planar import PlanarDrive, PlanarDriveConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class PlanarMoveParameters:
    command_topic: str = tag(
        "commandTopic", "command_topic", default="cmd_vel", doc="Topic of the Twist commands."
    )
    odometry_topic: str = tag(
        "odometryTopic",
        "odometry_topic",
        default="odom",
        role="topic",
        doc="Topic of the odometry.",
    )
    odometry_frame: str = tag(
        "odometryFrame", "odometry_frame", default="odom", doc="Frame ID of the odometry."
    )
    base_frame: str = tag(
        "robotBaseFrame",
        "robot_base_frame",
        default="base_footprint",
        role="frame",
        doc="Link whose pose is published as odometry. If no link has this name, the root link "
        "is used.",
    )
    rate: float = tag(
        "odometryRate",
        "publish_rate",
        default=20.0,
        unit="Hz",
        doc="Publish rate of the odometry and its transform. If 0 or negative, neither is "
        "published.",
    )
    update_rate: float = tag(
        "update_rate",
        default=20.0,
        unit="Hz",
        doc="No effect: the velocity is controlled at every step.",
    )
    timeout: float = tag(
        "cmdTimeout",
        "cmd_timeout",
        default=-1.0,
        unit="s",
        doc="Time without a command after which the robot stops. If negative, the last command "
        "stays in effect.",
    )
    publish_odom: bool = tag(
        "publish_odom", default=True, doc="Whether to publish the odometry as messages."
    )
    publish_odom_tf: bool = tag(
        "publish_odom_tf",
        default=True,
        doc="Whether to publish the odometry as a transform on `/tf`.",
    )
    covariance_x: float = tag(
        "covariance_x", default=1e-5, unit="m²", doc="Variance of the x position in the odometry."
    )
    covariance_y: float = tag(
        "covariance_y", default=1e-5, unit="m²", doc="Variance of the y position in the odometry."
    )
    covariance_yaw: float = tag(
        "covariance_yaw",
        default=1e-3,
        unit="rad²",
        doc="Variance of the yaw angle in the odometry.",
    )


class PlanarMove(Plugin[PlanarMoveParameters]):
    """Moves the robot in the xy plane as commanded by Twist messages, and publishes odometry.

    The robot needs no wheels: a velocity controller applies a force to the robot. The force is at
    most five times the robot's weight, so a wall stops the robot. The odometry is the ground-truth
    pose. Original plugin: ``gazebo_ros_planar_move`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_planar_move.so",)
    parameters: ClassVar[type] = PlanarMoveParameters

    def configure(self) -> None:
        config = self.config
        covariance = planar_covariance(
            config.covariance_x, config.covariance_y, config.covariance_yaw
        )
        # The ROS 1 plugin leaves the covariance of the twist at zero.
        ros2 = self.tag.element.find("ros") is not None
        odometry = OdometryConfig(
            topic=config.odometry_topic if config.publish_odom else None,
            frame=config.odometry_frame,
            base=config.base_frame,
            rate=config.rate,
            transform=config.publish_odom_tf,
            pose_covariance=covariance,
            twist_covariance=covariance if ros2 else NO_COVARIANCE,
        )
        self.add(
            PlanarDrive(
                self.scope,
                PlanarDriveConfig(
                    command_topic=config.command_topic,
                    timeout=config.timeout if config.timeout >= 0 else None,
                    odometry=odometry if config.rate > 0 else None,
                ),
            )
        )
