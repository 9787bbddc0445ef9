"""``libhector_gazebo_ros_gps.so``: a receiver of satellite navigation with drift."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.devices.position.geodesy import Datum, FlatDatum
from cartwheel.devices.position.gps import Gps, GpsConfig
from cartwheel.dialects.common_tags import ZEROS, deviation_tag, publish_rate_tag
from cartwheel.dialects.drift_tags import (
    HOURS,
    UNSCALED,
    drifting_error,
    frequency_tag,
    offset_tag,
)
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.spherical_coordinates import read_datum
from cartwheel.dialects.tags import tag


@dataclass(frozen=True, kw_only=True, slots=True)
class HectorGpsParameters:
    body: str = tag(
        "bodyName", default="", role="link", doc="Link of the receiver. Default: the root link."
    )
    topic: str = tag("topicName", default="fix", doc="Topic of the NavSatFix messages.")
    velocity_topic: str = tag(
        "velocityTopicName",
        default="fix_velocity",
        doc="Topic of the velocity (Vector3Stamped). Its components are north, west and up.",
    )
    frame: str = tag("frameId", default="/world", role="frame", doc="Frame ID of the messages.")
    update_rate: float = publish_rate_tag("updateRate", default=4.0)
    use_world: bool = tag(
        "useWorldSphericalCoordinates",
        default=False,
        doc="Whether the world's `<spherical_coordinates>` are the defaults of the four "
        "reference tags below.",
    )
    latitude: float | None = tag(
        "referenceLatitude",
        default=None,
        unit="degrees",
        doc="Latitude of the world's origin. Default: 49.9, or the world's latitude if "
        "`<useWorldSphericalCoordinates>` is true.",
    )
    longitude: float | None = tag(
        "referenceLongitude",
        default=None,
        unit="degrees",
        doc="Longitude of the world's origin. Default: 8.9, or the world's longitude if "
        "`<useWorldSphericalCoordinates>` is true.",
    )
    altitude: float | None = tag(
        "referenceAltitude",
        default=None,
        unit="m",
        doc="Altitude of the world's origin. Default: 0, or the world's altitude if "
        "`<useWorldSphericalCoordinates>` is true.",
    )
    heading: float | None = tag(
        "referenceHeading",
        default=None,
        unit="degrees",
        doc="Heading of the world's x axis, clockwise from north. At 0, x points north and "
        "y west. Default: 0, or the world's heading if `<useWorldSphericalCoordinates>` "
        "is true.",
    )
    status: int = tag("status", default=0, doc="Value of the field `status` in NavSatStatus.")
    service: int = tag("service", default=0, doc="Value of the field `service` in NavSatStatus.")
    offset: tuple[float, float, float] = offset_tag(
        "offset", default=ZEROS, unit="m", of="the position"
    )
    drift: tuple[float, float, float] = deviation_tag(
        "drift", default=ZEROS, unit="m", of="the position's drift"
    )
    frequency: tuple[float, float, float] = frequency_tag(
        "driftFrequency", default=HOURS, of="the position's drift"
    )
    noise: tuple[float, float, float] = deviation_tag(
        "gaussianNoise", default=ZEROS, unit="m", of="the position's noise"
    )
    scale: tuple[float, float, float] = tag(
        "scaleError", default=UNSCALED, doc="Scale factor of the position."
    )
    velocity_offset: tuple[float, float, float] = offset_tag(
        "velocityOffset", default=ZEROS, unit="m/s", of="the velocity"
    )
    velocity_drift: tuple[float, float, float] = deviation_tag(
        "velocityDrift", default=ZEROS, unit="m/s", of="the velocity's drift"
    )
    velocity_frequency: tuple[float, float, float] = frequency_tag(
        "velocityDriftFrequency", default=HOURS, of="the velocity's drift"
    )
    velocity_noise: tuple[float, float, float] = deviation_tag(
        "velocityGaussianNoise", default=ZEROS, unit="m/s", of="the velocity's noise"
    )
    velocity_scale: tuple[float, float, float] = tag(
        "velocityScaleError", default=UNSCALED, doc="Scale factor of the velocity."
    )


class HectorGps(Plugin[HectorGpsParameters]):
    """Publishes the latitude, longitude, altitude and velocity of a link.

    As in the original plugin, the Earth is treated as flat around the reference point, which is the
    world's origin. Within a few kilometres, the resulting error is below 1 m. The position and the
    velocity have the same kinds of errors as the acceleration in ``libhector_gazebo_ros_imu.so``:
    an offset, a drift, noise and a scale factor. Original plugin: ``gazebo_ros_gps`` in the package
    ``hector_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libhector_gazebo_ros_gps.so",)

    def configure(self) -> None:
        config = self.config
        self.add(
            Gps(
                self.scope,
                GpsConfig(
                    link=config.body or self.part.description.canonical_link,
                    projection=self._datum(),
                    topic=config.topic,
                    velocity_topic=config.velocity_topic,
                    frame=config.frame,
                    rate=config.update_rate,
                    error=drifting_error(self, f"gps {config.topic} position"),
                    velocity_error=drifting_error(
                        self, f"gps {config.topic} velocity", prefix="velocity_"
                    ),
                    velocity_error_axes="world",
                    # As in the original plugin, it includes the drift.
                    covariance=np.diag(np.square(config.drift) + np.square(config.noise)).ravel(),
                    status=config.status,
                    service=config.service,
                ),
            )
        )

    def _datum(self) -> FlatDatum:
        config = self.config
        latitude, longitude, altitude, heading = 49.9, 8.9, 0.0, 0.0
        if config.use_world:
            datum = read_datum(self.part.world.spherical_coordinates) or Datum()
            latitude, longitude = math.degrees(datum.latitude), math.degrees(datum.longitude)
            altitude, heading = datum.height, 90.0 - math.degrees(datum.heading)
        return FlatDatum(
            latitude=latitude if config.latitude is None else config.latitude,
            longitude=longitude if config.longitude is None else config.longitude,
            height=altitude if config.altitude is None else config.altitude,
            heading=math.radians(heading if config.heading is None else config.heading),
        )
