"""``libhector_gazebo_ros_magnetic.so`` and ``magnetometer`` sensors: the magnetic field."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cartwheel.devices.noise import DriftingError, VectorNoise
from cartwheel.dialects.geodesy import world_datum
from cartwheel.dialects.gz.sensor_tags import default_topic, frame_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.noise import read_noise
from cartwheel.dialects.tags import tag
from cartwheel.geometry import quat_conjugate, quat_multiply, rotate
from cartwheel.messages import header, message_class

_NONE = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class HectorMagneticParameters:
    body: str = tag(
        "bodyName",
        default="",
        doc="Link that carries the magnetometer. Default: the root link.",
    )
    topic: str = tag(
        "topicName",
        default="magnetic",
        doc="Topic of the Vector3Stamped or MagneticField messages.",
    )
    frame: str = tag("frameId", default="", doc="Frame ID of the messages. Default: the link.")
    update_rate: float = tag(
        "updateRate", default=0.0, unit="Hz", doc="Publish rate. 0: every step."
    )
    magnitude: float = tag(
        "magnitude", default=1.0, doc="Magnitude of the field. The messages use the same unit."
    )
    use_world: bool = tag(
        "useWorldSphericalCoordinates",
        default=False,
        doc="Use the heading in the world's `<spherical_coordinates>`.",
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
        doc="Publish MagneticField messages instead of Vector3Stamped.",
    )
    offset: tuple[float, float, float] = tag("offset", default=_NONE, doc="Constant error.")
    drift: tuple[float, float, float] = tag(
        "drift", default=_NONE, doc="Standard deviation of the drift."
    )
    frequency: tuple[float, float, float] = tag(
        "driftFrequency",
        default=(1 / 3600.0,) * 3,
        unit="1/s",
        doc="Inverse of the drift's time constant.",
    )
    noise: tuple[float, float, float] = tag(
        "gaussianNoise", default=_NONE, doc="Standard deviation of the noise."
    )
    scale: tuple[float, float, float] = tag(
        "scaleError", default=(1.0,) * 3, doc="Scale factor on the measured field."
    )


class HectorMagnetic(Plugin[HectorMagneticParameters]):
    """Publishes the Earth's magnetic field in the link frame.

    The field has an offset, a drift, noise and a scale factor, as in
    ``libhector_gazebo_ros_imu.so``. Original plugin: ``gazebo_ros_magnetic`` in the package
    ``hector_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libhector_gazebo_ros_magnetic.so",)
    parameters: ClassVar[type] = HectorMagneticParameters

    def configure(self) -> None:
        config, part, origin = self.config, self.part, self.tag.origin
        self.check_not_negative("update_rate", "drift", "frequency", "noise")
        name = config.body or part.description.canonical_link
        self._link = part.link(name, origin=origin)
        self._frame = self.frame(config.frame or name)
        heading = 0.0
        if config.use_world:
            datum = world_datum(part.world.spherical_coordinates)
            heading = 90.0 - math.degrees(datum.heading) if datum is not None else 90.0
        if config.heading is not None:
            heading = config.heading
        turn = math.radians(heading - config.declination)
        dip = math.radians(config.inclination)
        level = config.magnitude * math.cos(dip)
        self._field = (
            level * math.cos(turn),
            level * math.sin(turn),
            -config.magnitude * math.sin(dip),
        )
        self._error = DriftingError(
            part,
            f"magnetic {config.topic}",
            rate=config.update_rate,
            offset=config.offset,
            drift=config.drift,
            frequency=config.frequency,
            noise=config.noise,
            scale=config.scale,
        )
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        kind = "sensor_msgs/msg/MagneticField"
        if not config.as_field:
            kind = "geometry_msgs/msg/Vector3Stamped"
        self._Message = message_class(kind)
        self._covariance = np.diag(self._error.variance).ravel()
        rate = config.update_rate
        self._publisher = self.advertise(config.topic, kind, rate=rate or None, qos="sensor")
        part.schedule(rate, after=self._measure, active=lambda: self._publisher.wanted)

    def reset(self) -> None:
        self._error.restart()

    def _measure(self) -> None:
        _, turned = self._link.place()
        measured = self._error.add(rotate(quat_conjugate(turned), self._field)).tolist()
        head, vector = header(self.part.time_ns, self._frame), self._Vector3(*measured)
        if self.config.as_field:
            self._publisher.publish(self._Message(head, vector, self._covariance))
        else:
            self._publisher.publish(self._Message(head, vector))


@dataclass(frozen=True, kw_only=True, slots=True)
class GzMagnetometerParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the MagneticField messages. "
        "Default: `/world/<world>/model/<model>/link/<link>/sensor/<sensor>/magnetometer`.",
    )
    frame: str = frame_tag()


class GzMagnetometer(Plugin[GzMagnetometerParameters]):
    """Publishes the world's ``<magnetic_field>`` in the frame of a ``magnetometer`` sensor, in T.

    Original sensor: ``MagnetometerSensor`` in gz-sensors.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = GzMagnetometerParameters
    for_sensor: ClassVar[bool] = True
    serves: ClassVar[tuple[str, ...]] = ("magnetometer",)

    def configure(self) -> None:
        sensor, part = self.sensor, self.part
        assert sensor is not None
        self._link, self._mount = part.link(sensor.link), sensor.pose.orientation
        self._frame = self.frame(self.config.frame or sensor.link)
        noises = [
            read_noise(sensor.element.find(f"magnetometer/{axis}/noise"), part.report)
            for axis in "xyz"
        ]
        self._noise = VectorNoise(
            part, f"magnetometer {sensor.link} {sensor.name}", noises, rate=sensor.update_rate
        )
        self._covariance = np.diag(self._noise.variance).ravel()
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._MagneticField = message_class("sensor_msgs/msg/MagneticField")
        topic = self.config.topic or default_topic(part, sensor, "magnetometer")
        rate = sensor.update_rate
        self._publisher = self.advertise(
            topic, "sensor_msgs/msg/MagneticField", rate=rate or None, qos="sensor"
        )
        part.schedule(rate, after=self._measure, active=lambda: self._publisher.wanted)

    def _measure(self) -> None:
        turned = quat_multiply(self._link.place()[1], self._mount)
        field = rotate(quat_conjugate(turned), self.part.world.magnetic_field)
        self._publisher.publish(
            self._MagneticField(
                header(self.part.time_ns, self._frame),
                self._Vector3(*self._noise.add(field)),
                self._covariance,
            )
        )
