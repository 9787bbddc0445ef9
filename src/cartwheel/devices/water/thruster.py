"""A marine propeller, whose thrust or speed is commanded."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

from cartwheel.component import Component, Scope
from cartwheel.geometry import Vec3, rotate
from cartwheel.messages import message_class

_FLOAT, _BOOL = "std_msgs/msg/Float64", "std_msgs/msg/Bool"
_FASTEST = 100.0
"""Largest speed at which the propeller's joint is turned, rad/s: without a stated diameter, the
speeds that belong to a thrust are so high that the joint's angle means nothing."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ThrusterConfig:
    joint: str
    """Joint of the propeller. The thrust acts on its child link, along its axis."""
    command: Literal["force", "velocity"]
    """Quantity that is commanded, N or rad/s."""
    command_topic: str
    """Topic of the commands (Float64)."""
    state_topic: str
    """Topic of the propeller's speed in rad/s if the force is commanded, of the force in N if the
    speed is (Float64)."""
    deadband_topic: str
    """Topic that switches the deadband (Bool)."""
    least: float
    most: float
    """Range of the commands."""
    deadband: float = 0.0
    """Thrust below which the propeller stands still, N."""
    density: float
    """Density of the fluid, kg/m³."""
    diameter: float
    """Diameter of the propeller, m."""
    coefficient: float
    """Thrust coefficient; negative if the propeller turns the other way round."""
    advance_slope: float = 0.0
    """Change of the thrust coefficient with the advance ratio."""
    wake_fraction: float = 0.0
    """Part of the vehicle's speed by which the water at the propeller is slower."""


class Thruster(Component):
    """Applies the thrust of a propeller to its link, and turns the propeller.

    The thrust acts at once, whatever the speed of the joint.

    Args:
        scope: The model.
        config: Joint, commands and coefficients.

    Raises:
        UnknownNameError: The joint does not exist.
    """

    def __init__(self, scope: Scope, config: ThrusterConfig) -> None:
        super().__init__(scope)
        part, origin = self.part, self.origin
        self._config = config
        part.joint(config.joint, origin=origin)
        joint = part.description.joint(config.joint)
        assert joint is not None
        self._axis = rotate(joint.pose.orientation, joint.axis.xyz)
        self._link = part.link(joint.child, origin=origin)
        self._wrench = part.wrench(joint.child, origin=origin)
        description = part.description.link(joint.child)
        assert description is not None
        x, y, z = description.mass_centre
        self._arm: Vec3 = (-x, -y, -z)
        self._motor = part.velocity_motor(config.joint, max_effort=None, origin=origin)
        self._Float = message_class(_FLOAT)
        self._states = self.advertise(config.state_topic, _FLOAT)
        self.reset()
        self.subscribe(config.command_topic, _FLOAT, self._on_command)
        self.subscribe(config.deadband_topic, _BOOL, self._on_deadband)
        part.schedule(0, before=self._apply)
        part.schedule(0, after=self._publish, topics=self.publishers)

    def reset(self) -> None:
        super().reset()
        self._command = self._speed = self._thrust = 0.0
        self._deadband = self._config.deadband > 0
        self._motor.command(0.0)

    def _on_command(self, message: Any) -> None:
        self._command = min(max(float(message.data), self._config.least), self._config.most)

    def _on_deadband(self, message: Any) -> None:
        self._deadband = bool(message.data)

    def _apply(self) -> None:
        if not self._command and not self._thrust:
            return
        self.part.locate()
        config = self._config
        _, orientation = self._link.place()
        coefficient = config.coefficient
        if config.advance_slope:
            along, _ = self._link.motion(local=False)
            coefficient += config.advance_slope * advance_ratio(
                config, math.hypot(*along), self._speed
            )
        thrust, speed = operating_point(config, coefficient, self._command)
        if self._deadband and abs(thrust) < config.deadband:
            thrust = speed = 0.0
        self._thrust, self._speed = thrust, speed
        ax, ay, az = rotate(orientation, self._axis)
        fx, fy, fz = thrust * ax, thrust * ay, thrust * az
        x, y, z = rotate(orientation, self._arm)
        self._wrench.apply((fx, fy, fz), (y * fz - z * fy, z * fx - x * fz, x * fy - y * fx))
        self._motor.command(min(max(speed, -_FASTEST), _FASTEST))

    def _publish(self) -> None:
        force = self._config.command == "force"
        self._states.publish(self._Float(self._speed if force else self._thrust))


def advance_ratio(config: ThrusterConfig, velocity: float, speed: float) -> float:
    """Speed of the water at the propeller relative to that of the propeller.

    Args:
        config: The coefficients.
        velocity: Speed of the vehicle, m/s.
        speed: Speed of the propeller, rad/s. At standstill, the ratio is 0.
    """
    return (1.0 - config.wake_fraction) * velocity / (speed * config.diameter) if speed else 0.0


def operating_point(
    config: ThrusterConfig, coefficient: float, command: float
) -> tuple[float, float]:
    """Thrust in N and speed in rad/s of a propeller.

    The thrust is proportional to the square of the speed. Source: T. I. Fossen, Guidance and
    Control of Ocean Vehicles, 1994, p. 246, and gz-sim, where the speed is in rad/s.

    Args:
        config: The coefficients.
        coefficient: Thrust coefficient.
        command: N or rad/s.
    """
    factor = config.density * coefficient * config.diameter**4
    if config.command == "velocity":
        return factor * abs(command) * command, command
    if not command or not factor:
        return command, 0.0
    return command, math.copysign(math.sqrt(abs(command / factor)), command * factor)
