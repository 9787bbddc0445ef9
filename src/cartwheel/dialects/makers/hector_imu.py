"""``libhector_gazebo_ros_imu.so``: an inertial measurement unit with drift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.devices.inertial.imu import Imu, ImuConfig
from cartwheel.devices.inertial.unit import InertialUnitConfig
from cartwheel.devices.noise import DriftingErrorConfig
from cartwheel.dialects.common_tags import (
    ZEROS,
    deviation_tag,
    link_frame_tag,
    position_tag,
    publish_rate_tag,
)
from cartwheel.dialects.drift_tags import (
    HOURS,
    UNSCALED,
    drifting_error,
    frequency_tag,
    offset_tag,
)
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import Pose, quat_from_rpy


@dataclass(frozen=True, kw_only=True, slots=True)
class HectorImuParameters:
    body: str = tag(
        "bodyName", default="", role="link", doc="Link of the IMU. Default: the root link."
    )
    topic: str = tag("topicName", default="imu", doc="Topic of the Imu messages.")
    bias_topic: str | None = tag(
        "biasTopicName",
        default=None,
        doc="Topic of Imu messages that contain the current errors of the measurements. "
        "Default: `<topic>/bias`.",
    )
    service: str | None = tag(
        "serviceName",
        default=None,
        doc="Name of a service of type Empty that removes the drift of the angular velocity. "
        "Default: `<topic>/calibrate`.",
    )
    frame: str = link_frame_tag("frameId")
    update_rate: float = publish_rate_tag("updateRate")
    xyz_offset: tuple[float, float, float] = position_tag(
        "xyzOffset", "xyzOffsets", of="the IMU in the link frame"
    )
    rpy_offset: tuple[float, float, float] = tag(
        "rpyOffset",
        "rpyOffsets",
        default=ZEROS,
        unit="rad",
        doc="Orientation of the IMU in the link frame, as roll, pitch, yaw.",
    )
    noise: float = tag(
        "gaussianNoise",
        default=0.0,
        least=0.0,
        doc="Standard deviation of the noise on angular velocity and acceleration. If positive, "
        "it overrides `<accelGaussianNoise>` and `<rateGaussianNoise>`.",
    )
    accel_offset: tuple[float, float, float] = offset_tag(
        "accelOffset", default=ZEROS, unit="m/s²", of="the acceleration"
    )
    accel_drift: tuple[float, float, float] = deviation_tag(
        "accelDrift", default=ZEROS, unit="m/s²", of="the acceleration's drift"
    )
    accel_frequency: tuple[float, float, float] = frequency_tag(
        "accelDriftFrequency", default=HOURS, of="the acceleration's drift"
    )
    accel_noise: tuple[float, float, float] = deviation_tag(
        "accelGaussianNoise", default=ZEROS, unit="m/s²", of="the acceleration's noise"
    )
    accel_scale: tuple[float, float, float] = tag(
        "accelScaleError", default=UNSCALED, doc="Scale factor on the acceleration."
    )
    rate_offset: tuple[float, float, float] = offset_tag(
        "rateOffset", default=ZEROS, unit="rad/s", of="the angular velocity"
    )
    rate_drift: tuple[float, float, float] = deviation_tag(
        "rateDrift", default=ZEROS, unit="rad/s", of="the angular velocity's drift"
    )
    rate_frequency: tuple[float, float, float] = frequency_tag(
        "rateDriftFrequency", default=HOURS, of="the angular velocity's drift"
    )
    rate_noise: tuple[float, float, float] = deviation_tag(
        "rateGaussianNoise", default=ZEROS, unit="rad/s", of="the angular velocity's noise"
    )
    rate_scale: tuple[float, float, float] = tag(
        "rateScaleError", default=UNSCALED, doc="Scale factor on the angular velocity."
    )
    yaw_offset: float = offset_tag("yawOffset", "headingOffset", unit="rad", of="the yaw")
    yaw_drift: float = deviation_tag("yawDrift", "headingDrift", unit="rad", of="the yaw's drift")
    yaw_frequency: float = frequency_tag(
        "yawDriftFrequency", "headingDriftFrequency", of="the yaw's drift"
    )
    yaw_noise: float = deviation_tag(
        "yawGaussianNoise", "headingGaussianNoise", unit="rad", of="the yaw's noise"
    )
    yaw_scale: float = tag(
        "yawScaleError",
        "headingScaleError",
        default=1.0,
        doc="No effect.",
    )


class HectorImu(Plugin[HectorImuParameters]):
    """Publishes the angular velocity, acceleration and orientation of a link, with noise and drift.

    As REP 145 requires, the acceleration includes gravity: an IMU at rest measures 9.8 m/s²
    upwards. The acceleration, the angular velocity and the yaw angle have three errors: a constant
    offset, a slow drift and noise. The acceleration and the angular velocity also have a scale
    factor. As in the original plugin, an error of the acceleration also tilts the published
    orientation.

    The service ``<topic>/set_accel_bias`` sets the current drift of the acceleration, and
    ``<topic>/set_rate_bias`` sets the current drift of the angular velocity. Original plugin:
    ``gazebo_ros_imu`` in the package ``hector_gazebo_plugins``. See also REP 145.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libhector_gazebo_ros_imu.so",
        "hector_gazebo_ros_imu",
    )

    def configure(self) -> None:
        config = self.config
        link = config.body or self.part.description.canonical_link
        mount = Pose(config.xyz_offset, quat_from_rpy(*config.rpy_offset))
        topic = config.topic
        override = {"noise": (config.noise,) * 3} if config.noise > 0 else {}
        self.add(
            Imu(
                self.scope,
                ImuConfig(
                    unit=InertialUnitConfig(link=link, mount=mount),
                    topic=topic,
                    frame=config.frame or link,
                    rate=config.update_rate,
                    acceleration_error=self._error("accel", **override),
                    rate_error=self._error("rate", **override),
                    # The scale factor of the yaw has no effect.
                    yaw_error=self._error("yaw", scale=1.0),
                    bias_topic=_or(config.bias_topic, f"{topic}/bias"),
                    calibration_service=_or(config.service, f"{topic}/calibrate"),
                    acceleration_bias_service=f"{topic}/set_accel_bias",
                    rate_bias_service=f"{topic}/set_rate_bias",
                ),
            )
        )

    def _error(self, kind: str, **instead: Any) -> DriftingErrorConfig:
        # In the original plugin, the standard deviation of the drift depends on the step length.
        name = f"imu {self.config.topic} {kind}"
        return drifting_error(self, name, prefix=f"{kind}_", **instead)


def _or(stated: str | None, default: str) -> str:
    return default if stated is None else stated
