"""Magnetometers."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cartwheel.component import Scope
from cartwheel.devices.noise import ErrorConfig
from cartwheel.devices.position.link_sensor import LinkSensor
from cartwheel.geometry import IDENTITY, Quat, Vec3, quat_conjugate, quat_multiply, rotate
from cartwheel.messages import message_class


@dataclass(frozen=True, kw_only=True, slots=True)
class MagnetometerConfig:
    link: str
    """Link that carries the magnetometer."""
    mount: Quat = IDENTITY
    """Orientation of the magnetometer in the link."""
    field: Vec3 | None = None
    """The Earth's magnetic field in the world frame, in the unit of the messages. None: the
    world's field, T."""
    topic: str
    """Topic of the messages."""
    frame: str
    """Frame ID of the messages, without the robot's prefix."""
    rate: float
    """Publish rate, Hz; 0: every step."""
    error: ErrorConfig
    """Errors of the measured field."""
    as_vector: bool = False
    """Publish Vector3Stamped instead of MagneticField."""


class Magnetometer(LinkSensor):
    """Publishes the Earth's magnetic field in the frame of a magnetometer on a link.

    Args:
        scope: The magnetometer's model and names.
        config: Link, field, topic and errors.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: MagnetometerConfig) -> None:
        super().__init__(scope, config)
        self._config = config
        self._covariance = np.diag(self._error.variance).ravel()
        kind = "sensor_msgs/msg/MagneticField"
        if config.as_vector:
            kind = "geometry_msgs/msg/Vector3Stamped"
        self._Message = message_class(kind)
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._publisher = self._offer(config.topic, kind)

    def _measure(self) -> None:
        config = self._config
        _, orientation = self._link.place()
        mounted = quat_multiply(orientation, config.mount)
        field = self.part.world.magnetic_field if config.field is None else config.field
        measured = self._Vector3(*self._error.add(rotate(quat_conjugate(mounted), field)))
        if config.as_vector:
            self._publisher.publish(self._Message(self._header(), measured))
        else:
            self._publisher.publish(self._Message(self._header(), measured, self._covariance))


def dipole_field(magnitude: float, azimuth: float, inclination: float) -> Vec3:
    """Returns a magnetic field in the world frame.

    Args:
        magnitude: Magnitude of the field, in any unit.
        azimuth: Horizontal direction of the field, from the x axis toward the y axis, rad.
        inclination: Angle below the horizontal, rad.
    """
    level = magnitude * math.cos(inclination)
    return (
        level * math.cos(azimuth),
        level * math.sin(azimuth),
        -magnitude * math.sin(inclination),
    )
