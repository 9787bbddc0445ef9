"""Receivers of satellite navigation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from cartwheel.component import Scope
from cartwheel.devices.noise import ErrorConfig, sensor_error
from cartwheel.devices.position.link_sensor import LinkSensor
from cartwheel.geometry import Array, Vec3, cross
from cartwheel.graph import Publisher
from cartwheel.messages import message_class

_KNOWN_DIAGONAL = 2
"""``NavSatFix.COVARIANCE_TYPE_DIAGONAL_KNOWN``."""


class Projection(Protocol):
    """Relates the world to the Earth."""

    def locate_degrees(self, place: Vec3) -> Vec3:
        """Returns latitude and longitude in degrees and height in m of a position in the world."""

    def geographic(self, vector: Vec3) -> Vec3:
        """Converts a velocity from the world frame to geographic axes."""


@dataclass(frozen=True, kw_only=True, slots=True)
class GpsConfig:
    link: str
    """Link that carries the receiver."""
    mount: Vec3 = (0.0, 0.0, 0.0)
    """Position of the antenna in the link, m."""
    projection: Projection
    """Relates the world to the Earth. It also selects the axes of the velocity."""
    topic: str
    """Topic of the NavSatFix messages."""
    velocity_topic: str | None
    """Topic of the velocity (Vector3Stamped). None: not published."""
    frame: str
    """Frame ID of the messages, without the robot's prefix."""
    rate: float
    """Publish rate, Hz; 0: every step."""
    error: ErrorConfig
    """Errors of the position in the world frame, m."""
    velocity_error: ErrorConfig
    """Errors of the velocity, m/s."""
    velocity_error_axes: Literal["world", "geographic"]
    """Axes in which errors are added to the velocity."""
    covariance: Array | None = None
    """Covariance of the position, m², shape (9,). None: that of the noise."""
    status: int = 0
    """Field ``status`` of NavSatStatus."""
    service: int = 1
    """Field ``service`` of NavSatStatus."""


class Gps(LinkSensor):
    """Publishes the geographic position and the velocity of a receiver on a link.

    Args:
        scope: The receiver's model and names.
        config: Link, topics and errors.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: GpsConfig) -> None:
        super().__init__(scope, config)
        self._config = config
        self._velocity_error = sensor_error(self.part, config.velocity_error)
        self._covariance = config.covariance
        if self._covariance is None:
            self._covariance = np.diag(self._error.variance).ravel()
        self._NavSatFix = message_class("sensor_msgs/msg/NavSatFix")
        self._status = message_class("sensor_msgs/msg/NavSatStatus")(config.status, config.service)
        self._Vector3Stamped = message_class("geometry_msgs/msg/Vector3Stamped")
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._fixes = self._offer(config.topic, "sensor_msgs/msg/NavSatFix")
        self._velocities: Publisher | None = None
        if config.velocity_topic is not None:
            self._velocities = self._offer(
                config.velocity_topic, "geometry_msgs/msg/Vector3Stamped", qos="default"
            )

    def reset(self) -> None:
        """Starts new drifts."""
        super().reset()
        self._velocity_error.restart()

    def _measure(self) -> None:
        moment = self._header()
        if self._fixes.wanted:
            x, y, z = self._error.add(self._link.pose.apply(self._config.mount))
            located = self._config.projection.locate_degrees((x, y, z))
            self._fixes.publish(
                self._NavSatFix(moment, self._status, *located, self._covariance, _KNOWN_DIAGONAL)
            )
        if self._velocities is not None and self._velocities.wanted:
            velocity = self._Vector3(*self._velocity())
            self._velocities.publish(self._Vector3Stamped(moment, velocity))

    def _velocity(self) -> Vec3:
        """Returns the measured velocity in geographic axes, m/s."""
        pose, projection = self._link.pose, self._config.projection
        linear, angular = self._link.motion(local=False)
        arm = np.array(pose.apply(self._config.mount)) - np.array(pose.position)
        x, y, z = (np.array(linear) + cross(angular, arm)).tolist()
        if self._config.velocity_error_axes == "world":
            x, y, z = self._velocity_error.add((x, y, z))
            return projection.geographic((x, y, z))
        x, y, z = self._velocity_error.add(projection.geographic((x, y, z)))
        return x, y, z
