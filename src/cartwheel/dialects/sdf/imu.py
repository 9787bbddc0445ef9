"""SDF's ``<imu>`` element: noise and reference frame of an inertial measurement unit."""

from __future__ import annotations

import math

from cartwheel.codes import devices
from cartwheel.description.model import Element, Sensor
from cartwheel.devices.inertial.unit import InertialUnitConfig
from cartwheel.devices.noise import VectorNoiseConfig
from cartwheel.dialects.sdf.noise import read_vector_noise
from cartwheel.dialects.sdf.spherical_coordinates import read_datum
from cartwheel.dialects.tags import invalid, vector
from cartwheel.geometry import (
    IDENTITY,
    Pose,
    Quat,
    quat_conjugate,
    quat_from_axis_angle,
    quat_from_rpy,
    quat_multiply,
)
from cartwheel.simulation import Part

_LOCALIZATIONS = {
    "ENU": (0.0, 0.0, 0.0),
    "NWU": (0.0, 0.0, math.pi / 2),
    "NED": (math.pi, 0.0, math.pi / 2),
}
"""Roll, pitch and yaw of SDF's localizations, relative to east, north, up."""


def read_inertial_unit(
    part: Part, sensor: Sensor, *, mount: Pose | None = None, from_first: bool = False
) -> InertialUnitConfig:
    """Reads an ``imu`` sensor.

    Args:
        part: The model's part of the simulation.
        sensor: The sensor.
        mount: Pose of the IMU in the link. None: the sensor's pose.
        from_first: Measure the orientation relative to the initial one, unless the sensor has an
            ``<orientation_reference_frame>``.

    Raises:
        PluginError: The sensor's ``<imu>`` is invalid.
    """
    mount = sensor.pose if mount is None else mount
    world = IDENTITY
    if from_first:
        described = part.description.link(sensor.link)
        assert described is not None
        first = part.start @ described.pose @ mount
        world = quat_conjugate(first.orientation)
    element = sensor.element.find("imu")
    if element is None:
        return InertialUnitConfig(link=sensor.link, mount=mount, world=world)
    enable = element.find("enable_orientation")
    frame = element.find("orientation_reference_frame")
    if frame is not None:
        world = quat_conjugate(_reference(part, frame))
    rate_noise, acceleration_noise = (
        _noise(part, sensor, element, name, older)
        for name, older in (("angular_velocity", "rate"), ("linear_acceleration", "accel"))
    )
    return InertialUnitConfig(
        link=sensor.link,
        mount=mount,
        world=world,
        has_orientation=enable is None or enable.text.strip().lower() not in ("false", "0"),
        rate_noise=rate_noise,
        acceleration_noise=acceleration_noise,
    )


def _noise(
    part: Part, sensor: Sensor, element: Element, name: str, older: str
) -> VectorNoiseConfig:
    elements = [element.find(f"{name}/{axis}/noise") for axis in "xyz"]
    if element.find(name) is None:
        # SDF 1.4: one noise for all axes.
        elements = [element.find(f"noise/{older}")] * 3
    return read_vector_noise(part, sensor, f"imu {sensor.link} {sensor.name} {name}", elements)


def _reference(part: Part, frame: Element) -> Quat:
    """Orientation of an ``<orientation_reference_frame>`` in the world.

    Raises:
        PluginError: Unknown ``<localization>``, or invalid numbers.
    """
    child = frame.find("localization")
    word = child.text.strip().upper() if child is not None else "CUSTOM"
    if word in _LOCALIZATIONS:
        datum = read_datum(part.world.spherical_coordinates)
        heading = datum.heading if datum is not None else 0.0
        return quat_multiply(
            quat_from_axis_angle((0.0, 0.0, 1.0), -heading), quat_from_rpy(*_LOCALIZATIONS[word])
        )
    idle = ""
    if word == "CUSTOM":
        custom = frame.find("custom_rpy")
        if custom is None or not custom.text.strip():
            return IDENTITY
        if not custom.attribute("parent_frame"):
            roll, pitch, yaw = vector(custom, 3)
            return quat_from_rpy(roll, pitch, yaw)
        idle = "a <custom_rpy> with a parent_frame"
    elif word in ("GRAV_UP", "GRAV_DOWN"):
        idle = f"<localization> {word}"
    else:
        wanted = "one of CUSTOM, ENU, NED, NWU, GRAV_UP, GRAV_DOWN"
        raise invalid("localization", word, wanted, frame.origin)
    part.report(
        devices.SENSOR_SETTING_IGNORED.diagnostic(
            f"{idle} has no effect: the orientation is relative to the world",
            origin=frame.origin,
            values={"setting": "orientation_reference_frame"},
        )
    )
    return IDENTITY
