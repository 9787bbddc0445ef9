"""Sensors of force and torque."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cartwheel.component import Scope
from cartwheel.devices.contact.loads import (
    ContactForceConfig,
    JointLoadConfig,
    JointReactionConfig,
    LinkLoadConfig,
)
from cartwheel.devices.topic_sensor import TopicSensor
from cartwheel.graph import Qos
from cartwheel.messages import message_class

WRENCH_STAMPED = "geometry_msgs/msg/WrenchStamped"


@dataclass(frozen=True, kw_only=True, slots=True)
class WrenchSensorConfig:
    load: LinkLoadConfig | ContactForceConfig | JointReactionConfig | JointLoadConfig
    """The measured force and torque."""
    topic: str
    """Topic of the WrenchStamped messages."""
    frame: str
    """Frame ID of the messages, without the robot's prefix."""
    rate: float = 0.0
    """Publish rate, Hz; 0: every step."""
    noise: float = 0.0
    """Standard deviation of additional noise, N and N m."""
    qos: Qos = "sensor"
    """Quality of service on ROS 2."""


class WrenchSensor(TopicSensor):
    """Publishes a measured force and torque.

    Args:
        scope: The sensor's model and names.
        config: Measurement and topic.

    Raises:
        UnknownNameError: The link or joint does not exist.
    """

    def __init__(self, scope: Scope, config: WrenchSensorConfig) -> None:
        super().__init__(scope, config.frame, config.rate)
        self._load = config.load.load(self.part, self.origin)
        self._noise = config.noise
        self._publisher = self._offer(config.topic, WRENCH_STAMPED, config.qos)

    def _measure(self) -> None:
        values = self._load.measure()
        if self._noise > 0:
            random = self.part.random(f"force {self._publisher.topic}")
            values = (values + random.normal(0.0, self._noise, 6)).tolist()
        self._publisher.publish(wrench_stamped(self._header(), values))


def wrench_stamped(moment: Any, values: Sequence[float]) -> Any:
    """Returns a WrenchStamped message.

    Args:
        moment: The header.
        values: The force in N, then the torque in N m.
    """
    WrenchStamped, Wrench, Vector3 = _classes()
    return WrenchStamped(moment, Wrench(Vector3(*values[:3]), Vector3(*values[3:])))


@functools.cache
def _classes() -> tuple[Any, Any, Any]:
    return (
        message_class(WRENCH_STAMPED),
        message_class("geometry_msgs/msg/Wrench"),
        message_class("geometry_msgs/msg/Vector3"),
    )
