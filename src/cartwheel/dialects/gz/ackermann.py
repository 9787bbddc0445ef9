"""``gz-sim-ackermann-steering-system``: a car."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.drives.ackermann import AckermannDrive, AckermannDriveConfig
from cartwheel.dialects.common_tags import joint_tag, joints_tag, size_tag
from cartwheel.dialects.gz.drive_tags import (
    GzLimitedParameters,
    gz_drive,
    report_limits,
    separate_limits,
)
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag
from cartwheel.simulation.limits import FARTHEST


@dataclass(frozen=True, kw_only=True, slots=True)
class GzAckermannParameters(GzLimitedParameters):
    left_joint: tuple[str, ...] = joints_tag(
        "left_joint", doc="Joint of a driven left wheel. Repeat the tag for each wheel."
    )
    right_joint: tuple[str, ...] = joints_tag(
        "right_joint", doc="Joint of a driven right wheel. Repeat the tag for each wheel."
    )
    steer_left: str = joint_tag(
        "left_steering_joint", role="steering", doc="Joint that steers the front left wheel."
    )
    steer_right: str = joint_tag(
        "right_steering_joint", role="steering", doc="Joint that steers the front right wheel."
    )
    wheel_separation: float = size_tag(
        "wheel_separation",
        default=1.0,
        role="wheel_separation",
        wheels=("left_joint", "right_joint"),
        doc="Distance between the left and right wheels.",
    )
    kingpin_width: float = size_tag(
        "kingpin_width",
        default=0.8,
        role="wheel_separation",
        wheels=("steer_left", "steer_right"),
        doc="Distance between the steering axes.",
    )
    wheel_base: float = size_tag(
        "wheel_base",
        default=1.0,
        role="wheel_base",
        wheels=("steer_left", "left_joint"),
        doc="Distance between the front and rear axles.",
    )
    steering_limit: float = tag(
        "steering_limit",
        default=0.5,
        unit="rad",
        least=SMALLEST,
        most=FARTHEST,
        doc="Maximum steering angle.",
    )
    wheel_radius: float = size_tag(
        "wheel_radius",
        default=0.2,
        role="wheel_radius",
        wheels=("left_joint", "right_joint"),
        doc="Radius of all wheels.",
    )
    steer_gain: float = tag(
        "steer_p_gain", default=1.0, doc="No effect: a position servo steers the wheels."
    )
    sub_topic: str = tag(
        "sub_topic",
        default="",
        doc="Topic of the Twist commands, relative to `/model/<model>`. Used if `<topic>` "
        "is not set.",
    )
    steering_only: bool = tag(
        "steering_only", default=False, doc="No effect: only Twist commands are supported."
    )
    actuators: bool = tag(
        "use_actuator_msg", default=False, doc="No effect: only Twist commands are supported."
    )


class GzAckermannDrive(Plugin[GzAckermannParameters]):
    """Drives and steers a car as commanded by Twist messages, and publishes odometry.

    In a command, ``linear.x`` is the speed in m/s, and ``angular.z`` is the yaw rate in rad/s. The
    odometry is computed from the rotation of the driven wheels. The joints turn no faster than
    their velocity limits. Original plugin: ``AckermannSteering`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-ackermann-steering-system",)

    def configure(self) -> None:
        config = self.config
        for flag, what in (
            (config.steering_only, "steering_only"),
            (config.actuators, "use_actuator_msg"),
        ):
            if flag:
                self.warn_ignored(what, "only Twist commands are supported")
        report_limits(self, config)
        topic = f"/model/{self.part.name}/{config.sub_topic}" if config.sub_topic else ""
        self.add(
            AckermannDrive(
                self.scope,
                AckermannDriveConfig(
                    left=config.left_joint,
                    right=config.right_joint,
                    steering_left=config.steer_left,
                    steering_right=config.steer_right,
                    radius=config.wheel_radius,
                    wheel_base=config.wheel_base,
                    driven_track=config.wheel_separation,
                    steered_track=config.kingpin_width,
                    max_steering=config.steering_limit,
                    turn="yaw rate",
                    speed_limits=separate_limits(config, "linear"),
                    turn_limits=separate_limits(config, "angular"),
                    encoded=True,
                    drive=gz_drive(self, config, topic=topic),
                ),
            )
        )
