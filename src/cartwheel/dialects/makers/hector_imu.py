"""``libhector_gazebo_ros_imu.so``: an inertial measurement unit with drift."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.inertial.imu import Imu, ImuConfig
from cartwheel.devices.inertial.unit import InertialUnitConfig
from cartwheel.devices.noise import DriftingErrorConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.geometry import Pose, quat_from_rpy

_NONE = (0.0, 0.0, 0.0)
_HOUR = 1 / 3600.0


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
    frame: str = tag(
        "frameId",
        default="",
        role="frame",
        doc="Frame ID of the messages. Default: the link in `<bodyName>`.",
    )
    update_rate: float = tag(
        "updateRate",
        default=0.0,
        unit="Hz",
        least=0.0,
        doc="Publish rate. If 0, messages are published at every simulation step.",
    )
    xyz_offset: tuple[float, float, float] = tag(
        "xyzOffset",
        "xyzOffsets",
        default=_NONE,
        unit="m",
        doc="Position of the IMU in the link frame.",
    )
    rpy_offset: tuple[float, float, float] = tag(
        "rpyOffset",
        "rpyOffsets",
        default=_NONE,
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
    accel_offset: tuple[float, float, float] = tag(
        "accelOffset", default=_NONE, unit="m/s²", doc="Constant error of the acceleration."
    )
    accel_drift: tuple[float, float, float] = tag(
        "accelDrift",
        default=_NONE,
        unit="m/s²",
        least=0.0,
        doc="Standard deviation of the acceleration's drift.",
    )
    accel_frequency: tuple[float, float, float] = tag(
        "accelDriftFrequency",
        default=(_HOUR,) * 3,
        unit="1/s",
        least=0.0,
        doc="Inverse of the time constant of the acceleration's drift.",
    )
    accel_noise: tuple[float, float, float] = tag(
        "accelGaussianNoise",
        default=_NONE,
        unit="m/s²",
        least=0.0,
        doc="Standard deviation of the acceleration's noise.",
    )
    accel_scale: tuple[float, float, float] = tag(
        "accelScaleError", default=(1.0,) * 3, doc="Scale factor on the acceleration."
    )
    rate_offset: tuple[float, float, float] = tag(
        "rateOffset", default=_NONE, unit="rad/s", doc="Constant error of the angular velocity."
    )
    rate_drift: tuple[float, float, float] = tag(
        "rateDrift",
        default=_NONE,
        unit="rad/s",
        least=0.0,
        doc="Standard deviation of the angular velocity's drift.",
    )
    rate_frequency: tuple[float, float, float] = tag(
        "rateDriftFrequency",
        default=(_HOUR,) * 3,
        unit="1/s",
        least=0.0,
        doc="Inverse of the time constant of the angular velocity's drift.",
    )
    rate_noise: tuple[float, float, float] = tag(
        "rateGaussianNoise",
        default=_NONE,
        unit="rad/s",
        least=0.0,
        doc="Standard deviation of the angular velocity's noise.",
    )
    rate_scale: tuple[float, float, float] = tag(
        "rateScaleError", default=(1.0,) * 3, doc="Scale factor on the angular velocity."
    )
    yaw_offset: float = tag(
        "yawOffset", "headingOffset", default=0.0, unit="rad", doc="Constant error of the yaw."
    )
    yaw_drift: float = tag(
        "yawDrift",
        "headingDrift",
        default=0.0,
        unit="rad",
        least=0.0,
        doc="Standard deviation of the yaw's drift.",
    )
    yaw_frequency: float = tag(
        "yawDriftFrequency",
        "headingDriftFrequency",
        default=_HOUR,
        unit="1/s",
        least=0.0,
        doc="Inverse of the time constant of the yaw's drift.",
    )
    yaw_noise: float = tag(
        "yawGaussianNoise",
        "headingGaussianNoise",
        default=0.0,
        unit="rad",
        least=0.0,
        doc="Standard deviation of the yaw's noise.",
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
    parameters: ClassVar[type] = HectorImuParameters

    def configure(self) -> None:
        config = self.config
        link = config.body or self.part.description.canonical_link
        mount = Pose(config.xyz_offset, quat_from_rpy(*config.rpy_offset))
        topic = config.topic
        self.add(
            Imu(
                self.scope,
                ImuConfig(
                    unit=InertialUnitConfig(link=link, mount=mount),
                    topic=topic,
                    frame=config.frame or link,
                    rate=config.update_rate,
                    acceleration_error=self._error(
                        "accel",
                        (config.accel_offset, config.accel_drift, config.accel_frequency),
                        (config.noise,) * 3 if config.noise > 0 else config.accel_noise,
                        config.accel_scale,
                    ),
                    rate_error=self._error(
                        "rate",
                        (config.rate_offset, config.rate_drift, config.rate_frequency),
                        (config.noise,) * 3 if config.noise > 0 else config.rate_noise,
                        config.rate_scale,
                    ),
                    yaw_error=self._error(
                        "yaw",
                        ((config.yaw_offset,), (config.yaw_drift,), (config.yaw_frequency,)),
                        (config.yaw_noise,),
                        (1.0,),
                    ),
                    bias_topic=_or(config.bias_topic, f"{topic}/bias"),
                    calibration_service=_or(config.service, f"{topic}/calibrate"),
                    acceleration_bias_service=f"{topic}/set_accel_bias",
                    rate_bias_service=f"{topic}/set_rate_bias",
                ),
            )
        )

    def _error(
        self,
        name: str,
        drift: tuple[Sequence[float], Sequence[float], Sequence[float]],
        noise: Sequence[float],
        scale: Sequence[float],
    ) -> DriftingErrorConfig:
        offset, deviation, frequency = drift
        # In the original plugin, the standard deviation of the drift depends on the step length.
        return DriftingErrorConfig(
            name=f"imu {self.config.topic} {name}",
            rate=self.config.update_rate,
            offset=offset,
            drift=deviation,
            frequency=frequency,
            noise=noise,
            scale=scale,
        )


def _or(stated: str | None, default: str) -> str:
    return default if stated is None else stated
