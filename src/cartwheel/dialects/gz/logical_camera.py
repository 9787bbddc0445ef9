"""``logical_camera`` sensors: models in view and their poses."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import devices
from cartwheel.dialects.gz.sensor_tags import default_topic, frame_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError
from cartwheel.geometry import Pose
from cartwheel.messages import header, message_class

_KIND = "ros_gz_interfaces/msg/LogicalCameraImage"
_HALF_TURN = math.pi


@dataclass(frozen=True, kw_only=True, slots=True)
class LogicalCameraParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the LogicalCameraImage messages. "
        "Default: `/world/<world>/model/<model>/link/<link>/sensor/<sensor>/logical_camera`.",
    )
    frame: str = frame_tag()
    near: float = tag(
        "logical_camera/near", default=0.0, unit="m", doc="Distance to the near plane."
    )
    far: float = tag("logical_camera/far", default=1.0, unit="m", doc="Distance to the far plane.")
    view: float = tag(
        "logical_camera/horizontal_fov", default=1.0, unit="rad", doc="Horizontal field of view."
    )
    aspect: float = tag(
        "logical_camera/aspect_ratio", default=1.0, doc="Width of the view divided by its height."
    )


class LogicalCamera(Plugin[LogicalCameraParameters]):
    """Publishes the models in view, each with its pose relative to the sensor.

    The sensor looks along its x axis. A model is in view if the origin of its frame is in view.
    Models do not occlude each other. The message field ``pose`` is the pose of the sensor in the
    world. Original sensor: ``LogicalCameraSensor`` in gz-sensors. The message type is the same as
    in ros_gz_bridge.
    """

    filenames: ClassVar[tuple[str, ...]] = ()
    parameters: ClassVar[type] = LogicalCameraParameters
    for_sensor: ClassVar[bool] = True
    serves: ClassVar[tuple[str, ...]] = ("logical_camera",)

    def configure(self) -> None:
        sensor, part, config = self.sensor, self.part, self.config
        assert sensor is not None
        if not (0 <= config.near < config.far and 0 < config.view < _HALF_TURN):
            raise PluginError(
                "the view must satisfy 0 <= <near> < <far> and 0 < <horizontal_fov> < pi",
                code=devices.SENSOR_RANGE_INVALID,
                origin=sensor.origin,
                values={"near": config.near, "far": config.far, "view": config.view},
            )
        self.check_above_zero(aspect_ratio=config.aspect)
        self._wide = math.tan(config.view / 2)
        self._high = self._wide / config.aspect
        self._link, self._mount = part.link(sensor.link), sensor.pose
        self._frame = self.frame(config.frame or sensor.link)
        self._Image, self._Model = message_class(_KIND), message_class(f"{_KIND}Model")
        self._Pose = message_class("geometry_msgs/msg/Pose")
        self._Point = message_class("geometry_msgs/msg/Point")
        self._Quaternion = message_class("geometry_msgs/msg/Quaternion")
        topic = config.topic or default_topic(part, sensor, "logical_camera")
        rate = sensor.update_rate
        self._publisher = self.advertise(topic, _KIND, rate=rate or None, qos="sensor")
        part.schedule(rate, after=self._look, active=lambda: self._publisher.wanted)

    def _look(self) -> None:
        eye = self._link.pose @ self._mount
        back = eye.inverse()
        seen = ((name, back @ pose) for name, pose in self.part.models().items())
        models = [
            self._Model(name, self._pose_message(pose)) for name, pose in seen if self._sees(pose)
        ]
        head = header(self.part.time_ns, self._frame)
        self._publisher.publish(self._Image(head, self._pose_message(eye), models))

    def _sees(self, pose: Pose) -> bool:
        x, y, z = pose.position
        inside = self.config.near <= x <= self.config.far
        return inside and abs(y) <= self._wide * x and abs(z) <= self._high * x

    def _pose_message(self, pose: Pose) -> Any:
        return self._Pose(self._Point(*pose.position), self._Quaternion(*pose.orientation))
