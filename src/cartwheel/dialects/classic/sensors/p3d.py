"""``libgazebo_ros_p3d.so`` and ``libgazebo_world_odometry.so``: ground truth of a link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.devices.drives.odometry import OdometryConfig
from cartwheel.devices.position.truth import GroundTruth, GroundTruthConfig
from cartwheel.dialects import drive_tags
from cartwheel.dialects.common_tags import deviation_tag, publish_rate_tag, rotation_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag

_WORLD = {"world", "/world", "map", "/map"}


@dataclass(frozen=True, kw_only=True, slots=True)
class P3DParameters:
    body: str = tag("bodyName", "body_name", role="link", doc="Link whose pose is published.")
    topic: str = drive_tags.odometry_topic("topicName", "topic_name")
    frame: str = tag(
        "frameName",
        "frame_name",
        default="world",
        role="frame",
        doc="Reference frame of the pose and the twist: a link, `world` or `map`.",
    )
    xyz_offset: tuple[float, float, float] = tag(
        "xyzOffset",
        "xyzOffsets",
        "xyz_offset",
        "xyz_offsets",
        default=(0.0, 0.0, 0.0),
        unit="m",
        doc="Offset added to the position, expressed in the reference frame.",
    )
    rpy_offset: tuple[float, float, float] = rotation_tag(
        "rpyOffset",
        "rpyOffsets",
        "rpy_offset",
        "rpy_offsets",
        of="a rotation that is applied to the orientation, about the axes of the reference frame",
    )
    noise: float = deviation_tag(
        "gaussianNoise", "gaussian_noise", unit="m/s and rad/s", of="the noise on the twist"
    )
    update_rate: float = publish_rate_tag("updateRate", "update_rate")


class P3D(Plugin[P3DParameters]):
    """Publishes the ground-truth pose and twist of a link as Odometry messages.

    As in Gazebo, the twist is expressed in the axes of the reference frame ``<frameName>``, not of
    the link. If the reference frame is a link, Gazebo rotates the twist in the wrong direction;
    Cartwheel does not. Original plugin: ``gazebo_ros_p3d`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_p3d.so",)
    in_link: ClassVar[bool] = False
    """Whether the twist is in the link frame instead of the reference frame."""
    in_world: ClassVar[bool] = False
    """Whether the frame only sets the frame ID, because the pose is relative to the world."""

    def configure(self) -> None:
        config, part = self.config, self.part
        body = config.body or config.frame
        known = part.description.link(config.frame) is not None
        in_world = self.in_world or config.frame in _WORLD
        covariance = np.diag([config.noise**2] * 6).ravel()
        topic = self.scope.published(config.topic, "nav_msgs/msg/Odometry")
        self.add(
            GroundTruth(
                self.scope,
                GroundTruthConfig(
                    link=body,
                    reference=config.frame if known and not in_world else None,
                    shift=config.xyz_offset,
                    rotation=config.rpy_offset,
                    twist_in_link=self.in_link,
                    noise=config.noise,
                    noise_name=f"p3d {topic}",
                    odometry=OdometryConfig(
                        topic=config.topic,
                        frame=config.frame,
                        base=body,
                        rate=config.update_rate,
                        transform=False,
                        pose_covariance=covariance,
                        twist_covariance=covariance,
                    ),
                ),
            )
        )
        if not known and not in_world:
            self.warn(
                devices.FRAME_UNKNOWN,
                f'<frameName> "{config.frame}" is not a link, so the pose in the world '
                "is published with this frame ID (Gazebo publishes nothing)",
                values={"frame": config.frame},
            )


@dataclass(frozen=True, kw_only=True, slots=True)
class WorldOdometryParameters(P3DParameters):
    body: str = tag(
        "bodyName",
        "body_name",
        default="",
        role="link",
        doc="Link whose pose is published. Default: the link in `<frameName>`.",
    )
    frame: str = tag(
        "frameName",
        "frame_name",
        default="world",
        role="frame",
        doc="Frame ID of the messages. The pose is always relative to the world.",
    )


class WorldOdometry(P3D):
    """Publishes the ground-truth pose of a link in the world, and its twist in the link frame.

    Apart from the twist, the plugin works like ``libgazebo_ros_p3d.so``, with the same tags and
    topics. Original plugin: ``gazebo_world_odometry`` in the package ``pal_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_world_odometry.so",)
    parameters: ClassVar[type] = WorldOdometryParameters
    in_world: ClassVar[bool] = True
    in_link: ClassVar[bool] = True
