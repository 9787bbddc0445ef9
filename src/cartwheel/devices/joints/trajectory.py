"""Joint trajectories: polynomials between points."""

from __future__ import annotations

import itertools
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

from cartwheel.devices.elementwise import Number

Vector = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class State:
    """State of several joints at one time, a number for each joint: rad or m, and derivatives."""

    position: Vector
    velocity: Vector
    acceleration: Vector


@dataclass(frozen=True, kw_only=True, slots=True)
class Waypoint:
    """A point of a trajectory. Velocities and accelerations are empty if not specified."""

    time: float
    """Time since the start of the trajectory, s."""
    position: Vector
    velocity: Vector = ()
    acceleration: Vector = ()


class Trajectory:
    """A trajectory through points.

    A segment is linear if one of its ends has no velocities, cubic if both have velocities, and
    quintic if both also have accelerations. Before its first point and after its last point, the
    trajectory is at rest at that point. Source: joint_trajectory_controller, QuinticSplineSegment.

    Args:
        start_ns: Simulation time of the trajectory's time 0.
        points: At least one point, with strictly increasing times.
    """

    def __init__(self, start_ns: int, points: Sequence[Waypoint]) -> None:
        self.start_ns = start_ns
        self._times = [point.time for point in points]
        self._points = list(points)
        self._segments = [_segment(a, b) for a, b in itertools.pairwise(points)]

    @classmethod
    def hold(cls, start_ns: int, position: Sequence[float]) -> Trajectory:
        """Returns a trajectory that stays at a position."""
        return cls(start_ns, [Waypoint(time=0.0, position=tuple(position))])

    @property
    def end_ns(self) -> int:
        """Simulation time of the last point."""
        return self.start_ns + round(self._times[-1] * 1e9)

    def at(self, time_ns: int) -> State:
        """Returns the state at a simulation time."""
        time = (time_ns - self.start_ns) / 1e9
        index = bisect_right(self._times, time) - 1
        if index < 0:
            return _rest(self._points[0].position)
        if index >= len(self._segments):
            return _rest(self._points[-1].position)
        time -= self._times[index]
        position, velocity, acceleration = [], [], []
        for coefficients in self._segments[index]:
            value, rate, change = polynomial(coefficients, time)
            position.append(value)
            velocity.append(rate)
            acceleration.append(change)
        return State(tuple(position), tuple(velocity), tuple(acceleration))


def polynomial(coefficients: Sequence[Number], time: Number) -> tuple[Number, Number, Number]:
    """Returns position, velocity and acceleration of a joint in a segment.

    Args:
        coefficients: Six coefficients of a polynomial in time, the constant first.
        time: Time since the start of the segment, s.
    """
    c0, c1, c2, c3, c4, c5 = coefficients
    return (
        c0 + time * (c1 + time * (c2 + time * (c3 + time * (c4 + time * c5)))),
        c1 + time * (2 * c2 + time * (3 * c3 + time * (4 * c4 + time * 5 * c5))),
        2 * c2 + time * (6 * c3 + time * (12 * c4 + time * 20 * c5)),
    )


def next_point(times_ns: Sequence[int], index: int, time_ns: int) -> int:
    """Returns the index of the first point, from `index` on, whose time has not passed.

    Args:
        times_ns: Times of the points, which need not increase.
        index: The current point.
        time_ns: A point with exactly this time has not passed.
    """
    while index < len(times_ns) and times_ns[index] < time_ns:
        index += 1
    return index


def _rest(position: Vector) -> State:
    still = (0.0,) * len(position)
    return State(position, still, still)


def _segment(a: Waypoint, b: Waypoint) -> list[tuple[float, ...]]:
    """Returns the coefficients of each joint's polynomial, the constant first."""
    span = b.time - a.time
    coefficients: list[tuple[float, ...]] = []
    for joint, (start, end) in enumerate(zip(a.position, b.position, strict=True)):
        if not a.velocity or not b.velocity:
            coefficients.append((start, (end - start) / span, 0.0, 0.0, 0.0, 0.0))
            continue
        va, vb = a.velocity[joint], b.velocity[joint]
        way = end - start
        if not a.acceleration or not b.acceleration:
            c2 = (3 * way / span - 2 * va - vb) / span
            c3 = (va + vb - 2 * way / span) / span**2
            coefficients.append((start, va, c2, c3, 0.0, 0.0))
            continue
        aa, ab = a.acceleration[joint], b.acceleration[joint]
        c3 = (20 * way - (8 * vb + 12 * va) * span - (3 * aa - ab) * span**2) / (2 * span**3)
        c4 = (-30 * way + (14 * vb + 16 * va) * span + (3 * aa - 2 * ab) * span**2) / (2 * span**4)
        c5 = (12 * way - 6 * (vb + va) * span + (ab - aa) * span**2) / (2 * span**5)
        coefficients.append((start, va, aa / 2, c3, c4, c5))
    return coefficients
