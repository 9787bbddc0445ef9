"""``libhector_gazebo_ros_magnetic.so``: a magnetometer with drift."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.position.magnetometer import (
    Magnetometer,
    MagnetometerConfig,
    dipole_field,
)
from cartwheel.dialects.common_tags import ZEROS, deviation_tag, link_frame_tag, publish_rate_tag
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
from cartwheel.geometry import Vec3


@dataclass(frozen=True, kw_only=True, slots=True)
class HectorMagneticParameters:
    body: str = tag(
        "bodyName",
        default="",
        role="link",
        doc="Link that carries the magnetometer. Default: the root link.",
    )
    topic: str = tag(
        "topicName",
        default="magnetic",
        doc="Topic of the Vector3Stamped or MagneticField messages.",
    )
    frame: str = link_frame_tag("frameId")
    update_rate: float = publish_rate_tag("updateRate")
    magnitude: float = tag(
        "magnitude",
        default=1.0,
        doc="Magnitude of the field, in the unit that the messages should have.",
    )
    use_world: bool = tag(
        "useWorldSphericalCoordinates",
        default=False,
        doc="Whether the heading in the world's `<spherical_coordinates>` is the default of "
        "`<referenceHeading>`.",
    )
    heading: float | None = tag(
        "referenceHeading",
        default=None,
        unit="degrees",
        doc="Heading of the world's x axis, clockwise from north. Default: 0, or the "
        "world's heading if `<useWorldSphericalCoordinates>` is true.",
    )
    declination: float = tag(
        "declination",
        default=0.0,
        unit="degrees",
        doc="Declination of the field, positive to the east.",
    )
    inclination: float = tag(
        "inclination",
        default=60.0,
        unit="degrees",
        doc="Inclination of the field, positive downward.",
    )
    as_field: bool = tag(
        "useMagneticFieldMsgs",
        default=False,
        doc="Whether to publish MagneticField messages instead of Vector3Stamped messages.",
    )
    offset: tuple[float, float, float] = offset_tag(
        "offset", default=ZEROS, of="the measured field"
    )
    drift: tuple[float, float, float] = deviation_tag("drift", default=ZEROS, of="the drift")
    frequency: tuple[float, float, float] = frequency_tag("driftFrequency", default=HOURS)
    noise: tuple[float, float, float] = deviation_tag(
        "gaussianNoise", default=ZEROS, of="the noise"
    )
    scale: tuple[float, float, float] = tag(
        "scaleError", default=UNSCALED, doc="Scale factor on the measured field."
    )


class HectorMagnetic(Plugin[HectorMagneticParameters]):
    """Publishes the Earth's magnetic field in the link frame.

    The measured field has the same kinds of errors as the acceleration in
    ``libhector_gazebo_ros_imu.so``: an offset, a drift, noise and a scale factor. Original plugin:
    ``gazebo_ros_magnetic`` in the package ``hector_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libhector_gazebo_ros_magnetic.so",)

    def configure(self) -> None:
        config = self.config
        link = config.body or self.part.description.canonical_link
        self.add(
            Magnetometer(
                self.scope,
                MagnetometerConfig(
                    link=link,
                    field=self._field(),
                    topic=config.topic,
                    frame=config.frame or link,
                    rate=config.update_rate,
                    error=drifting_error(self, f"magnetic {config.topic}"),
                    as_vector=not config.as_field,
                ),
            )
        )

    def _field(self) -> Vec3:
        config = self.config
        heading = 0.0
        if config.use_world:
            datum = read_datum(self.part.world.spherical_coordinates)
            heading = 90.0 - math.degrees(datum.heading) if datum is not None else 90.0
        if config.heading is not None:
            heading = config.heading
        return dipole_field(
            config.magnitude,
            math.radians(heading - config.declination),
            math.radians(config.inclination),
        )
