"""Logical cameras, which detect models by their poses."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from cartwheel.component import Scope
from cartwheel.devices.topic_sensor import TopicSensor
from cartwheel.geometry import Pose, Vec3
from cartwheel.messages import message_class

_IMAGE = "ros_gz_interfaces/msg/LogicalCameraImage"


@dataclass(frozen=True, kw_only=True, slots=True)
class LogicalCameraConfig:
    """Mounting, field of view and topic of a `LogicalCamera`."""

    link: str
    pose: Pose
    """Pose in the link. The camera looks along its x axis."""
    near: float
    """Distance to the near plane, m."""
    far: float
    """Distance to the far plane, m."""
    horizontal_fov: float
    """rad."""
    aspect_ratio: float
    """Width of the view divided by its height."""
    topic: str
    """Topic of the LogicalCameraImage messages."""
    frame: str
    """Frame ID of the messages, without the robot's prefix."""
    rate: float
    """Publish rate, Hz; 0: every step."""


def in_view(
    position: Vec3, *, near: float, far: float, half_width: float, half_height: float
) -> bool:
    """Whether a point in the camera's frame is in view.

    Args:
        position: x forward, y left, z up, m.
        near: Distance to the near plane, m.
        far: Distance to the far plane, m.
        half_width: Half of the view's width at a distance of 1 m, m.
        half_height: Half of the view's height at a distance of 1 m, m.
    """
    x, y, z = position
    return near <= x <= far and abs(y) <= half_width * x and abs(z) <= half_height * x


class LogicalCamera(TopicSensor):
    """Publishes the models whose origin is in view, each with its pose relative to the camera.

    Models do not occlude each other.

    Args:
        scope: The camera's model and names.
        config: Mounting, field of view and topic.
    """

    def __init__(self, scope: Scope, config: LogicalCameraConfig) -> None:
        super().__init__(scope, config.frame, config.rate)
        self._config = config
        self._half_width = math.tan(config.horizontal_fov / 2)
        self._half_height = self._half_width / config.aspect_ratio
        self._link = self.part.link(config.link)
        self._Image, self._Model = message_class(_IMAGE), message_class(f"{_IMAGE}Model")
        self._Pose = message_class("geometry_msgs/msg/Pose")
        self._Point = message_class("geometry_msgs/msg/Point")
        self._Quaternion = message_class("geometry_msgs/msg/Quaternion")
        self._publisher = self._offer(config.topic, _IMAGE)

    def _measure(self) -> None:
        camera = self._link.pose @ self._config.pose
        to_camera = camera.inverse()
        relative = ((name, to_camera @ pose) for name, pose in self.part.models().items())
        models = [
            self._Model(name, self._pose_message(pose))
            for name, pose in relative
            if self._sees(pose.position)
        ]
        self._publisher.publish(self._Image(self._header(), self._pose_message(camera), models))

    def _sees(self, position: Vec3) -> bool:
        config = self._config
        return in_view(
            position,
            near=config.near,
            far=config.far,
            half_width=self._half_width,
            half_height=self._half_height,
        )

    def _pose_message(self, pose: Pose) -> Any:
        return self._Pose(self._Point(*pose.position), self._Quaternion(*pose.orientation))
