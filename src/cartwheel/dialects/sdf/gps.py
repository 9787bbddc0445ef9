"""SDF's ``<gps>`` and ``<navsat>`` elements."""

from __future__ import annotations

from cartwheel.codes import devices
from cartwheel.description.model import Sensor
from cartwheel.devices.noise import VectorNoiseConfig
from cartwheel.devices.position.geodesy import Datum
from cartwheel.devices.position.gps import GpsConfig
from cartwheel.dialects.sdf.noise import read_vector_noise
from cartwheel.dialects.sdf.spherical_coordinates import read_datum
from cartwheel.simulation import Part


def read_gps(
    part: Part,
    sensor: Sensor,
    element: str,
    *,
    topic: str,
    velocity_topic: str | None,
    frame: str,
) -> GpsConfig:
    """Reads a ``gps`` or ``navsat`` sensor, whose world has ``<spherical_coordinates>``.

    Args:
        part: The model's part of the simulation.
        sensor: The sensor.
        element: Element with the noise: ``gps`` or ``navsat``.
        topic: Topic of the position.
        velocity_topic: Topic of the velocity; None: not published.
        frame: Frame ID of the messages.

    Raises:
        PluginError: A number or the noise is invalid.
    """
    datum = read_datum(part.world.spherical_coordinates)
    if datum is None:
        part.report(
            devices.COORDINATES_MISSING.diagnostic(
                f'sensor "{sensor.name}" uses latitude 0 and longitude 0 as the world\'s origin, '
                "because the world has no <spherical_coordinates>",
                origin=sensor.origin,
                values={"sensor": sensor.name},
            )
        )
    return GpsConfig(
        link=sensor.link,
        mount=sensor.pose.position,
        projection=datum or Datum(),
        topic=topic,
        velocity_topic=velocity_topic,
        frame=frame,
        rate=sensor.update_rate,
        error=_noise(part, sensor, element, "position_sensing"),
        velocity_error=_noise(part, sensor, element, "velocity_sensing"),
        velocity_error_axes="geographic",
    )


def _noise(part: Part, sensor: Sensor, element: str, name: str) -> VectorNoiseConfig:
    """Returns the noise along three axes, of which the third is vertical."""
    parent = sensor.element.find(f"{element}/{name}")
    horizontal, vertical = (
        parent.find(f"{axis}/noise") if parent is not None else None
        for axis in ("horizontal", "vertical")
    )
    elements = [horizontal, horizontal, vertical]
    return read_vector_noise(part, sensor, f"gps {sensor.link} {sensor.name} {name}", elements)
