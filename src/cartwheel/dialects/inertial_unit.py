"""Measurements of an inertial measurement unit on a link, without a topic (REP 145)."""

from __future__ import annotations

import math
from collections.abc import Sequence

from cartwheel.codes import devices
from cartwheel.description.model import Element, Sensor
from cartwheel.devices.noise import VectorNoise
from cartwheel.dialects.geodesy import world_datum
from cartwheel.dialects.sdf.noise import read_noise
from cartwheel.dialects.tags import invalid, vector
from cartwheel.errors import Origin
from cartwheel.geometry import (
    IDENTITY,
    Pose,
    Quat,
    matrix_from_quat,
    quat_conjugate,
    quat_from_axis_angle,
    quat_from_rpy,
    quat_multiply,
)
from cartwheel.simulation import Part

_NORTH = {
    "ENU": (0.0, 0.0, 0.0),
    "NWU": (0.0, 0.0, math.pi / 2),
    "NED": (math.pi, 0.0, math.pi / 2),
}
"""Roll, pitch and yaw for SDF's localizations, relative to east, north, up."""


class InertialUnit:
    """Measures angular velocity, proper acceleration and orientation of an IMU on a link.

    Angular velocity and acceleration are in the IMU frame.

    Args:
        part: The model's part of the simulation.
        link: Name of the link that carries the IMU.
        mount: Pose of the IMU in the link.
        sensor: Sensor whose ``<imu>`` specifies noise and reference frame; None: neither.
        from_first: Measure the orientation relative to the initial one, unless the sensor has an
            ``<orientation_reference_frame>``.
        origin: File and line for the error about an unknown link.

    Raises:
        UnknownNameError: The link does not exist.
        PluginError: The sensor's ``<imu>`` is invalid.
    """

    def __init__(
        self,
        part: Part,
        link: str,
        mount: Pose,
        *,
        sensor: Sensor | None = None,
        from_first: bool = False,
        origin: Origin | None = None,
    ) -> None:
        self._link = part.link(link, origin=origin)
        self._mount = mount
        self._turn = matrix_from_quat(mount.orientation).T.tolist()
        self._aligned = mount.orientation == IDENTITY
        self.rate_noise: VectorNoise | None = None
        self.acceleration_noise: VectorNoise | None = None
        self.has_orientation = True
        """Whether orientation is measured; otherwise `measure` returns the identity."""
        self._reference = IDENTITY
        if from_first:
            described = part.description.link(link)
            assert described is not None
            first = part.start @ described.pose @ mount
            self._reference = quat_conjugate(first.orientation)
        element = sensor.element.find("imu") if sensor is not None else None
        if sensor is None or element is None:
            return
        enable = element.find("enable_orientation")
        self.has_orientation = enable is None or enable.text.strip().lower() not in ("false", "0")
        if element.find("orientation_reference_frame") is not None:
            self._reference = quat_conjugate(_reference(part, element))
        both = []
        for what, older in (("angular_velocity", "rate"), ("linear_acceleration", "accel")):
            noises = [
                read_noise(element.find(f"{what}/{axis}/noise"), part.report) for axis in "xyz"
            ]
            if element.find(f"noise/{older}") is not None and element.find(what) is None:
                # SDF 1.4: one noise for all axes.
                noises = [read_noise(element.find(f"noise/{older}"), part.report)] * 3
            name = f"imu {sensor.link} {sensor.name} {what}"
            both.append(VectorNoise(part, name, noises, rate=sensor.update_rate))
        self.rate_noise, self.acceleration_noise = both

    def measure(self) -> tuple[Quat, Sequence[float], Sequence[float]]:
        """Returns orientation, angular velocity (rad/s) and proper acceleration (m/s²), with noise.

        The orientation is relative to the world, or to ``<orientation_reference_frame>``. It has no
        noise.
        """
        _, turned = self._link.place()
        orientation = IDENTITY
        if self.has_orientation:
            mounted = quat_multiply(turned, self._mount.orientation)
            orientation = quat_multiply(self._reference, mounted)
        # Only the acceleration depends on the position on the link, which is rigid.
        rates = self.rates()
        acceleration = self._turned(self._link.proper_acceleration(self._mount.position).tolist())
        if self.acceleration_noise is not None:
            acceleration = self.acceleration_noise.add(acceleration)
        return orientation, rates, acceleration

    @property
    def gravity(self) -> Sequence[float]:
        """Gravity in the world frame, m/s²."""
        return self._link.gravity

    def rates(self) -> Sequence[float]:
        """Angular velocity in the IMU frame with the sensor's noise, rad/s."""
        _, turning = self._link.motion(local=True)
        rates = self._turned(turning)
        return rates if self.rate_noise is None else self.rate_noise.add(rates)

    def _turned(self, vector: Sequence[float]) -> Sequence[float]:
        """Transforms a vector from the link frame to the IMU frame."""
        if self._aligned:
            return vector
        x, y, z = vector
        return [a * x + b * y + c * z for a, b, c in self._turn]


def _reference(part: Part, imu: Element) -> Quat:
    """Orientation of an ``<orientation_reference_frame>`` in the world.

    Raises:
        PluginError: Unknown ``<localization>``, or invalid numbers.
    """
    frame = imu.find("orientation_reference_frame")
    assert frame is not None
    child = frame.find("localization")
    word = child.text.strip().upper() if child is not None else "CUSTOM"
    if word in _NORTH:
        datum = world_datum(part.world.spherical_coordinates)
        heading = datum.heading if datum is not None else 0.0
        return quat_multiply(
            quat_from_axis_angle((0.0, 0.0, 1.0), -heading), quat_from_rpy(*_NORTH[word])
        )
    idle = ""
    if word == "CUSTOM":
        custom = frame.find("custom_rpy")
        if custom is None or not custom.text.strip():
            return IDENTITY
        if not custom.attribute("parent_frame"):
            return quat_from_rpy(*_three(custom))
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


def _three(element: Element) -> tuple[float, float, float]:
    roll, pitch, yaw = vector(element, 3)
    return roll, pitch, yaw
