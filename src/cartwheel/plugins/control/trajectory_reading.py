"""Trajectories as messages: whether they can be followed, and as polynomials."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from cartwheel.codes import running
from cartwheel.errors import PluginError
from cartwheel.plugins.control.hardware import JointHardware
from cartwheel.plugins.control.settings import Settings
from cartwheel.plugins.control.trajectory import State, Trajectory, Waypoint

SUCCESSFUL, INVALID_GOAL, INVALID_JOINTS, OLD_HEADER, PATH, GOAL = 0, -1, -2, -3, -4, -5
"""Error codes of FollowJointTrajectory."""
_STILL = 1e-5
"""rad/s or m/s that a joint that stops may still have at its last point, in ROS 2."""


class InvalidTrajectoryError(PluginError):
    """A trajectory that cannot be followed, with the error code of the action."""

    code = running.TRAJECTORY_INVALID

    def __init__(self, result: int, message: str) -> None:
        super().__init__(message, values={"result": result})
        self.result = result


class TrajectoryReader:
    """Reads ``trajectory_msgs/JointTrajectory`` for some joints.

    Source: joint_trajectory_controller.

    Args:
        names: Of the joints, as trajectories call them.
        joints: What moves, in the same order.
        settings: The controller's: what trajectories may leave out.
        ros2: Whether the rules are those of ROS 2.
    """

    def __init__(
        self,
        names: Sequence[str],
        joints: Sequence[JointHardware],
        settings: Settings,
        *,
        ros2: bool,
    ) -> None:
        self._names = list(names)
        self._joints = list(joints)
        self._partial = settings.boolean("allow_partial_joints_goal", False)
        self._integrates = settings.boolean("allow_integration_in_goal_trajectories", False)
        may_go_on = settings.boolean("allow_nonzero_velocity_at_trajectory_end", False)
        self._must_stop = ros2 and not may_go_on

    def read(self, message: Any, time_ns: int, following: Trajectory) -> Trajectory:
        """A message as a trajectory that begins where the joints are to be then.

        Args:
            message: The trajectory.
            time_ns: Simulation time.
            following: What the joints do until it begins.

        Raises:
            InvalidTrajectoryError: It cannot be followed.
        """
        names = list(message.joint_names)
        order = self._order(names)
        moment = message.header.stamp
        stamp_ns = moment.sec * 1_000_000_000 + moment.nanosec
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
                    f"the time of point {number} must be later than the time of the previous point",
                )
            last = time
            moved = time - (begin_ns - start_ns) / 1e9
            made = self._waypoint(point, number, order, begin, moved)
            if not made.position:
                made = self._integrated(before, made, number)
            before = made
            if moved > 1e-9:
                points.append(made)
            elif number == len(message.points) - 1 and stamp_ns == 0:
                # At once, as fast as the joints can: it ends when they may be there.
                return Trajectory(time_ns, [replace(made, time=self._shortest(made))])
        if not points:
            raise InvalidTrajectoryError(OLD_HEADER, "all its points are in the past")
        if self._must_stop and any(abs(rate) > _STILL for rate in points[-1].velocity):
            raise InvalidTrajectoryError(INVALID_GOAL, "the last point has a nonzero velocity")
        self._unwind(points, begin)
        first = Waypoint(
            time=0.0,
            position=begin.position,
            velocity=begin.velocity,
            acceleration=begin.acceleration,
        )
        return Trajectory(begin_ns, [first, *points])

    def _shortest(self, point: Waypoint) -> float:
        """s that the joints need for a way at least."""
        ways = zip(point.position, self._joints, strict=True)
        return max(abs(place - joint.position) / joint.velocity_limit for place, joint in ways)

    def _order(self, names: list[str]) -> list[int]:
        """Where each of our joints is in a message; -1 where it is not."""
        unknown = [name for name in names if name not in self._names]
        if unknown:
            raise InvalidTrajectoryError(
                INVALID_JOINTS, f'joint "{unknown[0]}" does not belong to this controller'
            )
        missing = [name for name in self._names if name not in names]
        if missing and not self._partial:
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
        """A point without positions: where its velocities lead, by the trapezoidal rule."""
        if not self._integrates or not point.velocity:
            raise InvalidTrajectoryError(INVALID_GOAL, f"point {number} has no positions")
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
        """Joints without limits go the short way: whole turns are taken off."""
        for joint, hardware in enumerate(self._joints):
            if hardware.type != "continuous":
                continue
            way = points[0].position[joint] - begin.position[joint]
            turns = way - math.remainder(way, 2 * math.pi)
            if abs(turns) < 1e-9:
                continue
            for index, point in enumerate(points):
                position = list(point.position)
                position[joint] -= turns
                points[index] = replace(point, position=tuple(position))
