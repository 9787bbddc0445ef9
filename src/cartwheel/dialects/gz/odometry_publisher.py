"""``gz-sim-odometry-publisher-system``: ground truth of a model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from cartwheel.devices.drives.odometry import OdometryConfig
from cartwheel.devices.position.truth import BaseTruth, BaseTruthConfig
from cartwheel.dialects.common_tags import (
    deviation_tag,
    position_tag,
    publish_rate_tag,
    rotation_tag,
)
from cartwheel.dialects.gz.drive_tags import gz_name, model_frame
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import Pose, quat_from_rpy


@dataclass(frozen=True, kw_only=True, slots=True)
class OdometryPublisherParameters:
    frame: str = tag(
        "odom_frame", default="", doc="Frame ID of the messages. Default: `<model>/odom`."
    )
    base_frame: str = tag(
        "robot_base_frame",
        default="",
        role="frame",
        doc="Child frame ID of the messages. Default: `<model>/base_footprint`.",
    )
    rate: float = publish_rate_tag("odom_publish_frequency", default=50.0, of="all topics")
    topic: str = tag(
        "odom_topic",
        default="",
        doc="Topic of the odometry. Default: `/model/<model>/odometry`.",
    )
    covariance_topic: str = tag(
        "odom_covariance_topic",
        default="",
        doc="Topic of the odometry with covariance. "
        "Default: `/model/<model>/odometry_with_covariance`.",
    )
    tf_topic: str = tag(
        "tf_topic",
        default="",
        doc="Topic of the transforms (TFMessage). Default: `/model/<model>/pose`.",
    )
    dimensions: Literal["2", "3"] = tag(
        "dimensions",
        default="2",
        doc="With `2`, the pose and the twist are planar (x, y, yaw). With `3`, they are "
        "three-dimensional.",
    )
    xyz_offset: tuple[float, float, float] = position_tag(
        "xyz_offset", of="the base frame in the model frame"
    )
    rpy_offset: tuple[float, float, float] = rotation_tag(
        "rpy_offset", of="the base frame in the model frame"
    )
    noise: float = deviation_tag(
        "gaussian_noise", unit="m/s and rad/s", of="the noise on the twist"
    )


class OdometryPublisher(Plugin[OdometryPublisherParameters]):
    """Publishes the model's ground-truth pose in the world, and its twist in the model frame.

    Original plugin: ``OdometryPublisher`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-odometry-publisher-system",)

    def configure(self) -> None:
        config, part = self.config, self.part
        offset = Pose(config.xyz_offset, quat_from_rpy(*config.rpy_offset))
        frame = config.frame or model_frame(part, "odom")
        base = config.base_frame or model_frame(part, "base_footprint")
        covariance = np.diag([config.noise**2] * 6).ravel()
        self.add(
            BaseTruth(
                self.scope,
                BaseTruthConfig(
                    link=part.description.canonical_link,
                    mount=part.description.canonical_pose.inverse() @ offset,
                    planar=config.dimensions == "2",
                    noise=config.noise,
                    noise_name=f"odometry {self.tag.name}",
                    rate=config.rate,
                    outputs=(
                        OdometryConfig(
                            topic=gz_name(self, config.topic, "odometry"),
                            frame=frame,
                            base=base,
                            rate=config.rate,
                            transform=True,
                            tf_topic=gz_name(self, config.tf_topic, "pose"),
                        ),
                        OdometryConfig(
                            topic=gz_name(
                                self, config.covariance_topic, "odometry_with_covariance"
                            ),
                            frame=frame,
                            base=base,
                            rate=config.rate,
                            transform=False,
                            pose_covariance=covariance,
                            twist_covariance=covariance,
                        ),
                    ),
                ),
            )
        )
