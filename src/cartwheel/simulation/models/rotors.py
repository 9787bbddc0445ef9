"""The rotors of motors, whose velocities are commands."""

from __future__ import annotations

from collections.abc import Iterable

from cartwheel.simulation.handles import MotorHandle
from cartwheel.simulation.part import Part


class Rotors:
    """The rotors of all velocity motors in the compiled model.

    The torque of a motor changes the velocity of its rotor by about a millionth of a rad/s in
    100 ms, because a rotor's inertia is large but finite. A task that is idle does not write its
    command again, so the velocities are set again at fixed times.
    """

    def __init__(self) -> None:
        self._motors: list[MotorHandle] = []

    def bind(self, parts: Iterable[Part]) -> None:
        """Finds the motors of models, whose handles are bound."""
        self._motors = [
            handle for part in parts for handle in part.handles if isinstance(handle, MotorHandle)
        ]

    def hold(self) -> None:
        """Sets the velocities of all rotors to the commands of their motors."""
        for motor in self._motors:
            motor.rotors[motor.dof] = motor.target
