"""Joint states: positions, velocities and efforts in one message."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.messages import Form, zero


@dataclass(frozen=True, kw_only=True, slots=True)
class JointStatesConfig:
    """Contents of the messages."""

    joints: tuple[str, ...]
    """Names of the joints, in the order of the message."""
    topic: str = "joint_states"
    rate: float = 0.0
    """Publish rate, Hz; 0: every step."""
    velocities: bool = False
    """Include velocities."""
    efforts: bool = False
    """Include efforts."""
    frame: str = ""
    """Frame of the messages."""


class JointStates(Component):
    """Publishes ``sensor_msgs/JointState`` messages, when `publish` is called or at its rate.

    Raises:
        UnknownNameError: A joint does not exist.
    """

    def __init__(self, scope: Scope, config: JointStatesConfig) -> None:
        super().__init__(scope)
        joints = [self.part.joint(name, origin=self.origin) for name in config.joints]
        self._joints = self.part.together(joints)
        self._names = list(config.joints)
        self._velocities, self._efforts = config.velocities, config.efforts
        self._frame = self.frame(config.frame) if config.frame else ""
        fields = ["header.stamp", "position"]
        fields += ["velocity"] * config.velocities + ["effort"] * config.efforts
        self._form = Form(self._template, *fields)
        self._rate = config.rate
        self.publisher = self.advertise(
            config.topic, "sensor_msgs/msg/JointState", rate=config.rate or None
        )

    def _template(self) -> Any:
        template, still = zero("sensor_msgs/msg/JointState"), np.zeros(len(self._names))
        template.header.frame_id, template.name, template.position = self._frame, self._names, still
        if self._velocities:
            template.velocity = still
        if self._efforts:
            template.effort = still
        return template

    def schedule(self) -> None:
        """Publishes at the rate from now on, while the topic has subscribers."""
        self.part.schedule(
            self._rate, after=lambda: self.publish(self.part.time_ns), topics=self.publishers
        )

    def publish(self, time_ns: int) -> None:
        """Publishes the current state."""
        joints = self._joints
        values: tuple[Any, ...] = (time_ns, joints.positions())
        if self._velocities:
            values += (joints.velocities(),)
        if self._efforts:
            values += (joints.efforts(),)
        self.publisher.publish_values(self._form, values)
