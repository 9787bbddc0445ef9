"""``libgazebo_ros_imu.so``: an inertial measurement unit on a link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.inertial import imu as inertial
from cartwheel.devices.inertial.unit import InertialUnitConfig
from cartwheel.dialects.common_tags import (
    deviation_tag,
    link_frame_tag,
    position_tag,
    publish_rate_tag,
    rotation_tag,
)
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import Pose, quat_from_rpy


@dataclass(frozen=True, kw_only=True, slots=True)
class ImuParameters:
    body: str = tag(
        "bodyName", "body_name", "frame_name", role="link", doc="Link that carries the IMU."
    )
    topic: str = tag("topicName", default="imu", role="topic", doc="Topic of the Imu messages.")
    service: str = tag(
        "serviceName",
        default="imu_service",
        doc="Name of a service of type Empty. Calls succeed but have no effect.",
    )
    frame: str = link_frame_tag("frameName")
    noise: float = deviation_tag(
        "gaussianNoise", unit="rad/s and m/s²", of="the noise on angular velocity and acceleration"
    )
    rpy_offset: tuple[float, float, float] = rotation_tag(
        "rpyOffsets", "rpyOffset", of="the IMU in the link frame"
    )
    xyz_offset: tuple[float, float, float] = position_tag(
        "xyzOffset", "xyzOffsets", of="the IMU in the link frame"
    )
    update_rate: float = publish_rate_tag("updateRate", "update_rate")


class Imu(Plugin[ImuParameters]):
    """Publishes the angular velocity, acceleration and orientation of an IMU on a link.

    As REP 145 requires, the acceleration includes gravity: an IMU at rest measures 9.8 m/s²
    upwards. The acceleration and the angular velocity are expressed in the IMU frame. Gazebo's
    plugin omits gravity, and rotates the angular velocity in the wrong direction. Original plugin:
    ``gazebo_ros_imu`` in the package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_imu.so",)

    def configure(self) -> None:
        config = self.config
        mount = Pose(config.xyz_offset, quat_from_rpy(*config.rpy_offset))
        self.add(
            inertial.Imu(
                self.scope,
                inertial.ImuConfig(
                    unit=InertialUnitConfig(link=config.body, mount=mount),
                    topic=config.topic,
                    frame=config.frame or config.body,
                    rate=config.update_rate,
                    noise=config.noise,
                    # As in Gazebo, calls have no effect: the simulated IMU has no drift.
                    calibration_service=config.service,
                ),
            )
        )
