"""``libdiffdrive_plugin_multi_wheel.so``: hector's drive of any number of wheels a side."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.errors import PluginError
from cartwheel.plugins.odometry import Odometry, planar_covariance
from cartwheel.plugins.parameters import tag
from cartwheel.plugins.wheel_drive import WheelDrive, WheelPair


@dataclass(frozen=True, kw_only=True, slots=True)
class MultiWheelParameters:
    left: str = tag("leftJoints", default="left_joint", doc="Joints, between blanks.")
    right: str = tag("rightJoints", default="right_joint", doc="Joints, between blanks.")
    separation: float = tag(
        "wheelSeparation", default=0.34, unit="m", doc="Between left and right."
    )
    diameter: float = tag("wheelDiameter", default=0.15, unit="m", doc="Of all wheels.")
    torque: float = tag("torque", default=5.0, unit="N m", doc="The most that each motor gives.")
    command_topic: str = tag("commandTopic", default="cmd_vel", doc="Twist.")
    odometry_topic: str = tag("odometryTopic", default="odom", doc="Odometry.")
    odometry_frame: str = tag("odometryFrame", default="odom", doc="Frame of the odometry.")
    base_frame: str = tag(
        "robotBaseFrame",
        default="base_footprint",
        doc="Link whose pose is told; the root link where there is none of that name.",
    )
    rate: float = tag("updateRate", default=100.0, unit="Hz", doc="Of control and topics.")
    publish_tf: bool = tag("publishOdometryTf", default=True, doc="Publish odometry's transform.")
    publish_message: bool = tag("publishOdometryMsg", default=True, doc="Publish odometry.")


class MultiWheelDrive(WheelDrive):
    """Drives all wheels of a side alike by Twist; the odometry is the true pose.

    Source: hector_gazebo_plugins, diffdrive_plugin_multi_wheel.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libdiffdrive_plugin_multi_wheel.so",)
    parameters: ClassVar[type] = MultiWheelParameters

    def configure(self) -> None:
        config: MultiWheelParameters = self.config
        left, right = config.left.split(), config.right.split()
        if not left or not right:
            raise PluginError(
                "<leftJoints> and <rightJoints> must each name a joint",
                code=devices.WHEELS_UNPAIRED,
                origin=self.tag.origin,
                values={"left": len(left), "right": len(right)},
            )
        # Where a side has more wheels, its last ones are paired with one that turns already.
        sides = itertools.zip_longest(left, right)
        pairs = [
            WheelPair(
                left=one or left[-1],
                right=two or right[-1],
                separation=config.separation,
                diameter=config.diameter,
            )
            for one, two in sides
        ]
        self._take_wheels(pairs, torque=config.torque)
        covariance = planar_covariance(1e-5, 1e-5, 1e-3)
        self.odometry = self.keep(
            Odometry(
                self,
                topic=config.odometry_topic if config.publish_message else None,
                frame=config.odometry_frame,
                base=config.base_frame,
                rate=config.rate,
                transform=config.publish_tf,
                pose_covariance=covariance,
            )
        )
        self._run_wheels(
            command_topic=config.command_topic,
            base=config.base_frame,
            encoded=False,
            control_rate=config.rate,
            rate=config.rate,
        )
