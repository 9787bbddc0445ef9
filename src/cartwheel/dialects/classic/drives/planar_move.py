"""``libgazebo_ros_planar_move.so``: a drive without wheels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.drives.odometry import NO_COVARIANCE, OdometryConfig
from cartwheel.devices.drives.planar import PlanarDrive, PlanarDriveConfig
from cartwheel.dialects import drive_tags
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class PlanarMoveParameters:
    command_topic: str = drive_tags.command_topic("commandTopic", "command_topic")
    odometry_topic: str = drive_tags.odometry_topic("odometryTopic", "odometry_topic")
    odometry_frame: str = drive_tags.odometry_frame("odometryFrame", "odometry_frame")
    base_frame: str = drive_tags.base_frame("robotBaseFrame", "robot_base_frame")
    rate: float = drive_tags.odometry_rate("odometryRate", "publish_rate")
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
    publish_odom: bool = drive_tags.publish_odometry("publish_odom")
    publish_odom_tf: bool = drive_tags.publish_transform("publish_odom_tf", default=True)
    covariance_x: float = drive_tags.position_variance("covariance_x", 1e-5)
    covariance_y: float = drive_tags.position_variance("covariance_y", 1e-5)
    covariance_yaw: float = drive_tags.yaw_variance("covariance_yaw", 1e-3)


class PlanarMove(Plugin[PlanarMoveParameters]):
    """Moves the robot in the xy plane as commanded by Twist messages, and publishes odometry.

    The robot needs no wheels: a velocity controller applies a force to the robot. The force is at
    most five times the robot's weight, so a wall stops the robot. The odometry is the ground-truth
    pose. Original plugin: ``gazebo_ros_planar_move`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_planar_move.so",)
    moves_model: ClassVar[bool] = True

    def configure(self) -> None:
        config = self.config
        covariance = drive_tags.covariance(config)
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
