"""PX4's sensors for Gazebo Classic: IMU, magnetometer and barometer."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.noise import DriftingErrorConfig, Noise, VectorNoiseConfig
from cartwheel.devices.position.barometer import PressureSensor, PressureSensorConfig
from cartwheel.devices.position.earth_field import earth_field
from cartwheel.devices.position.magnetometer import Magnetometer, MagnetometerConfig
from cartwheel.dialects.gz.bridge_file import gz_topic
from cartwheel.dialects.makers.flying.px4_home import home_of
from cartwheel.dialects.makers.flying.rotors_imu import RotorsImu, RotorsImuParameters
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag

_GAUSS = 1e-4
"""T."""
_PRESSURE_NOISE = 1.0
"""Standard deviation of the barometer's noise, Pa."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Px4ImuParameters(RotorsImuParameters):
    topic: str = tag(
        "imuTopic",
        default="/imu",
        doc="Topic of the Imu messages. The model's name is prepended.",
    )


class Px4Imu(RotorsImu):
    """Publishes the measurements of PX4's IMU, with white noise and drifting biases.

    The errors are those of ``librotors_gazebo_imu_plugin.so``. The axes are those of the link:
    forward, left, up. Original plugin: ``gazebo_imu_plugin`` in ``PX4-SITL_gazebo-classic``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_imu_plugin.so",)
    parameters: ClassVar[type] = Px4ImuParameters

    def _topic(self) -> str:
        return px4_topic(self, self.config.topic)


@dataclass(frozen=True, kw_only=True, slots=True)
class Px4MagnetometerParameters:
    rate: float = tag("pubRate", default=100.0, unit="Hz", least=SMALLEST, doc="Publish rate.")
    noise: float = tag(
        "noiseDensity", default=4e-4, unit="Gauss/√Hz", least=0.0, doc="Noise density of the field."
    )
    walk: float = tag(
        "randomWalk", default=6.4e-6, unit="Gauss/s/√Hz", least=0.0, doc="Random walk of the bias."
    )
    time: float = tag(
        "biasCorrelationTime",
        default=600.0,
        unit="s",
        least=SMALLEST,
        doc="Correlation time of the bias.",
    )
    topic: str = tag(
        "magTopic",
        default="/mag",
        doc="Topic of the MagneticField messages. The model's name is prepended.",
    )


class Px4Magnetometer(Plugin[Px4MagnetometerParameters]):
    """Publishes the Earth's magnetic field in the frame of the root link, in tesla.

    The field is that of the World Magnetic Model at the world's origin. The axes are forward, left,
    up; the original plugin publishes the field in Gauss, with axes forward, right, down. Original
    plugin: ``gazebo_magnetometer_plugin`` in ``PX4-SITL_gazebo-classic``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_magnetometer_plugin.so",)

    def configure(self) -> None:
        config = self.config
        link, home = self.part.description.canonical_link, home_of(self.part)
        self.add(
            Magnetometer(
                self.scope,
                MagnetometerConfig(
                    link=link,
                    field=earth_field(home.latitude, home.longitude),
                    topic=px4_topic(self, config.topic),
                    frame=link,
                    rate=config.rate,
                    error=DriftingErrorConfig(
                        name=f"px4 magnetometer {self.tag.name}",
                        rate=config.rate,
                        offset=[0.0] * 3,
                        drift=[_GAUSS * config.walk * math.sqrt(config.time / 2)] * 3,
                        frequency=[1 / config.time] * 3,
                        noise=[_GAUSS * config.noise * math.sqrt(config.rate)] * 3,
                        scale=[1.0] * 3,
                    ),
                ),
            )
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Px4BarometerParameters:
    rate: float = tag("pubRate", default=50.0, unit="Hz", least=SMALLEST, doc="Publish rate.")
    topic: str = tag(
        "baroTopic",
        default="/baro",
        doc="Topic of the FluidPressure messages. The model's name is prepended.",
    )
    drift: float = tag(
        "baroDriftPaPerSec", default=0.0, unit="Pa/s", doc="Change of the pressure with time."
    )


class Px4Barometer(Plugin[Px4BarometerParameters]):
    """Publishes the air pressure of the International Standard Atmosphere at the root link.

    The noise has a standard deviation of 1 Pa. Original plugin: ``gazebo_barometer_plugin`` in
    ``PX4-SITL_gazebo-classic``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_barometer_plugin.so",)

    def configure(self) -> None:
        config, link = self.config, self.part.description.canonical_link
        self.add(
            PressureSensor(
                self.scope,
                PressureSensorConfig(
                    link=link,
                    mount=(0.0, 0.0, 0.0),
                    elevation=home_of(self.part).height,
                    topic=px4_topic(self, config.topic),
                    frame=link,
                    rate=config.rate,
                    error=VectorNoiseConfig(
                        name=f"px4 barometer {self.tag.name}",
                        noises=(Noise(stddev=_PRESSURE_NOISE),),
                        rate=config.rate,
                    ),
                    drift=config.drift,
                ),
            )
        )


def px4_topic(plugin: Plugin, topic: str) -> str:  # type: ignore[type-arg]
    """Returns the global name of a topic, which begins with the model's name."""
    return gz_topic(f"{plugin.part.name}/{topic.strip().strip('/')}")
