"""The sensors of iRobot's Create 3, the base of the TurtleBot 4, as in Gazebo Classic."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.devices.inertial.imu import Imu, ImuConfig
from cartwheel.devices.rays.scan import Scanner
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.sdf.contact import read_collisions
from cartwheel.dialects.sdf.imu import read_inertial_unit
from cartwheel.dialects.sdf.scan import read_scanner
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError
from cartwheel.geometry import quat_conjugate, rotate
from cartwheel.messages import header, message_class

HAZARD = "irobot_create_msgs/msg/HazardDetection"
_ZONES = ("bump_right", "bump_front_right", "bump_front_center", "bump_front_left", "bump_left")
"""Zones of the bumper, each a fifth of its half circle, from right to left."""
_BRIGHTEST = 3500.0
"""Intensity that an infrared sensor measures at distance 0."""
_DROPPED, _LIFTED = 0.95, 0.75
"""Fractions of the threshold above which a wheel has dropped, and below which it is back."""


def out_topic(plugin: Plugin[Any]) -> str:
    """Returns ``~/out``, which tags can remap."""
    return "out" if plugin.remaps("out") else f"{plugin.tag.name}/out"


class _Hazard(Plugin[Any]):
    """Publishes a HazardDetection at each update while the hazard exists."""

    def _watch(self, rate: float) -> None:
        self._HazardDetection = message_class(HAZARD)
        self._publisher = self.advertise(out_topic(self), HAZARD, qos="sensor")
        self.part.schedule(rate, after=self._look, active=self._looks)

    def _looks(self) -> bool:
        return self._publisher.wanted

    def _look(self) -> None:
        raise NotImplementedError

    def _warn_of(self, kind: int, frame: str) -> None:
        self._publisher.publish(
            self._HazardDetection(header(self.part.time_ns, self.frame(frame)), kind)
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3BumperParameters:
    pass


class Create3Bumper(_Hazard):
    """Publishes the pressed zone of the bumper as a HazardDetection of type BUMP.

    The frame ID is the name of one of five zones, such as ``bump_front_left``. If several zones are
    pressed, the zone with the deepest contact is published. Original plugin: ``gazebo_ros_bumper``
    in the package ``irobot_create_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_bumper.so",)
    parameters: ClassVar[type] = Create3BumperParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "contact"

    def configure(self) -> None:
        assert self.sensor is not None
        self._collisions = read_collisions(self, self.sensor)
        self._base = self.part.link(self.part.description.canonical_link)
        self._watch(self.sensor.update_rate)

    def _look(self) -> None:
        contacts = self.part.contacts(self._collisions)
        if not contacts:
            return
        place, turned = self._base.place()
        deepest = max(contacts, key=lambda contact: contact.depth)
        arm = [a - b for a, b in zip(deepest.position.tolist(), place, strict=True)]
        x, y, _ = rotate(quat_conjugate(turned), arm)
        zone = math.floor((math.atan2(y, x) / math.pi + 0.5) * len(_ZONES))
        if 0 <= zone < len(_ZONES):
            self._warn_of(self._HazardDetection.BUMP, _ZONES[zone])


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3CliffParameters:
    threshold: float = tag(
        "detection_threshold",
        default=0.01,
        unit="m",
        doc="A cliff is reported if the floor is at least this far from the sensor.",
    )
    frame: str = tag("frame_id", default="", doc="Frame ID of the messages. Default: empty.")


class Create3Cliff(_Hazard):
    """Publishes a HazardDetection of type CLIFF while the floor is too far from a ray sensor.

    The smallest range of the sensor is compared with ``<detection_threshold>``. Original plugin:
    ``gazebo_ros_cliff_sensor`` in the package ``irobot_create_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_cliff_sensor.so",)
    parameters: ClassVar[type] = Create3CliffParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "ray"

    def configure(self) -> None:
        assert self.sensor is not None
        self._scanner = Scanner(self.part, read_scanner(self.sensor, self.part.report))
        self._watch(self.sensor.update_rate)

    def _look(self) -> None:
        if _nearest(self._scanner) >= self.config.threshold:
            self._warn_of(self._HazardDetection.CLIFF, self.config.frame)


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3IntensityParameters:
    frame: str = tag(
        "frame_name", default="", doc="Frame ID of the messages. Default: the sensor's link."
    )


class Create3Intensity(Plugin[Create3IntensityParameters]):
    """Publishes the intensity of reflected infrared light.

    The intensity is ``3500 exp(-2 e d / max)``, where e is Euler's number, d is the distance to the
    nearest obstacle and max is the maximum range of the ray sensor. Original plugin:
    ``gazebo_ros_ir_intensity_sensor`` in the package ``irobot_create_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_ir_intensity_sensor.so",)
    parameters: ClassVar[type] = Create3IntensityParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "ray"

    def configure(self) -> None:
        sensor = self.sensor
        assert sensor is not None
        kind = "irobot_create_msgs/msg/IrIntensity"
        self._scanner = Scanner(self.part, read_scanner(sensor, self.part.report))
        if math.isinf(self._scanner.pattern.maximum):
            raise PluginError(
                "the <max> of the <range> must be finite",
                code=devices.SENSOR_RANGE_INVALID,
                origin=sensor.origin,
            )
        self._frame = self.frame(self.config.frame or sensor.link)
        self._IrIntensity = message_class(kind)
        rate = sensor.update_rate
        self._publisher = self.advertise(out_topic(self), kind, rate=rate or None, qos="sensor")
        self.part.schedule(rate, after=self._publish, active=lambda: self._publisher.wanted)

    def _publish(self) -> None:
        distance = _nearest(self._scanner)
        value = _BRIGHTEST * math.exp(-2 * math.e * distance / self._scanner.pattern.maximum)
        moment = header(self.part.time_ns, self._frame)
        self._publisher.publish(self._IrIntensity(moment, int(value)))


def _nearest(scanner: Scanner) -> float:
    """Returns the nearest range, m, within the limits of the sensor."""
    least = float(scanner.measure().ranges.min())
    return float(np.clip(least, scanner.pattern.minimum, scanner.pattern.maximum))


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3ImuParameters:
    frame: str = tag(
        "frame_name", default="", doc="Frame ID of the messages. Default: the sensor's link."
    )


class Create3Imu(Plugin[Create3ImuParameters]):
    """Publishes the measurements of an IMU sensor. Accelerations exclude gravity.

    Original plugin: ``gazebo_ros_imu`` in the package ``irobot_create_gazebo_plugins``, which also
    excludes gravity.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_imu.so",)
    parameters: ClassVar[type] = Create3ImuParameters
    for_sensor: ClassVar[bool] = True
    sensor_type: ClassVar[str] = "imu"

    def configure(self) -> None:
        sensor = self.sensor
        assert sensor is not None
        device = ImuConfig(
            unit=read_inertial_unit(self.part, sensor),
            topic=out_topic(self),
            frame=self.config.frame or sensor.link,
            rate=sensor.update_rate,
            gravity=False,
        )
        self.add(Imu(self.scope, device))


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3MouseParameters:
    link: str = tag("link_name", doc="Link whose travel is measured.")
    rate: float = tag("update_rate", default=62.0, unit="Hz", doc="Publish rate.")


class Create3Mouse(Plugin[Create3MouseParameters]):
    """Publishes the accumulated travel of a link along its own x and y axes, in m.

    Original plugin: ``gazebo_ros_optical_mouse`` in the package ``irobot_create_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_optical_mouse.so",)
    parameters: ClassVar[type] = Create3MouseParameters

    def configure(self) -> None:
        config = self.config
        self.check_above_zero(update_rate=config.rate)
        kind = "irobot_create_msgs/msg/Mouse"
        self._link = self.part.link(config.link, origin=self.tag.origin)
        self._Mouse = message_class(kind)
        self._frame = self.frame(config.link)
        self._publisher = self.advertise(out_topic(self), kind, rate=config.rate, qos="sensor")
        self.part.schedule(config.rate, after=self._publish)
        self.reset()

    def reset(self) -> None:
        self._last_pose: Any = None
        self._travel = [0.0, 0.0]

    def _publish(self) -> None:
        place, turned = self._link.place()
        if self._last_pose is not None:
            before, axes = self._last_pose
            way = [a - b for a, b in zip(place, before, strict=True)]
            x, y, _ = rotate(quat_conjugate(axes), way)
            self._travel = [self._travel[0] + x, self._travel[1] + y]
        self._last_pose = (place, turned)
        if self._publisher.wanted:
            moment = header(self.part.time_ns, self._frame)
            # The surface quality is always good, and tracking is never lost.
            self._publisher.publish(self._Mouse(moment, *self._travel, frame_id=0, last_squal=90))


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3WheelDropParameters:
    joint: str = tag("joint_name", doc="Suspension joint of the wheel.")
    threshold: float = tag(
        "detection_threshold",
        default=0.7,
        unit="m",
        doc="Joint position of a fully dropped wheel. A wheel drop is reported when the "
        "position reaches 95 % of this value, until it is below 75 %.",
    )
    frame: str = tag("frame_id", default="", doc="Frame ID of the messages. Default: empty.")
    rate: float = tag("update_rate", default=62.0, unit="Hz", doc="Rate of checks and messages.")


class Create3WheelDrop(_Hazard):
    """Publishes a HazardDetection of type WHEEL_DROP while a wheel is dropped.

    A wheel is dropped when its suspension joint has extended, for example because the robot was
    lifted. Original plugin: ``gazebo_ros_wheel_drop`` in the package
    ``irobot_create_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_wheel_drop.so",)
    parameters: ClassVar[type] = Create3WheelDropParameters

    def configure(self) -> None:
        config: Create3WheelDropParameters = self.config
        self.check_above_zero(update_rate=config.rate, detection_threshold=config.threshold)
        self._joint = self.part.joint(config.joint, origin=self.tag.origin)
        self.reset()
        self._watch(config.rate)

    def reset(self) -> None:
        self._dropped = False

    def _looks(self) -> bool:
        # The hysteresis must not depend on whether there are subscribers.
        return True

    def _look(self) -> None:
        bound = _LIFTED if self._dropped else _DROPPED
        self._dropped = self._joint.position >= bound * self.config.threshold
        if self._dropped:
            self._warn_of(self._HazardDetection.WHEEL_DROP, self.config.frame)
