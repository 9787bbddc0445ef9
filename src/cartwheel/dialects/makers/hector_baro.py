"""``libhector_gazebo_ros_baro.so``: a barometric altimeter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.position.barometer import BarometricAltimeter, BarometricAltimeterConfig
from cartwheel.dialects.common_tags import deviation_tag, link_frame_tag, publish_rate_tag
from cartwheel.dialects.drift_tags import drifting_error, frequency_tag, offset_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class HectorBaroParameters:
    body: str = tag(
        "bodyName", default="", role="link", doc="Link of the barometer. Default: the root link."
    )
    topic: str = tag(
        "topicName",
        default="pressure_height",
        doc="Topic of the z position (PointStamped). Not published if empty.",
    )
    altimeter_topic: str = tag(
        "altimeterTopicName",
        default="altimeter",
        doc="Topic of the Altimeter messages. Not published if empty.",
    )
    frame: str = link_frame_tag("frameId")
    update_rate: float = publish_rate_tag("updateRate")
    elevation: float = tag(
        "elevation", default=0.0, unit="m", doc="Altitude of the world's origin above sea level."
    )
    qnh: float = tag("qnh", default=1013.25, unit="hPa", doc="Pressure at sea level.")
    offset: float = offset_tag("offset", unit="m", of="the z position")
    drift: float = deviation_tag("drift", unit="m", of="the drift")
    frequency: float = frequency_tag("driftFrequency")
    noise: float = deviation_tag("gaussianNoise", unit="m", of="the noise")
    scale: float = tag("scaleError", default=1.0, doc="Scale factor on the z position.")


class HectorBaro(Plugin[HectorBaroParameters]):
    """Publishes a link's height in the world, its altitude above sea level and the air pressure.

    The height has the same kinds of errors as the acceleration in ``libhector_gazebo_ros_imu.so``:
    an offset, a drift, noise and a scale factor. The air pressure is computed from the measured
    altitude: ``pressure = qnh (1 - altitude / 44330 m) ^ 5.263157``. Original plugin:
    ``gazebo_ros_baro`` in the package ``hector_quadrotor_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libhector_gazebo_ros_baro.so",)

    def configure(self) -> None:
        config = self.config
        link = config.body or self.part.description.canonical_link
        self.add(
            BarometricAltimeter(
                self.scope,
                BarometricAltimeterConfig(
                    link=link,
                    elevation=config.elevation,
                    qnh=config.qnh,
                    height_topic=config.topic or None,
                    altitude_topic=config.altimeter_topic or None,
                    frame=config.frame or link,
                    rate=config.update_rate,
                    error=drifting_error(self, f"baro {config.topic} {config.altimeter_topic}"),
                ),
            )
        )
