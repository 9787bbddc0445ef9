"""Velocities and accelerations of models and links."""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.api.values import vector
from cartwheel.geometry import Vec3, immutable

_STILL: Vec3 = (0.0, 0.0, 0.0)


@immutable("Assign a new velocity: robot.velocity = cartwheel.Twist(linear=(x, y, z)).")
@dataclass(frozen=True, slots=True)
class Twist:
    """The velocity of a frame, in world axes."""

    linear: Vec3 = _STILL
    """Velocity of the frame's origin, m/s."""
    angular: Vec3 = _STILL
    """rad/s."""

    def __post_init__(self) -> None:
        _made_of_floats(self)


@immutable("An acceleration cannot be set. Use Link.push to apply a force.")
@dataclass(frozen=True, slots=True)
class Acceleration:
    """The acceleration of a frame, in world axes. A body in free fall accelerates with gravity."""

    linear: Vec3 = _STILL
    """Acceleration of the frame's origin, m/s²."""
    angular: Vec3 = _STILL
    """rad/s²."""

    def __post_init__(self) -> None:
        _made_of_floats(self)


def _made_of_floats(motion: Twist | Acceleration) -> None:
    """Converts arrays and lists, so that motions can be compared.

    Raises:
        CartwheelError: There are not three finite numbers.
    """
    for name in ("linear", "angular"):
        values = getattr(motion, name)
        if type(values) is not tuple or len(values) != 3:
            object.__setattr__(motion, name, vector(values, name))
