"""Joints that an autopilot's output channels drive."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from cartwheel.component import Component, Scope
from cartwheel.devices.joints.pid import DampedEffort, Pid, PidGains
from cartwheel.messages import message_class

_FLOAT = "std_msgs/msg/Float64"


@dataclass(frozen=True, kw_only=True, slots=True)
class ChannelConfig:
    number: int
    """Index of the output in the autopilot's packets."""
    joint: str
    """Joint to drive. It may be empty for a message."""
    kind: Literal["velocity", "position", "exact position", "effort", "message"]
    """Quantity of the command: velocity in rad/s or m/s, position in rad or m, or effort in N m or
    N. An exact position is reached regardless of the load. A message is published on a topic
    instead."""
    topic: str = ""
    """Topic of the message (Float64)."""
    gains: PidGains | None = None
    """Gains of the controller of a velocity or a position. None: a velocity is reached
    regardless of the load, and a position is not controlled."""
    low: float = 1000.0
    """Pulse width of the output 0, µs."""
    high: float = 2000.0
    """Pulse width of the output 1, µs."""
    multiplier: float = 1.0
    """Command per output."""
    offset: float = 0.0
    """Is added to the output before the multiplication."""
    constant: float = 0.0
    """Is added to the command."""
    most_error: float = math.inf
    """Largest error of a position on which the controller acts, rad or m."""
    slowdown: float = 1.0
    """Commanded velocity divided by the velocity of the joint."""


class Channel(Component):
    """Drives a joint, or publishes the command.

    Raises:
        UnknownNameError: The joint does not exist.
    """

    def __init__(self, scope: Scope, config: ChannelConfig) -> None:
        super().__init__(scope)
        self.config = config
        part, origin = self.part, self.origin
        self._joint = None
        if config.joint or config.kind != "message":
            self._joint = part.joint(config.joint, origin=origin)
        self._servo = self._publisher = None
        if config.kind == "message":
            self._publisher = self.advertise(config.topic, _FLOAT)
            self._Float64 = message_class(_FLOAT)
        elif config.kind != "position" or config.gains is not None:
            by_effort = config.kind == "effort" or config.gains is not None
            self._servo = part.servo(
                config.joint,
                max_effort=None,
                efforts="set" if by_effort else None,
                origin=origin,
            )
        self._pid = Pid(config.gains) if config.gains is not None else None
        if self._pid is not None:
            part.tune(config.joint, self._pid)
        self._command: float | None = None

    def reset(self) -> None:
        super().reset()
        self._command = None
        if self._pid is not None:
            self._pid.reset()
        if self._servo is not None:
            self._servo.release()

    def set_pulse(self, width: float) -> None:
        """Sets the command from a pulse width in µs; 0 switches the output off."""
        if width == 0.0:
            self.switch_off()
            return
        config = self.config
        output = (width - config.low) / (config.high - config.low)
        self.set_output(min(max(output, 0.0), 1.0))

    def set_output(self, output: float) -> None:
        """Sets the command from an output, which is usually between 0 and 1."""
        config = self.config
        self._command = config.multiplier * (output + config.offset) + config.constant

    def set_command(self, command: float) -> None:
        """Sets the command."""
        self._command = command

    def switch_off(self) -> None:
        """No longer drives the joint."""
        if self._command is not None:
            self.reset()

    def drive(self, seconds: float) -> None:
        """Applies the command for a step, the given time in s after the last one."""
        command, config = self._command, self.config
        if command is None:
            return
        if self._publisher is not None:
            if self._publisher.wanted:
                self._publisher.publish(self._Float64(data=command))
            return
        servo, pid = self._servo, self._pid
        if servo is None:
            return
        if config.kind == "effort":
            servo.command_effort(command)
        elif config.kind == "exact position":
            servo.command_position(command)
        elif pid is None:
            servo.command_velocity(command / config.slowdown)
        else:
            effort, damping = self._effort(pid, command, seconds)
            servo.command_effort(effort, damping=damping)

    def _effort(self, pid: Pid, command: float, seconds: float) -> DampedEffort:
        joint = self._joint
        assert joint is not None
        velocity = joint.velocity
        if self.config.kind == "velocity":
            effort = pid.velocity(
                command / self.config.slowdown, velocity, seconds, joint.lightness
            )
        else:
            most = self.config.most_error
            error = min(max(command - joint.position, -most), most)
            effort = pid.position(error, seconds, target=command, lightness=joint.lightness)
        return pid.limited(effort, velocity)
