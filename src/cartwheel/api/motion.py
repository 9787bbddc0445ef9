"""Velocities and accelerations of models and links."""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.geometry import Vec3

_STILL: Vec3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Twist:
    """The velocity of a frame, in world axes."""

    linear: Vec3 = _STILL
    """Velocity of the frame's origin, m/s."""
    angular: Vec3 = _STILL
    """rad/s."""


@dataclass(frozen=True, slots=True)
class Acceleration:
    """The acceleration of a frame, in world axes. A body in free fall accelerates with gravity."""

    linear: Vec3 = _STILL
    """Acceleration of the frame's origin, m/s²."""
    angular: Vec3 = _STILL
    """rad/s²."""
