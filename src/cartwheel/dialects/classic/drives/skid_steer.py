"""``libgazebo_ros_skid_steer_drive.so``: four driven wheels that turn by skidding."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.drives.differential import DifferentialDrive, DifferentialDriveConfig
from cartwheel.devices.drives.drive import DriveConfig
from cartwheel.devices.drives.odometry import OdometryConfig, planar_covariance
from cartwheel.dialects.classic.drives import odometry_tags
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag
from cartwheel.dialects.wheel_pairs import report_swapped_wheels, wheel_pairs


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
    wheel_separation: float = tag(
        "wheelSeparation",
        default=0.4,
        unit="m",
        role="wheel_separation",
        doc="Distance between the left and right wheels.",
    )
    wheel_diameter: float = tag(
        "wheelDiameter",
        default=0.15,
        unit="m",
        role="wheel_diameter",
        doc="Diameter of all wheels.",
    )
    torque: float = tag(
        "torque",
        "wheelTorque",
        default=5.0,
        unit="N m",
        role="wheel_torque",
        least=SMALLEST,
        doc="Maximum torque of each motor.",
    )
    command_topic: str = tag(
        "commandTopic", "topicName", default="cmd_vel", doc="Topic of the Twist commands."
    )
    odometry_topic: str = tag(
        "odometryTopic", default="odom", role="topic", doc="Topic of the odometry."
    )
    odometry_frame: str = tag("odometryFrame", default="odom", doc="Frame ID of the odometry.")
    base_frame: str = tag(
        "robotBaseFrame",
        default="base_footprint",
        role="frame",
        doc="Link whose pose is published as odometry. If no link has this name, the root link "
        "is used.",
    )
    update_rate: float = tag(
        "updateRate",
        default=100.0,
        unit="Hz",
        least=0.0,
        doc="Rate at which commands are applied and messages are published. If 0, both happen "
        "at every simulation step.",
    )
    broadcast_tf: bool = tag(
        "broadcastTF", default=False, doc="Whether to publish the odometry as a transform on `/tf`."
    )
    covariance_x: float = odometry_tags.position_variance("x", 1e-4)
    covariance_y: float = odometry_tags.position_variance("y", 1e-4)
    covariance_yaw: float = odometry_tags.yaw_variance(1e-2)


class SkidSteerDrive(Plugin[SkidSteerParameters]):
    """Drives a four-wheeled skid-steer robot as commanded by Twist messages; publishes odometry.

    The robot turns more slowly than commanded, because its tyres slide sideways. The odometry is
    the ground-truth pose. Original plugin: ``gazebo_ros_skid_steer_drive`` in the package
    ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_skid_steer_drive.so",)
    parameters: ClassVar[type] = SkidSteerParameters

    def configure(self) -> None:
        config = self.config
        joints = [(config.left_front, config.right_front), (config.left_rear, config.right_rear)]
        pairs = wheel_pairs(self, joints, [config.wheel_separation], [config.wheel_diameter])
        self.add(
            DifferentialDrive(
                self.scope,
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
                            pose_covariance=planar_covariance(
                                config.covariance_x, config.covariance_y, config.covariance_yaw
                            ),
                        ),
                    ),
                ),
            )
        )
        report_swapped_wheels(self, pairs)
