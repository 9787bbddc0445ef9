"""Barometers: air pressure, and the height that is computed from it."""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.component import Scope
from cartwheel.devices.elementwise import Number, maximum, power
from cartwheel.devices.noise import ErrorConfig
from cartwheel.devices.position.link_sensor import LinkSensor
from cartwheel.geometry import Vec3
from cartwheel.messages import message_class

SEA_LEVEL = 101325.0
"""Pressure at sea level, Pa."""
TEMPERATURE = 288.15
"""Temperature at sea level, K."""
LAPSE = 0.0065
"""Decrease of the temperature with height, K/m."""
EXPONENT = 9.80665 * 0.0289644 / (8.31446 * LAPSE)
_SCALE_HEIGHT = 44330.0
"""Altitude at which `pressure_by_qnh` is 0, m."""
_QNH_EXPONENT = 5.263157


def pressure_at(height: Number) -> Number:
    """Returns the air pressure in Pa at a height in m above sea level.

    The formula is that of the International Standard Atmosphere, which is valid up to 11 km. Above
    44 km the result is 0.
    """
    return SEA_LEVEL * power(maximum(1 - LAPSE * height / TEMPERATURE, 0.0), EXPONENT)


def height_at(pressure: float) -> float:
    """Returns the height in m above sea level of a positive air pressure in Pa.

    It is the inverse of `pressure_at`.
    """
    height: float = TEMPERATURE / LAPSE * (1 - power(pressure / SEA_LEVEL, 1 / EXPONENT))
    return height


def pressure_by_qnh(altitude: Number, qnh: Number) -> Number:
    """Returns the air pressure at an altitude in m, in the unit of the pressure at sea level."""
    return qnh * power(maximum(1.0 - altitude / _SCALE_HEIGHT, 0.0), _QNH_EXPONENT)


@dataclass(frozen=True, kw_only=True, slots=True)
class PressureSensorConfig:
    link: str
    """Link that carries the sensor."""
    mount: Vec3
    """Position of the sensor in the link, m."""
    elevation: float
    """Height of the world's origin above sea level, m."""
    topic: str
    """Topic of the FluidPressure messages."""
    frame: str
    """Frame ID of the messages, without the robot's prefix."""
    rate: float
    """Publish rate, Hz; 0: every step."""
    error: ErrorConfig
    """Error of the pressure, Pa."""
    drift: float = 0.0
    """Change of the measured pressure with time, Pa/s."""


class PressureSensor(LinkSensor):
    """Publishes the air pressure of the International Standard Atmosphere at a sensor.

    Args:
        scope: The sensor's model and names.
        config: Link, topic and errors.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: PressureSensorConfig) -> None:
        super().__init__(scope, config)
        self._config = config
        self._variance = float(self._error.variance[0])
        self._FluidPressure = message_class("sensor_msgs/msg/FluidPressure")
        self._publisher = self._offer(config.topic, "sensor_msgs/msg/FluidPressure")

    def _measure(self) -> None:
        _, _, height = self._link.pose.apply(self._config.mount)
        drift = self._config.drift * self.part.seconds
        (pressure,) = self._error.add([pressure_at(self._config.elevation + height) + drift])
        self._publisher.publish(self._FluidPressure(self._header(), pressure, self._variance))


@dataclass(frozen=True, kw_only=True, slots=True)
class BarometricAltimeterConfig:
    link: str
    """Link that carries the altimeter."""
    elevation: float
    """Altitude of the world's origin above sea level, m."""
    qnh: float
    """Pressure at sea level, hPa."""
    height_topic: str | None
    """Topic of the height in the world (PointStamped). None: not published."""
    altitude_topic: str | None
    """Topic of the altitude and pressure (Altimeter). None: not published."""
    frame: str
    """Frame ID of the messages, without the robot's prefix."""
    rate: float
    """Publish rate, Hz; 0: every step."""
    error: ErrorConfig
    """Error of the height, m."""


class BarometricAltimeter(LinkSensor):
    """Publishes the height of a link, and the altitude and pressure that belong to it.

    Args:
        scope: The altimeter's model and names.
        config: Link, topics and errors.

    Raises:
        UnknownNameError: The link does not exist.
    """

    def __init__(self, scope: Scope, config: BarometricAltimeterConfig) -> None:
        super().__init__(scope, config)
        self._config = config
        self._PointStamped = message_class("geometry_msgs/msg/PointStamped")
        self._Point = message_class("geometry_msgs/msg/Point")
        self._Altimeter = message_class("hector_uav_msgs/msg/Altimeter")
        self._heights, self._altitudes = (
            self._offer(topic, kind) if topic is not None else None
            for topic, kind in (
                (config.height_topic, "geometry_msgs/msg/PointStamped"),
                (config.altitude_topic, "hector_uav_msgs/msg/Altimeter"),
            )
        )

    def _measure(self) -> None:
        config = self._config
        (_, _, z), _ = self._link.place()
        (height,) = self._error.add([z])
        if self._heights is not None and self._heights.wanted:
            self._heights.publish(self._PointStamped(self._header(), self._Point(0.0, 0.0, height)))
        if self._altitudes is not None and self._altitudes.wanted:
            altitude = height + config.elevation
            pressure = pressure_by_qnh(altitude, config.qnh)
            self._altitudes.publish(self._Altimeter(self._header(), altitude, pressure, config.qnh))
