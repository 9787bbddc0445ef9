"""A driven wheel: what a drive reads from it and commands."""

from __future__ import annotations

from typing import Protocol

from cartwheel.errors import Origin
from cartwheel.simulation import Part


class Wheel(Protocol):
    """A wheel with a velocity command, such as a joint with a motor, or a hardware interface."""

    command: float
    """Commanded angular velocity, rad/s."""

    @property
    def position(self) -> float:
        """Rotation, rad."""

    @property
    def velocity(self) -> float:
        """Angular velocity, rad/s."""


class MotorWheel:
    """A wheel that a motor turns.

    Args:
        part: The robot.
        joint: Joint of the wheel.
        max_torque: N m; None: the joint's effort limit.
        origin: File and line of the description of the drive.

    Raises:
        UnknownNameError: The joint does not exist.
    """

    def __init__(
        self, part: Part, joint: str, *, max_torque: float | None, origin: Origin | None
    ) -> None:
        self._joint = part.joint(joint, origin=origin)
        self._motor = part.velocity_motor(joint, max_effort=max_torque, origin=origin)

    @property
    def position(self) -> float:
        """Rotation, rad."""
        return self._joint.position

    @property
    def velocity(self) -> float:
        """Angular velocity, rad/s."""
        return self._joint.velocity

    @property
    def command(self) -> float:
        """Commanded angular velocity, rad/s."""
        return self._motor.target

    @command.setter
    def command(self, velocity: float) -> None:
        self._motor.command(velocity)
