"""``libridgeback_ros_force_based_move.so``: a base that forces move."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.drives.force_based import ForceBasedDrive, ForceBasedDriveConfig
from cartwheel.devices.drives.odometry import OdometryConfig
from cartwheel.dialects import drive_tags
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class ForceBasedMoveParameters:
    command_topic: str = drive_tags.command_topic("commandTopic")
    odometry_topic: str = tag("odometryTopic", default="odom", doc="Topic of the odometry.")
    odometry_frame: str = drive_tags.odometry_frame("odometryFrame")
    base_frame: str = drive_tags.base_frame("robotBaseFrame")
    rate: float = drive_tags.odometry_rate("odometryRate")
    publish_tf: bool = drive_tags.publish_transform("publishOdometryTf", default=True)
    timeout: float = tag(
        "cmdVelTimeOut",
        "commandWatchdog",
        default=0.25,
        unit="s",
        doc="Time without a command after which the robot stops.",
    )
    x_gain: float = tag(
        "x_velocity_p_gain",
        default=10000.0,
        unit="N s/m",
        least=0.0,
        doc="Force divided by the error of the linear velocity.",
    )
    y_gain: float = tag(
        "y_velocity_p_gain",
        default=10000.0,
        unit="N s/m",
        least=0.0,
        doc="Must be equal to `<x_velocity_p_gain>`, because one gain applies to both directions.",
    )
    yaw_gain: float = tag(
        "yaw_velocity_p_gain",
        default=100.0,
        unit="N m s/rad",
        least=0.0,
        doc="Torque divided by the error of the angular velocity.",
    )


class ForceBasedMove(Plugin[ForceBasedMoveParameters]):
    """Applies forces that move the robot as commanded by Twist messages, and publishes odometry.

    The robot moves in the xy plane, with the commanded ``linear.x``, ``linear.y`` and
    ``angular.z``. The force is a gain times the error of the linear velocity, and the torque is a
    gain times the error of the angular velocity. Both act at the centre of mass. The odometry is
    relative to the robot's initial pose. Original packages: ``ridgeback_gazebo_plugins``,
    ``hector_gazebo_plugins`` and their copies.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libridgeback_ros_force_based_move.so",
        "libgazebo_ros_force_based_move.so",
        "librobotnik_force_based_move.so",
        "libnexus_ros_force_based_move.so",
    )
    moves_model: ClassVar[bool] = True

    def configure(self) -> None:
        config = self.config
        if config.y_gain != config.x_gain:
            self.warn_ignored("y_velocity_p_gain", "<x_velocity_p_gain> is used in both directions")
        odometry = OdometryConfig(
            topic=config.odometry_topic,
            frame=config.odometry_frame,
            base=config.base_frame,
            rate=config.rate,
            transform=config.publish_tf,
        )
        self.add(
            ForceBasedDrive(
                self.scope,
                ForceBasedDriveConfig(
                    command_topic=config.command_topic,
                    timeout=config.timeout,
                    force_gain=config.x_gain,
                    torque_gain=config.yaw_gain,
                    odometry=odometry if config.rate > 0 else None,
                ),
            )
        )
