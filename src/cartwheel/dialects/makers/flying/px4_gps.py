"""PX4's satellite receiver and ground truth for Gazebo Classic."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.description.model import PluginTag, Sensor
from cartwheel.devices.noise import DriftingErrorConfig, Noise, VectorNoiseConfig
from cartwheel.devices.position.gps import Gps, GpsConfig
from cartwheel.dialects.gz.bridge_file import gz_topic
from cartwheel.dialects.makers.flying.px4_home import HomeTags, home_of
from cartwheel.dialects.makers.flying.px4_sensors import px4_topic
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag

GPS_PLUGIN = "libgazebo_gps_plugin.so"
_DECAY_STEPS = 60.0
"""Steps in which the position's bias decays: the original plugin does not multiply its correlation
time by the time step."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Px4GpsParameters(HomeTags):
    topic: str = tag(
        "topic",
        default="",
        doc="Last part of the topic. Default: the name of the receiver's model.",
    )
    rate: float = tag("update_rate", default=5.0, unit="Hz", least=SMALLEST, doc="Publish rate.")
    noisy: bool = tag("gpsNoise", default=False, doc="Whether the measurements have errors.")
    walk: float = tag(
        "gpsXYRandomWalk",
        default=2.0,
        unit="m/s/√Hz",
        least=0.0,
        doc="Random walk of the horizontal position.",
    )
    walk_up: float = tag(
        "gpsZRandomWalk",
        default=4.0,
        unit="m/s/√Hz",
        least=0.0,
        doc="Random walk of the altitude.",
    )
    noise: float = tag(
        "gpsXYNoiseDensity",
        default=2e-4,
        unit="m/√s",
        least=0.0,
        doc="Noise of the horizontal position; multiplied by the square root of the time step.",
    )
    noise_up: float = tag(
        "gpsZNoiseDensity",
        default=4e-4,
        unit="m/√s",
        least=0.0,
        doc="Noise of the altitude; multiplied by the square root of the time step.",
    )
    velocity_noise: float = tag(
        "gpsVXYNoiseDensity",
        default=0.2,
        unit="m/s/√s",
        least=0.0,
        doc="Noise of the horizontal velocity; multiplied by the square root of the time step.",
    )
    velocity_noise_up: float = tag(
        "gpsVZNoiseDensity",
        default=0.4,
        unit="m/s/√s",
        least=0.0,
        doc="Noise of the vertical velocity; multiplied by the square root of the time step.",
    )


class Px4Gps(Plugin[Px4GpsParameters]):
    """Publishes the geographic position and the velocity of the model's root link.

    The messages are NavSatFix messages on ``/<model>/link/<topic>``, and Vector3Stamped messages
    with the components east, north and up on ``/<model>/link/<topic>_velocity``. Original plugin:
    ``gazebo_gps_plugin`` in ``PX4-SITL_gazebo-classic``.
    """

    filenames: ClassVar[tuple[str, ...]] = (GPS_PLUGIN,)
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "gps"

    def configure(self) -> None:
        config, part, sensor = self.config, self.part, self.sensor
        assert sensor is not None
        topic, velocity_topic = gps_topics(part.name, sensor, self.tag)
        seconds = part.period_ns(0) * 1e-9
        root = math.sqrt(seconds) if config.noisy else 0.0
        # Deviation of a random walk that decays by 1/60 in each step.
        walk = seconds * root * math.sqrt(_DECAY_STEPS / 2)
        self.add(
            Gps(
                self.scope,
                GpsConfig(
                    link=part.description.canonical_link,
                    projection=home_of(part, config),
                    topic=topic,
                    velocity_topic=velocity_topic,
                    frame=sensor.link,
                    rate=config.rate,
                    error=self._error(
                        "position",
                        (config.noise * root, config.noise_up * root),
                        (config.walk * walk, config.walk_up * walk),
                        1 / (_DECAY_STEPS * seconds),
                    ),
                    velocity_error=self._error(
                        "velocity",
                        (config.velocity_noise * root, config.velocity_noise_up * root),
                        (0.0, 0.0),
                        1.0,
                    ),
                    velocity_error_axes="geographic",
                ),
            )
        )

    def _error(
        self,
        name: str,
        noise: tuple[float, float],
        drift: tuple[float, float],
        frequency: float,
    ) -> DriftingErrorConfig:
        """Returns errors, of which the horizontal and the vertical deviations are given."""
        return DriftingErrorConfig(
            name=f"px4 gps {self.tag.name} {name}",
            rate=self.config.rate,
            offset=[0.0] * 3,
            drift=[drift[0], *drift],
            frequency=[frequency] * 3,
            noise=[noise[0], *noise],
            scale=[1.0] * 3,
        )


def gps_topics(model: str, sensor: Sensor, plugin: PluginTag) -> tuple[str, str]:
    """Returns the topics of a receiver's position and velocity."""
    element = plugin.element.find("topic")
    name = element.text.strip() if element is not None else ""
    *models, _ = f"{model}::{sensor.link}".split("::")
    topic = gz_topic(f"{model}/link/{name or models[-1]}")
    return topic, f"{topic}_velocity"


class Px4GroundTruth(Plugin[HomeTags]):
    """Publishes the true geographic position of the root link at every simulation step.

    The topic is ``/<model>/groundtruth`` (NavSatFix). Original plugin:
    ``gazebo_groundtruth_plugin`` in ``PX4-SITL_gazebo-classic``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_groundtruth_plugin.so",)

    def configure(self) -> None:
        link = self.part.description.canonical_link
        none = VectorNoiseConfig(name="px4 groundtruth", noises=(Noise(),) * 3, rate=0.0)
        self.add(
            Gps(
                self.scope,
                GpsConfig(
                    link=link,
                    projection=home_of(self.part, self.config),
                    topic=px4_topic(self, "groundtruth"),
                    velocity_topic=None,
                    frame=link,
                    rate=0.0,
                    error=none,
                    velocity_error=none,
                    velocity_error_axes="geographic",
                ),
            )
        )
