"""``libgazebo_ros_ackerman.so``: the four driven wheels and the steering of AgileX's LIMO."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.drives.drive import DriveConfig
from cartwheel.devices.drives.odometry import OdometryConfig
from cartwheel.devices.drives.steering_commands import (
    SteeringCommandsConfig,
    SteeringCommandsDrive,
)
from cartwheel.dialects import drive_tags
from cartwheel.dialects.common_tags import size_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag

_BASE, _TRACK, _MAX_ANGLE = 0.2, 0.172, 0.523598767
"""Wheel base and track of the LIMO, m, and its maximum steering angle, rad; in the original, they
are constants."""
_LEVER = 0.2 * _TRACK
"""The original calculates the speeds of the left and right wheels with it, m."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LimoParameters:
    front_left: str = tag(
        "leftFrontJoint",
        default="left_front_joint",
        role="joint",
        doc="Joint of the front left wheel.",
    )
    front_right: str = tag(
        "rightFrontJoint",
        default="right_front_joint",
        role="joint",
        doc="Joint of the front right wheel.",
    )
    rear_left: str = tag(
        "leftRearJoint",
        default="left_rear_joint",
        role="joint",
        doc="Joint of the rear left wheel.",
    )
    rear_right: str = tag(
        "rightRearJoint",
        default="right_rear_joint",
        role="joint",
        doc="Joint of the rear right wheel.",
    )
    left_hinge: str = tag(
        "leftHingeJoint",
        default="",
        doc="No effect: a position controller moves the left steering joint.",
    )
    right_hinge: str = tag(
        "rightHingeJoint",
        default="",
        doc="No effect: a position controller moves the right steering joint.",
    )
    separation: float = tag(
        "wheelSeparation", default=0.4, unit="m", doc="No effect: the distance is 0.172 m."
    )
    diameter: float = size_tag("wheelDiameter", default=0.15, doc="Diameter of all wheels.")
    torque: float = tag(
        "torque",
        default=5.0,
        unit="N m",
        least=0.0,
        role="wheel_torque",
        doc="Maximum torque of each motor.",
    )
    command_topic: str = drive_tags.command_topic("commandTopic")
    odometry_topic: str = tag("odometryTopic", default="odom", doc="Topic of the odometry.")
    odometry_frame: str = drive_tags.odometry_frame("odometryFrame")
    base_frame: str = drive_tags.base_frame("robotBaseFrame")
    rate: float = drive_tags.control_rate("updateRate")
    publish_tf: bool = drive_tags.publish_transform("broadcastTF", default=False)
    covariance_x: float = drive_tags.position_variance("covariance_x", 1e-4, least=0.0)
    covariance_y: float = drive_tags.position_variance("covariance_y", 1e-4, least=0.0)
    covariance_yaw: float = tag(
        "covariance_yaw",
        default=0.01,
        unit="rad²",
        least=0.0,
        doc="Variance of the yaw in the odometry.",
    )


class LimoAckermannDrive(Plugin[LimoParameters]):
    """Drives the four wheels of a LIMO robot as commanded by Twist messages.

    ``linear.x`` is the speed in m/s and ``angular.z`` the yaw rate in rad/s. The steering angles
    are published as commands for the position controllers ``limo_fl_steering_hinge_controller`` and
    ``limo_fr_steering_hinge_controller``: without them, the wheels are not steered. The plugin also
    publishes the ground-truth pose as odometry. Original plugin: ``gazebo_ros_ackerman`` in the
    package ``limo_gazebo_sim``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_ackerman.so",)

    def configure(self) -> None:
        config = self.config
        covariance = drive_tags.covariance(config)
        self.add(
            SteeringCommandsDrive(
                self.scope,
                SteeringCommandsConfig(
                    front=(config.front_left, config.front_right),
                    rear=(config.rear_left, config.rear_right),
                    angle_topics=(
                        "limo_fl_steering_hinge_controller/command",
                        "limo_fr_steering_hinge_controller/command",
                    ),
                    radius=config.diameter / 2,
                    wheel_base=_BASE,
                    track=_TRACK,
                    lever=_LEVER,
                    max_angle=_MAX_ANGLE,
                    max_torque=config.torque,
                    drive=DriveConfig(
                        command_topic=config.command_topic,
                        control_rate=config.rate,
                        odometry=OdometryConfig(
                            topic=config.odometry_topic,
                            frame=config.odometry_frame,
                            base=config.base_frame,
                            rate=config.rate,
                            transform=config.publish_tf,
                            pose_covariance=covariance,
                            twist_covariance=covariance,
                        ),
                    ),
                ),
            )
        )
