"""``libgazebo_ros_skid_steer_drive.so``: four driven wheels that turn by skidding."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.drives.differential import DifferentialDriveConfig
from cartwheel.devices.drives.drive import DriveConfig
from cartwheel.devices.drives.odometry import OdometryConfig
from cartwheel.dialects import drive_tags
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag
from cartwheel.dialects.wheel_pairs import add_differential_drive, wheel_pairs


@dataclass(frozen=True, kw_only=True, slots=True)
class SkidSteerParameters:
    left_front: str = tag(
        "leftFrontJoint",
        default="left_front_joint",
        role="left_wheel",
        doc="Joint of the left front wheel.",
    )
    right_front: str = tag(
        "rightFrontJoint",
        default="right_front_joint",
        role="right_wheel",
        doc="Joint of the right front wheel.",
    )
    left_rear: str = tag(
        "leftRearJoint",
        default="left_rear_joint",
        role="left_wheel",
        doc="Joint of the left rear wheel.",
    )
    right_rear: str = tag(
        "rightRearJoint",
        default="right_rear_joint",
        role="right_wheel",
        doc="Joint of the right rear wheel.",
    )
    wheel_separation: float = drive_tags.wheel_separation("wheelSeparation", default=0.4)
    wheel_diameter: float = drive_tags.wheel_diameter("wheelDiameter", default=0.15)
    torque: float = tag(
        "torque",
        "wheelTorque",
        default=5.0,
        unit="N m",
        role="wheel_torque",
        least=SMALLEST,
        doc="Maximum torque of each motor.",
    )
    command_topic: str = drive_tags.command_topic("commandTopic", "topicName")
    odometry_topic: str = drive_tags.odometry_topic("odometryTopic")
    odometry_frame: str = drive_tags.odometry_frame("odometryFrame")
    base_frame: str = drive_tags.base_frame("robotBaseFrame")
    update_rate: float = drive_tags.control_rate("updateRate")
    broadcast_tf: bool = drive_tags.publish_transform("broadcastTF", default=False)
    covariance_x: float = drive_tags.position_variance("covariance_x", 1e-4)
    covariance_y: float = drive_tags.position_variance("covariance_y", 1e-4)
    covariance_yaw: float = drive_tags.yaw_variance("covariance_yaw", 1e-2)


class SkidSteerDrive(Plugin[SkidSteerParameters]):
    """Drives a four-wheeled skid-steer robot as commanded by Twist messages; publishes odometry.

    The robot turns more slowly than commanded, because its tyres slide sideways. The odometry is
    the ground-truth pose. Original plugin: ``gazebo_ros_skid_steer_drive`` in the package
    ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_skid_steer_drive.so",)

    def configure(self) -> None:
        config = self.config
        joints = [(config.left_front, config.right_front), (config.left_rear, config.right_rear)]
        pairs = wheel_pairs(self, joints, [config.wheel_separation], [config.wheel_diameter])
        add_differential_drive(
            self,
            DifferentialDriveConfig(
                pairs=pairs,
                max_torque=config.torque,
                drive=DriveConfig(
                    command_topic=config.command_topic,
                    control_rate=config.update_rate,
                    odometry=OdometryConfig(
                        topic=config.odometry_topic,
                        frame=config.odometry_frame,
                        base=config.base_frame,
                        rate=config.update_rate,
                        transform=config.broadcast_tf,
                        pose_covariance=drive_tags.covariance(config),
                    ),
                ),
            ),
        )
