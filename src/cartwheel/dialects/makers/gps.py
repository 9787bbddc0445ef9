"""Satellite navigation: hector's GPS, gps_sensor in ROS 2, and ``navsat`` in gz-sim."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.devices.noise import DriftingError, VectorNoise
from cartwheel.dialects.geodesy import ECCENTRICITY2, EQUATOR, Datum, world_datum
from cartwheel.dialects.gz.sensor_tags import default_topic, frame_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.noise import read_noise
from cartwheel.dialects.tags import tag
from cartwheel.geometry import Vec3
from cartwheel.messages import header, message_class

_NONE = (0.0, 0.0, 0.0)
_HOUR = (1 / 3600.0,) * 3
_KNOWN_DIAGONAL = 2
"""``NavSatFix.COVARIANCE_TYPE_DIAGONAL_KNOWN``."""


class _Receiver(Plugin[Any]):
    """Base class of the receivers, with their message types."""

    def _load(self) -> None:
        self._NavSatFix = message_class("sensor_msgs/msg/NavSatFix")
        self._NavSatStatus = message_class("sensor_msgs/msg/NavSatStatus")
        self._Vector3Stamped = message_class("geometry_msgs/msg/Vector3Stamped")
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")


@dataclass(frozen=True, kw_only=True, slots=True)
class HectorGpsParameters:
    body: str = tag("bodyName", default="", doc="Link of the receiver. Default: the root link.")
    topic: str = tag("topicName", default="fix", doc="Topic of the NavSatFix messages.")
    velocity_topic: str = tag(
        "velocityTopicName",
        default="fix_velocity",
        doc="Topic of the velocity (Vector3Stamped). Its components are north, west and up.",
    )
    frame: str = tag("frameId", default="/world", doc="Frame ID of the messages.")
    update_rate: float = tag(
        "updateRate", default=4.0, unit="Hz", doc="Publish rate. 0: every step."
    )
    use_world: bool = tag(
        "useWorldSphericalCoordinates",
        default=False,
        doc="Use the world's `<spherical_coordinates>` as the default reference.",
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
    offset: tuple[float, float, float] = tag(
        "offset", default=_NONE, unit="m", doc="Constant error of the position."
    )
    drift: tuple[float, float, float] = tag(
        "drift", default=_NONE, unit="m", doc="Standard deviation of the position's drift."
    )
    frequency: tuple[float, float, float] = tag(
        "driftFrequency",
        default=_HOUR,
        unit="1/s",
        doc="Inverse of the time constant of the position's drift.",
    )
    noise: tuple[float, float, float] = tag(
        "gaussianNoise", default=_NONE, unit="m", doc="Standard deviation of the position's noise."
    )
    scale: tuple[float, float, float] = tag(
        "scaleError", default=(1.0,) * 3, doc="Scale factor of the position."
    )
    velocity_offset: tuple[float, float, float] = tag(
        "velocityOffset", default=_NONE, unit="m/s", doc="Constant error of the velocity."
    )
    velocity_drift: tuple[float, float, float] = tag(
        "velocityDrift",
        default=_NONE,
        unit="m/s",
        doc="Standard deviation of the velocity's drift.",
    )
    velocity_frequency: tuple[float, float, float] = tag(
        "velocityDriftFrequency",
        default=_HOUR,
        unit="1/s",
        doc="Inverse of the time constant of the velocity's drift.",
    )
    velocity_noise: tuple[float, float, float] = tag(
        "velocityGaussianNoise",
        default=_NONE,
        unit="m/s",
        doc="Standard deviation of the velocity's noise.",
    )
    velocity_scale: tuple[float, float, float] = tag(
        "velocityScaleError", default=(1.0,) * 3, doc="Scale factor of the velocity."
    )


class HectorGps(_Receiver):
    """Publishes the latitude, longitude, altitude and velocity of a link.

    As in the original plugin, the Earth is treated as flat around the reference point. Within a few
    kilometres, the error is below 1 m. Position and velocity have an offset, a drift, noise and a
    scale factor, as in ``libhector_gazebo_ros_imu.so``. Original plugin: ``gazebo_ros_gps`` in the
    package ``hector_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libhector_gazebo_ros_gps.so",)
    parameters: ClassVar[type] = HectorGpsParameters

    def configure(self) -> None:
        config: HectorGpsParameters = self.config
        part, origin = self.part, self.tag.origin
        self.check_not_negative(
            "update_rate", "drift", "frequency", "noise",
            "velocity_drift", "velocity_frequency", "velocity_noise",
        )  # fmt: skip
        name = config.body or part.description.canonical_link
        self._link = part.link(name, origin=origin)
        self._frame = self.frame(config.frame)
        latitude, longitude, altitude, heading = 49.9, 8.9, 0.0, 0.0
        if config.use_world:
            datum = world_datum(part.world.spherical_coordinates) or Datum()
            latitude, longitude = math.degrees(datum.latitude), math.degrees(datum.longitude)
            altitude, heading = datum.height, 90.0 - math.degrees(datum.heading)
        self._latitude = latitude if config.latitude is None else config.latitude
        self._longitude = longitude if config.longitude is None else config.longitude
        self._altitude = altitude if config.altitude is None else config.altitude
        self._heading = math.radians(heading if config.heading is None else config.heading)
        sin = math.sin(math.radians(self._latitude))
        bend = 1 / (1 - ECCENTRICITY2 * sin * sin)
        across = EQUATOR * math.sqrt(bend)
        self._to_north = across * (1 - ECCENTRICITY2) * bend
        self._to_east = across * math.cos(math.radians(self._latitude))
        self._position = self._error(
            "position", config.offset, config.drift, config.frequency, config.noise, config.scale
        )
        self._velocity = self._error(
            "velocity",
            config.velocity_offset,
            config.velocity_drift,
            config.velocity_frequency,
            config.velocity_noise,
            config.velocity_scale,
        )
        self._load()
        self._covariance = np.diag(np.square(config.drift) + np.square(config.noise)).ravel()
        rate = config.update_rate
        self._fixes = self.advertise(
            config.topic, "sensor_msgs/msg/NavSatFix", rate=rate or None, qos="sensor"
        )
        self._velocities = self.advertise(
            config.velocity_topic, "geometry_msgs/msg/Vector3Stamped", rate=rate or None
        )
        part.schedule(
            rate,
            after=self._measure,
            active=lambda: self._fixes.wanted or self._velocities.wanted,
        )

    def _error(self, name: str, *numbers: tuple[float, float, float]) -> DriftingError:
        offset, drift, frequency, noise, scale = numbers
        return DriftingError(
            self.part,
            f"gps {self.config.topic} {name}",
            rate=self.config.update_rate,
            offset=offset,
            drift=drift,
            frequency=frequency,
            noise=noise,
            scale=scale,
        )

    def reset(self) -> None:
        self._position.restart()
        self._velocity.restart()

    def _measure(self) -> None:
        place, _ = self._link.place()
        linear, _ = self._link.motion(local=False)
        cos, sin = math.cos(self._heading), math.sin(self._heading)
        head = header(self.part.time_ns, self._frame)
        x, y, z = self._position.add(place).tolist()
        if self._fixes.wanted:
            self._fixes.publish(
                self._NavSatFix(
                    head,
                    self._NavSatStatus(self.config.status, self.config.service),
                    self._latitude + math.degrees((cos * x + sin * y) / self._to_north),
                    self._longitude - math.degrees((cos * y - sin * x) / self._to_east),
                    self._altitude + z,
                    self._covariance,
                    _KNOWN_DIAGONAL,
                )
            )
        if self._velocities.wanted:
            x, y, z = self._velocity.add(linear).tolist()
            vector = self._Vector3(cos * x + sin * y, cos * y - sin * x, z)
            self._velocities.publish(self._Vector3Stamped(head, vector))


@dataclass(frozen=True, kw_only=True, slots=True)
class GpsSensorParameters:
    frame: str = tag(
        "frame_name", default="", doc="Frame ID of the messages. Default: the sensor's link."
    )


class _GpsSensor(_Receiver):
    """Base class of GPS sensors that use the world's ``<spherical_coordinates>``."""

    def _start(self, *, topic: str, frame: str, element: str, velocity_topic: str | None) -> None:
        sensor, part = self.sensor, self.part
        assert sensor is not None
        self._link = part.link(sensor.link)
        self._mount = sensor.pose.position
        self._frame = self.frame(frame or sensor.link)
        datum = world_datum(part.world.spherical_coordinates)
        if datum is None:
            part.report(
                devices.COORDINATES_MISSING.diagnostic(
                    f'the world of sensor "{sensor.name}" has no <spherical_coordinates>, so '
                    "its origin is at latitude 0, longitude 0",
                    origin=sensor.origin,
                    values={"sensor": sensor.name},
                )
            )
        self._datum = datum or Datum()
        self._load()
        self._noise = self._noises(element, "position_sensing")
        self._velocity_noise = self._noises(element, "velocity_sensing")
        horizontal, vertical = self._noise.variance[0], self._noise.variance[2]
        self._covariance = np.diag([horizontal, horizontal, vertical]).ravel()
        rate = sensor.update_rate
        self._fixes = self.advertise(
            topic, "sensor_msgs/msg/NavSatFix", rate=rate or None, qos="sensor"
        )
        self._velocities = (
            self.advertise(velocity_topic, "geometry_msgs/msg/Vector3Stamped", rate=rate or None)
            if velocity_topic
            else None
        )
        part.schedule(rate, after=self._measure, active=self._wanted)

    def _noises(self, element: str, what: str) -> VectorNoise:
        """Returns the noise along east, north and up."""
        assert self.sensor is not None
        of = self.sensor.element.find(f"{element}/{what}")
        both = [
            read_noise(of.find(f"{axis}/noise") if of is not None else None, self.part.report)
            for axis in ("horizontal", "vertical")
        ]
        noises = (both[0], both[0], both[1])
        name = f"gps {self.sensor.link} {self.sensor.name} {what}"
        return VectorNoise(self.part, name, noises, rate=self.sensor.update_rate)

    def _wanted(self) -> bool:
        return self._fixes.wanted or (self._velocities is not None and self._velocities.wanted)

    def _measure(self) -> None:
        pose = self._link.pose
        linear, angular = self._link.motion(local=False)
        arm = np.array(pose.apply(self._mount)) - np.array(pose.position)
        x, y, z = (np.array(linear) + np.cross(angular, arm)).tolist()
        velocity: Vec3 = (x, y, z)
        # Noise is added in the world frame, then rotated by the heading.
        px, py, pz = self._noise.add(pose.apply(self._mount))
        latitude, longitude, height = self._datum.locate((px, py, pz))
        head = header(self.part.time_ns, self._frame)
        if self._fixes.wanted:
            self._fixes.publish(
                self._NavSatFix(
                    head,
                    self._NavSatStatus(0, 1),
                    math.degrees(latitude),
                    math.degrees(longitude),
                    height,
                    self._covariance,
                    _KNOWN_DIAGONAL,
                )
            )
        if self._velocities is not None and self._velocities.wanted:
            measured = self._velocity_noise.add(self._datum.east_north(velocity))
            self._velocities.publish(self._Vector3Stamped(head, self._Vector3(*measured)))


class GpsSensor(_GpsSensor):
    """Publishes the geographic position and the velocity of a ``gps`` sensor.

    NavSatFix messages are published on ``~/out``. The velocity toward east, north and up is
    published on ``~/vel``. The noise in the sensor's ``<gps>`` is applied, in m and m/s. The
    position is relative to the world's ``<spherical_coordinates>``. Original plugin:
    ``gazebo_ros_gps_sensor`` in the ROS 2 package ``gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_gps_sensor.so",)
    parameters: ClassVar[type] = GpsSensorParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "gps"

    def configure(self) -> None:
        config: GpsSensorParameters = self.config
        name = self.tag.name or "gps"
        self._start(
            topic="out" if self.remaps("out") else f"{name}/out",
            velocity_topic="vel" if self.remaps("vel") else f"{name}/vel",
            frame=config.frame,
            element="gps",
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class GzNavSatParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the NavSatFix messages. Default: "
        "`/world/<world>/model/<model>/link/<link>/sensor/<sensor>/navsat`.",
    )
    frame: str = frame_tag()


class GzNavSat(_GpsSensor):
    """Publishes the geographic position of a ``navsat`` sensor.

    The position is relative to the world's ``<spherical_coordinates>``. The noise in the sensor's
    ``<navsat>`` is applied, in m. Original sensor: ``NavSatSensor`` in gz-sensors.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = GzNavSatParameters
    for_sensor: ClassVar[bool] = True
    serves: ClassVar[tuple[str, ...]] = ("navsat", "gps")

    def configure(self) -> None:
        config: GzNavSatParameters = self.config
        assert self.sensor is not None
        topic = config.topic or default_topic(self.part, self.sensor, "navsat")
        of = "navsat" if self.sensor.element.find("navsat") else "gps"
        self._start(topic=topic, velocity_topic=None, frame=config.frame, element=of)
