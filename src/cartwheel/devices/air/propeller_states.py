"""Speeds and angles of propellers, and the relay of their commands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.air.propeller import ACTUATORS
from cartwheel.messages import header, message_class

_FLOAT = "std_msgs/msg/Float32"
_JOINT_STATE = "sensor_msgs/msg/JointState"


@dataclass(frozen=True, kw_only=True, slots=True)
class PropellerJointStateConfig:
    joint: str
    """Joint of the propeller."""
    velocity_topic: str | None = None
    """Topic of the joint's velocity in rad/s. None: not published."""
    position_topic: str | None = None
    """Topic of the joint's angle in rad. None: not published."""


class PropellerJointState(Component):
    """Publishes the velocity and the angle of a propeller's joint at every step, as Float32.

    Raises:
        UnknownNameError: The joint does not exist.
    """

    def __init__(self, scope: Scope, config: PropellerJointStateConfig) -> None:
        super().__init__(scope)
        self._joint = self.part.joint(config.joint, origin=self.origin)
        self._Float32 = message_class(_FLOAT)
        self._outputs = [
            (self.advertise(topic, _FLOAT), quantity)
            for topic, quantity in (
                (config.velocity_topic, "velocity"),
                (config.position_topic, "position"),
            )
            if topic is not None
        ]
        self.part.schedule(0, after=self._publish, topics=self.publishers)

    def _publish(self) -> None:
        for publisher, quantity in self._outputs:
            if publisher.wanted:
                publisher.publish(self._Float32(getattr(self._joint, quantity)))


@dataclass(frozen=True, kw_only=True, slots=True)
class PropellerStatesConfig:
    joints: Sequence[str]
    """Joints of the propellers, in the order of the speeds."""
    speed_topic: str
    """Topic of the speeds of the propellers, as Actuators."""
    joint_topic: str
    """Topic of the angles of the joints, as JointState."""
    frame: str
    """Frame ID of the messages."""
    slowdown: float
    """Speed of the propellers divided by the speed of their joints."""


class PropellerStates(Component):
    """Publishes the speeds and angles of all propellers at every step.

    Raises:
        UnknownNameError: A joint does not exist.
    """

    def __init__(self, scope: Scope, config: PropellerStatesConfig) -> None:
        super().__init__(scope)
        part = self.part
        self._joints = [part.joint(name, origin=self.origin) for name in config.joints]
        self._slowdown = config.slowdown
        self._frame = self.frame(config.frame)
        self._Actuators = message_class(ACTUATORS)
        self._JointState = message_class(_JOINT_STATE)
        self._speeds = self.advertise(config.speed_topic, ACTUATORS)
        self._states = self.advertise(config.joint_topic, _JOINT_STATE)
        part.schedule(0, after=self._publish, topics=self.publishers)

    def _publish(self) -> None:
        head, empty = header(self.part.time_ns, self._frame), np.zeros(0)
        if self._speeds.wanted:
            speeds = np.array([joint.velocity * self._slowdown for joint in self._joints])
            self._speeds.publish(self._Actuators(head, empty, speeds, empty))
        if self._states.wanted:
            names = [joint.name for joint in self._joints]
            angles = np.array([joint.position for joint in self._joints])
            self._states.publish(self._JointState(head, names, angles, empty, empty))


@dataclass(frozen=True, kw_only=True, slots=True)
class SpeedRelayConfig:
    command_topic: str
    """Topic of the Actuators commands."""
    output_topic: str
    """Topic on which the speeds are published."""


class SpeedRelay(Component):
    """Publishes the speeds in Actuators commands on another topic, with the simulation time."""

    def __init__(self, scope: Scope, config: SpeedRelayConfig) -> None:
        super().__init__(scope)
        self._Actuators = message_class(ACTUATORS)
        self._output = self.advertise(config.output_topic, ACTUATORS)
        self.subscribe(config.command_topic, ACTUATORS, self._on_command)

    def _on_command(self, message: Any) -> None:
        empty = np.zeros(0)
        head = header(self.part.time_ns, "")
        self._output.publish(self._Actuators(head, empty, message.angular_velocities, empty))
