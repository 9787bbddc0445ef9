"""``logical_camera`` sensors: models in view and their poses."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.devices.cameras.logical_camera import LogicalCamera as LogicalCameraDevice
from cartwheel.devices.cameras.logical_camera import LogicalCameraConfig
from cartwheel.dialects.gz.sensor_tags import GzSensor, frame_tag, topic_tag
from cartwheel.dialects.tags import SMALLEST, tag
from cartwheel.errors import PluginError


@dataclass(frozen=True, kw_only=True, slots=True)
class LogicalCameraParameters:
    topic: str = topic_tag("LogicalCameraImage", "logical_camera")
    frame: str = frame_tag()
    near: float = tag(
        "logical_camera/near",
        default=0.0,
        unit="m",
        doc="Distance from the sensor to the near plane of its view.",
    )
    far: float = tag(
        "logical_camera/far",
        default=1.0,
        unit="m",
        doc="Distance from the sensor to the far plane of its view.",
    )
    view: float = tag(
        "logical_camera/horizontal_fov", default=1.0, unit="rad", doc="Horizontal field of view."
    )
    aspect: float = tag(
        "logical_camera/aspect_ratio",
        default=1.0,
        least=SMALLEST,
        doc="Width of the view divided by its height.",
    )


class LogicalCamera(GzSensor[LogicalCameraParameters]):
    """Publishes the names of the models in view, and their poses relative to the sensor.

    The sensor looks along its x axis. A model is in view if the origin of its model frame is in
    view, even if another model hides it. The message field ``pose`` is the pose of the sensor in
    the world. The sensor corresponds to ``LogicalCameraSensor`` in gz-sensors. The message type is
    the same as in ros_gz_bridge.
    """

    serves: ClassVar[tuple[str, ...]] = ("logical_camera",)

    def configure(self) -> None:
        sensor, config = self.sensor, self.config
        if not (0 <= config.near < config.far and 0 < config.view < math.pi):
            raise PluginError(
                "the clip distances and field of view must satisfy 0 <= <near> < <far> and "
                "0 < <horizontal_fov> < pi",
                code=devices.SENSOR_RANGE_INVALID,
                origin=sensor.origin,
                values={"near": config.near, "far": config.far, "view": config.view},
            )
        device = LogicalCameraConfig(
            link=sensor.link,
            pose=sensor.pose,
            near=config.near,
            far=config.far,
            horizontal_fov=config.view,
            aspect_ratio=config.aspect,
            topic=self.topic("logical_camera"),
            frame=self.frame_id,
            rate=sensor.update_rate,
        )
        self.add(LogicalCameraDevice(self.scope, device))
