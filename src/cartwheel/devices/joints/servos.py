"""Servos of single joints: they hold the last commanded position or velocity, or apply a force."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from cartwheel.codes import running
from cartwheel.component import Component, Scope
from cartwheel.devices.elementwise import clamp
from cartwheel.devices.joints.limits import velocity_limit
from cartwheel.devices.joints.pid import Pid, PidGains
from cartwheel.devices.periodic import Elapsed
from cartwheel.messages import message_class

_FLOAT = "std_msgs/msg/Float64"
_ACTUATORS = "actuator_msgs/msg/Actuators"


@dataclass(frozen=True, kw_only=True, slots=True)
class JointServosConfig:
    joints: tuple[str, ...]
    """Names of the joints, which have the same target."""
    topic: str
    """Topic of the target (Float64, or Actuators with an `actuator`)."""
    actuator: int | None = None
    """Index of the target in a message of type Actuators. None: the type is Float64."""
    quantity: Literal["position", "velocity"]
    """Quantity of the target: a position in rad or m, or a velocity in rad/s or m/s."""
    initial: float = 0.0
    """Target until the first command."""
    gains: PidGains | None = None
    """Gains of a PID controller for each joint. The derivative gain damps a joint with a target
    position, and has no effect with a target velocity. None: the joints reach the target regardless
    of their loads."""
    max_velocity: float = math.inf
    """Maximum velocity of joints that move to a position without gains, rad/s or m/s."""
    limited: bool = False
    """Whether the velocity limits of the joints apply to joints without gains, as in gz-sim."""


class JointServos(Component):
    """Holds joints at the last commanded position or velocity, from the next step on.

    Positions can also be commanded manually.

    Raises:
        UnknownNameError: A joint does not exist.
    """

    def __init__(self, scope: Scope, config: JointServosConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        self._joints = [
            (
                part.joint(name, origin=origin),
                part.servo(
                    name,
                    max_effort=None,
                    efforts=None if config.gains is None else "set",
                    origin=origin,
                ),
            )
            for name in config.joints
        ]
        self._fastest = [
            min(
                velocity_limit(part.description.joint(name)) if config.limited else math.inf,
                config.max_velocity if config.quantity == "position" else math.inf,
            )
            for name in config.joints
        ]
        gains = config.gains
        self._pids = [Pid(gains) for _ in self._joints] if gains is not None else []
        for name, pid in zip(config.joints, self._pids, strict=False):
            part.tune(name, pid)
        if config.actuator is None:
            self.subscribe(config.topic, _FLOAT, self._on_command)
        else:
            self.subscribe(config.topic, _ACTUATORS, self._on_actuators)
        self.reset()
        moves = config.quantity == "position"
        part.schedule(0, before=self._move if moves else self._turn).reads_state = True
        if moves:
            # Joints with the same target share one input.
            self.take_positions(config.joints[:1], self._publish_command)

    def reset(self) -> None:
        self._target = self._config.initial
        for pid in self._pids:
            pid.reset()
        self._elapsed = Elapsed()

    def _on_command(self, message: Any) -> None:
        self._target = float(message.data)

    def _on_actuators(self, message: Any) -> None:
        config = self._config
        number = config.actuator or 0
        targets = message.position if config.quantity == "position" else message.velocity
        if number >= len(targets):
            self.warn(
                running.COMMAND_IGNORED,
                f"a command is ignored: it has only {len(targets)} {config.quantity} values, so "
                f"that of actuator {number} is missing",
                values={"values": len(targets), "actuator": number},
            )
            return
        self._target = float(targets[number])

    def _publish_command(self, wanted: Mapping[str, float], seconds: float) -> None:  # noqa: ARG002
        (value,) = wanted.values()
        if self._config.actuator is not None:
            # A message would also command the other actuators of the topic.
            self._target = float(value)
            return
        message = message_class(_FLOAT)(data=float(value))
        self.graph.publish(self.resolve(self._config.topic), _FLOAT, message)

    def _move(self) -> None:
        config, target = self._config, self._target
        if config.gains is None:
            for (_, servo), fastest in zip(self._joints, self._fastest, strict=True):
                servo.command_position(target, max_velocity=fastest)
            return
        seconds = self._elapsed.seconds(self.part.time_ns)
        step = self.part.clock.step_ns * 1e-9
        for (joint, servo), pid in zip(self._joints, self._pids, strict=True):
            error = target - joint.position
            command = pid.position_command(error, joint.velocity, seconds, step, joint.lightness)
            servo.command_effort(*command)

    def _turn(self) -> None:
        if self._config.gains is None:
            for (_, servo), fastest in zip(self._joints, self._fastest, strict=True):
                servo.command_velocity(clamp(self._target, -fastest, fastest))
            return
        seconds = self._elapsed.seconds(self.part.time_ns)
        step = self.part.clock.step_ns * 1e-9
        for (joint, servo), pid in zip(self._joints, self._pids, strict=True):
            velocity = joint.velocity
            error = self._target - velocity
            command = pid.velocity_command(error, velocity, seconds, step, joint.lightness)
            servo.command_effort(*command)


@dataclass(frozen=True, kw_only=True, slots=True)
class JointForceConfig:
    joint: str
    """Name of the joint."""
    topic: str
    """Topic of the force in N or the torque in N m (Float64)."""


class JointForce(Component):
    """Applies the last commanded force or torque to a joint, in addition to that of a PID
    controller.

    Raises:
        UnknownNameError: The joint does not exist.
    """

    def __init__(self, scope: Scope, config: JointForceConfig) -> None:
        super().__init__(scope)
        self._servo = self.part.servo(
            config.joint, max_effort=None, efforts="added", origin=self.origin
        )
        self.subscribe(config.topic, _FLOAT, self._on_command)

    def reset(self) -> None:
        self.part.add_effort(self._servo, 0.0)
        self._servo.release()

    def _on_command(self, message: Any) -> None:
        self.part.add_effort(self._servo, float(message.data))
