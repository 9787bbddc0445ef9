"""The joints of a drive: wheels follow a speed, and steering joints follow an angle."""

from __future__ import annotations

import math
from typing import Protocol

from cartwheel.devices.joints.limits import velocity_limit
from cartwheel.errors import Origin
from cartwheel.simulation import Part
from cartwheel.simulation.handles import JointHandle


class CommandedJoint(Protocol):
    """A joint that a drive measures and commands."""

    command: float
    """Speed of a wheel, rad/s, or angle of a steering joint, rad."""
    state: JointHandle
    """Position and velocity, which are read faster here."""

    @property
    def position(self) -> float:
        """rad."""

    @property
    def velocity(self) -> float:
        """rad/s."""


class Wheel:
    """A wheel with a motor.

    Args:
        part: The model's part of the simulation.
        joint: Name of the joint.
        max_effort: Maximum torque, N m, which replaces the joint's dry friction, as in ODE;
            None: the effort limit of the joint.
        limited: Whether the joint's velocity limit applies.
        beyond: Whether the torque may exceed the joint's effort limit.
        origin: Origin for errors.

    Raises:
        UnknownNameError: The joint does not exist.
    """

    def __init__(
        self,
        part: Part,
        joint: str,
        *,
        max_effort: float | None,
        limited: bool = False,
        beyond: bool = False,
        origin: Origin | None,
    ) -> None:
        self.state = part.joint(joint, origin=origin)
        self._fastest = velocity_limit(part.description.joint(joint)) if limited else math.inf
        self._motor = part.velocity_motor(
            joint,
            max_effort=max_effort,
            beyond=beyond,
            replaces_friction=max_effort is not None,
            repeats=True,
            origin=origin,
        )

    @property
    def position(self) -> float:
        """rad."""
        return self.state.position

    @property
    def velocity(self) -> float:
        """rad/s."""
        return self.state.velocity

    @property
    def command(self) -> float:
        """Target speed, rad/s."""
        return self._motor.target

    @command.setter
    def command(self, speed: float) -> None:
        motor, most = self._motor, self._fastest
        if speed > most or speed < -most:
            speed = math.copysign(most, speed)
        motor.target = motor.rotors[motor.dof] = speed
