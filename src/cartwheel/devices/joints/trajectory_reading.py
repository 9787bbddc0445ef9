"""Conversion of trajectory messages to trajectories, with checks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from cartwheel.codes import running
from cartwheel.devices.joints.actuator import JointActuator
from cartwheel.devices.joints.trajectory import State, Trajectory, Waypoint
from cartwheel.errors import PluginError
from cartwheel.messages import nanoseconds

SUCCESSFUL, INVALID_GOAL, INVALID_JOINTS, OLD_HEADER, PATH, GOAL = 0, -1, -2, -3, -4, -5
"""Error codes of FollowJointTrajectory."""
_STILL = 1e-5
"""Maximum velocity at the last point, rad/s or m/s, if joints must stop there."""


class InvalidTrajectoryError(PluginError):
    """A trajectory that cannot be followed, with the error code of the action."""

    code = running.TRAJECTORY_INVALID

    def __init__(self, result: int, message: str) -> None:
        super().__init__(message, values={"result": result})
        self.result = result


@dataclass(frozen=True, kw_only=True, slots=True)
class TrajectoryRules:
    """What a trajectory may omit or contain."""

    partial: bool = False
    """Accept trajectories for some of the joints; the others stay at their desired positions."""
    integrates: bool = False
    """Compute missing positions from velocities."""
    must_stop: bool = False
    """Reject trajectories whose last point has a velocity."""


class TrajectoryReader:
    """Reads ``trajectory_msgs/JointTrajectory`` messages for some joints.

    Source: joint_trajectory_controller.

    Args:
        names: Names of the joints in the messages.
        joints: The joints, in the same order.
        rules: What the messages may omit or contain.
    """

    def __init__(
        self, names: Sequence[str], joints: Sequence[JointActuator], rules: TrajectoryRules
    ) -> None:
        self._names = list(names)
        self._joints = list(joints)
        self._rules = rules

    def read(self, message: Any, time_ns: int, following: Trajectory) -> Trajectory:
        """Reads a message as a trajectory that begins at the desired state of its start time.

        Args:
            message: The trajectory.
            time_ns: Simulation time.
            following: The trajectory that the joints follow until then.

        Raises:
            InvalidTrajectoryError: The trajectory cannot be followed.
        """
        names = list(message.joint_names)
        order = self._order(names)
        stamp_ns = nanoseconds(message.header.stamp)
        start_ns = stamp_ns or time_ns
        begin_ns = max(start_ns, time_ns)
        begin = following.at(begin_ns)
        points: list[Waypoint] = []
        before = Waypoint(time=0.0, position=begin.position, velocity=begin.velocity)
        last = -1.0
        for number, point in enumerate(message.points):
            span = point.time_from_start
            time = span.sec + span.nanosec / 1e9
            if time < 0 or time <= last:
                raise InvalidTrajectoryError(
                    INVALID_GOAL,
                    f"the time of point {number} must be at least 0 and after the previous one",
                )
            last = time
            moved = time - (begin_ns - start_ns) / 1e9
            waypoint = self._waypoint(point, number, order, begin, moved)
            if not waypoint.position:
                waypoint = self._integrated(before, waypoint, number)
            before = waypoint
            if moved > 1e-9:
                points.append(waypoint)
            elif number == len(message.points) - 1 and stamp_ns == 0:
                # The joints move as fast as they can. The goal ends when they can have arrived.
                return Trajectory(time_ns, [replace(waypoint, time=self._shortest(waypoint))])
        if not points:
            raise InvalidTrajectoryError(OLD_HEADER, "all trajectory points are in the past")
        if self._rules.must_stop and any(abs(rate) > _STILL for rate in points[-1].velocity):
            raise InvalidTrajectoryError(
                INVALID_GOAL, "the last trajectory point has a nonzero velocity"
            )
        self._unwind(points, begin)
        first = Waypoint(
            time=0.0,
            position=begin.position,
            velocity=begin.velocity,
            acceleration=begin.acceleration,
        )
        return Trajectory(begin_ns, [first, *points])

    def _shortest(self, point: Waypoint) -> float:
        """Returns the shortest time in s in which the joints that can move can reach a point."""
        ways = zip(point.position, self._joints, strict=True)
        times = (
            abs(place - joint.position) / joint.limits.velocity
            for place, joint in ways
            if joint.limits.velocity
        )
        return max(times, default=0.0)

    def _order(self, names: list[str]) -> list[int]:
        """Returns the index of each of our joints in a message; -1 if missing."""
        unknown = [name for name in names if name not in self._names]
        if unknown:
            raise InvalidTrajectoryError(
                INVALID_JOINTS, f'joint "{unknown[0]}" is not a joint of this controller'
            )
        missing = [name for name in self._names if name not in names]
        if missing and not self._rules.partial:
            raise InvalidTrajectoryError(INVALID_JOINTS, f'joint "{missing[0]}" is missing')
        return [names.index(name) if name in names else -1 for name in self._names]

    def _waypoint(
        self, point: Any, number: int, order: list[int], begin: State, time: float
    ) -> Waypoint:
        count = sum(place >= 0 for place in order)

        def ours(values: Any, what: str, rest: tuple[float, ...]) -> tuple[float, ...]:
            if len(values) == 0:
                return ()
            if len(values) != count:
                raise InvalidTrajectoryError(
                    INVALID_GOAL,
                    f"point {number} has {len(values)} {what} for {count} joints",
                )
            numbers = [float(value) for value in values]
            if not all(math.isfinite(value) for value in numbers):
                raise InvalidTrajectoryError(
                    INVALID_GOAL, f"the {what} of point {number} are not all finite"
                )
            return tuple(
                numbers[place] if place >= 0 else rest[index] for index, place in enumerate(order)
            )

        still = (0.0,) * len(order)
        return Waypoint(
            time=time,
            position=ours(point.positions, "positions", begin.position),
            velocity=ours(point.velocities, "velocities", still),
            acceleration=ours(point.accelerations, "accelerations", still),
        )

    def _integrated(self, before: Waypoint, point: Waypoint, number: int) -> Waypoint:
        """Computes the positions of a point from velocities, by the trapezoidal rule."""
        if not self._rules.integrates or not point.velocity:
            raise InvalidTrajectoryError(
                INVALID_GOAL, f"trajectory point {number} has no positions"
            )
        span = max(point.time - before.time, 0.0)
        rates = zip(before.velocity or point.velocity, point.velocity, strict=True)
        return replace(
            point,
            position=tuple(
                place + span * (first + second) / 2
                for place, (first, second) in zip(before.position, rates, strict=True)
            ),
        )

    def _unwind(self, points: list[Waypoint], begin: State) -> None:
        """Subtracts full turns, so that continuous joints take the shorter direction."""
        for joint, actuator in enumerate(self._joints):
            if actuator.type != "continuous":
                continue
            way = points[0].position[joint] - begin.position[joint]
            turns = way - math.remainder(way, 2 * math.pi)
            if abs(turns) < 1e-9:
                continue
            for index, point in enumerate(points):
                position = list(point.position)
                position[joint] -= turns
                points[index] = replace(point, position=tuple(position))
