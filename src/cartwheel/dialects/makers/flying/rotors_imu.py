"""``librotors_gazebo_imu_plugin.so``: an inertial measurement unit with drifting biases."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.devices.inertial.imu import Imu, ImuConfig
from cartwheel.devices.inertial.unit import InertialUnitConfig
from cartwheel.devices.noise import DriftingErrorConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag
from cartwheel.geometry import Pose


@dataclass(frozen=True, kw_only=True, slots=True)
class RotorsImuParameters:
    link: str = tag(
        "linkName", role="link", doc="Link that carries the IMU, and frame ID of the messages."
    )
    topic: str = tag("imuTopic", default="imu", doc="Topic of the Imu messages.")
    rate_noise: float = tag(
        "gyroscopeNoiseDensity",
        default=math.radians(70 / 3600),
        unit="rad/s/√Hz",
        least=0.0,
        doc="Noise density of the angular velocity.",
    )
    rate_walk: float = tag(
        "gyroscopeBiasRandomWalk",
        "gyroscopeRandomWalk",
        default=math.radians(8 / 3600),
        unit="rad/s²/√Hz",
        least=0.0,
        doc="Random walk of the gyroscope bias.",
    )
    rate_time: float = tag(
        "gyroscopeBiasCorrelationTime",
        default=1000.0,
        unit="s",
        least=SMALLEST,
        doc="Correlation time of the gyroscope bias.",
    )
    rate_bias: float = tag(
        "gyroscopeTurnOnBiasSigma",
        default=math.radians(0.5),
        unit="rad/s",
        least=0.0,
        doc="Standard deviation of the gyroscope's turn-on bias, which stays constant.",
    )
    accel_noise: float = tag(
        "accelerometerNoiseDensity",
        default=4e-3,
        unit="m/s²/√Hz",
        least=0.0,
        doc="Noise density of the acceleration.",
    )
    accel_walk: float = tag(
        "accelerometerRandomWalk",
        default=6e-3,
        unit="m/s³/√Hz",
        least=0.0,
        doc="Random walk of the accelerometer bias.",
    )
    accel_time: float = tag(
        "accelerometerBiasCorrelationTime",
        default=300.0,
        unit="s",
        least=SMALLEST,
        doc="Correlation time of the accelerometer bias.",
    )
    accel_bias: float = tag(
        "accelerometerTurnOnBiasSigma",
        default=0.196,
        unit="m/s²",
        least=0.0,
        doc="Standard deviation of the accelerometer's turn-on bias, which stays constant.",
    )


class RotorsImu(Plugin[RotorsImuParameters]):
    """Publishes the measurements of an IMU, with white noise and drifting biases.

    A message is published at every simulation step. The noise density is converted to the standard
    deviation of the noise in one step. Each bias is the sum of a constant turn-on bias and a random
    walk with a correlation time. The initial value of the random walk is drawn from its stationary
    distribution. Original plugin: ``gazebo_imu_plugin`` in the package ``rotors_gazebo_plugins``.
    See also REP 145.
    """

    filenames: ClassVar[tuple[str, ...]] = ("librotors_gazebo_imu_plugin.so",)

    def configure(self) -> None:
        config = self.config
        self.add(
            Imu(
                self.scope,
                ImuConfig(
                    unit=InertialUnitConfig(link=config.link, mount=Pose()),
                    topic=self._topic(),
                    frame=config.link,
                    rate=0.0,
                    rate_error=self._error(
                        "rate", config.rate_noise, config.rate_walk, config.rate_time,
                        config.rate_bias,
                    ),
                    acceleration_error=self._error(
                        "accel", config.accel_noise, config.accel_walk, config.accel_time,
                        config.accel_bias,
                    ),
                    # As in the original plugin: the orientation is published, but marked as not
                    # measured, and the covariances are the squares of the noise densities.
                    orientation_covariance=np.full(9, -1.0),
                    rate_covariance=np.diag([config.rate_noise**2] * 3).ravel(),
                    acceleration_covariance=np.diag([config.accel_noise**2] * 3).ravel(),
                ),
            )
        )  # fmt: skip

    def _topic(self) -> str:
        return self.config.topic

    def _error(
        self, kind: str, density: float, walk: float, time: float, bias: float
    ) -> DriftingErrorConfig:
        part = self.part
        name = f"rotors imu {self.tag.name} {kind}"
        seconds = part.period_ns(0) * 1e-9
        return DriftingErrorConfig(
            name=name,
            rate=0.0,
            offset=[0.0] * 3,
            bias=bias,
            drift=[walk * math.sqrt(time / 2)] * 3,
            frequency=[1 / time] * 3,
            noise=[density / math.sqrt(seconds)] * 3,
            scale=[1.0] * 3,
        )
