"""``libdiffdrive_plugin_multi_wheel.so``: differential drive with any number of wheels."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.devices.drives.differential import DifferentialDriveConfig
from cartwheel.devices.drives.drive import DriveConfig
from cartwheel.devices.drives.odometry import OdometryConfig, planar_covariance
from cartwheel.dialects import drive_tags
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.dialects.wheel_pairs import add_differential_drive, wheel_pairs
from cartwheel.errors import PluginError


@dataclass(frozen=True, kw_only=True, slots=True)
class MultiWheelParameters:
    left: str = tag(
        "leftJoints",
        default="left_joint",
        role="left_wheels",
        doc="Joints of the left wheels, separated by spaces.",
    )
    right: str = tag(
        "rightJoints",
        default="right_joint",
        role="right_wheels",
        doc="Joints of the right wheels, separated by spaces.",
    )
    separation: float = drive_tags.wheel_separation("wheelSeparation", default=0.34)
    diameter: float = drive_tags.wheel_diameter("wheelDiameter", default=0.15)
    torque: float = tag(
        "torque", default=5.0, unit="N m", role="wheel_torque", doc="Maximum torque of each motor."
    )
    command_topic: str = drive_tags.command_topic("commandTopic")
    odometry_topic: str = tag("odometryTopic", default="odom", doc="Topic of the odometry.")
    odometry_frame: str = drive_tags.odometry_frame("odometryFrame")
    base_frame: str = drive_tags.base_frame("robotBaseFrame")
    rate: float = drive_tags.control_rate("updateRate")
    publish_tf: bool = drive_tags.publish_transform("publishOdometryTf", default=True)
    publish_message: bool = drive_tags.publish_odometry("publishOdometryMsg")


class MultiWheelDrive(Plugin[MultiWheelParameters]):
    """Drives any number of left and right wheels as commanded by Twist messages.

    All wheels on a side turn at the same speed. The plugin also publishes the ground-truth pose as
    odometry. Original plugin: ``diffdrive_plugin_multi_wheel`` in the package
    ``hector_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libdiffdrive_plugin_multi_wheel.so",)

    def configure(self) -> None:
        config = self.config
        left, right = config.left.split(), config.right.split()
        if not left or not right:
            raise PluginError(
                "<leftJoints> and <rightJoints> must each list at least one joint",
                code=devices.WHEELS_UNPAIRED,
                origin=self.tag.origin,
                values={"left": len(left), "right": len(right)},
            )
        # Extra wheels on one side are paired with the last wheel on the other side.
        joints = [
            (one or left[-1], other or right[-1])
            for one, other in itertools.zip_longest(left, right)
        ]
        pairs = wheel_pairs(self, joints, [config.separation], [config.diameter])
        add_differential_drive(
            self,
            DifferentialDriveConfig(
                pairs=pairs,
                max_torque=config.torque,
                drive=DriveConfig(
                    command_topic=config.command_topic,
                    control_rate=config.rate,
                    odometry=OdometryConfig(
                        topic=config.odometry_topic if config.publish_message else None,
                        frame=config.odometry_frame,
                        base=config.base_frame,
                        rate=config.rate,
                        transform=config.publish_tf,
                        pose_covariance=planar_covariance(1e-5, 1e-5, 1e-3),
                    ),
                ),
            ),
        )
