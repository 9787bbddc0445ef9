"""The action ``FollowJointTrajectory``: goals that succeed or fail as joints follow them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from cartwheel.component import Component, Scope
from cartwheel.devices.action_server import ActionServer
from cartwheel.devices.joints.actuator import JointActuator
from cartwheel.devices.joints.trajectory_follower import Tracking, TrajectoryFollower
from cartwheel.devices.joints.trajectory_reading import (
    GOAL,
    INVALID_GOAL,
    PATH,
    SUCCESSFUL,
    InvalidTrajectoryError,
    TrajectoryReader,
)
from cartwheel.devices.joints.trajectory_tolerances import Tolerances
from cartwheel.devices.periodic import Periodic
from cartwheel.graph import Goal
from cartwheel.messages import header, message_class, zero

_SETTLING_NS = 300_000_000
"""Time that joints have to come to rest after the last point before a goal counts as missed, ns."""
Ending = Literal["succeed", "cancel", "abort"]


@dataclass(frozen=True, kw_only=True, slots=True)
class TrajectoryGoalsConfig:
    tolerances: Tolerances
    """Names and tolerances of the joints."""
    monitor_rate: float
    """Rate of the feedback, Hz."""
    preempted: Literal["cancel", "abort"]
    """How goals end that are replaced, or whose controller stops."""
    waits_without_goal_time: bool
    """Wait for late joints without a limit if the goal time is 0."""


class TrajectoryGoals(Component):
    """Accepts goals of the action ``follow_joint_trajectory``, and ends them.

    A goal succeeds when the time of the last point has passed and all joints are within their goal
    tolerances. It is aborted, and the joints are held, if they are not within these tolerances
    after another ``goal_time``, or if one leaves its path tolerance.

    Args:
        scope: Names of the action.
        config: Tolerances and rates.
        follower: Follows the trajectories of the goals.
        reader: Reads the trajectories.
        joints: The joints, for feedback.
        running: Whether goals are accepted.
        started: Whether the controller has started. Goals that arrive earlier wait until then.
    """

    def __init__(
        self,
        scope: Scope,
        config: TrajectoryGoalsConfig,
        *,
        follower: TrajectoryFollower,
        reader: TrajectoryReader,
        joints: Sequence[JointActuator],
        running: Callable[[], bool],
        started: Callable[[], bool],
    ) -> None:
        super().__init__(scope)
        self._config = config
        self._follower, self._reader = follower, reader
        self._joints = list(joints)
        self._running, self._started = running, started
        self._early: list[Goal] = []
        """Goals that arrived before the start of the controller."""
        self._monitor = Periodic(config.monitor_rate)
        self._active: Goal | None = None
        self._path, self._goal = list(config.tolerances.path), list(config.tolerances.goal)
        self._goal_time = config.tolerances.goal_time
        self._action = ActionServer(
            self,
            "follow_joint_trajectory",
            "FollowJointTrajectory",
            on_goal=self._on_goal,
            on_cancel=self._on_cancel,
        )

    def start(self, time_ns: int) -> None:
        """Starts the feedback and the status, and follows goals that arrived before.

        A goal of the time before a restart is aborted.
        """
        self._monitor.start(time_ns)
        self._action.start(time_ns)
        self._finish("abort", INVALID_GOAL, "the controller was restarted")
        early, self._early = self._early, []
        for goal in early:
            if not goal.done:
                self._take(goal)

    def stop(self) -> None:
        """Ends the goal because the controller stops."""
        self._refuse_early("the controller was stopped")
        self._finish(self._config.preempted, INVALID_GOAL, "the controller was stopped")

    def interrupt(self) -> None:
        """Ends the goal because the simulation was reset."""
        self._refuse_early("the world was reset")
        self._finish("abort", INVALID_GOAL, "the world was reset")

    def tick(self, time_ns: int) -> None:
        """Publishes the status when due."""
        self._action.tick(time_ns)

    def preempt(self, text: str) -> None:
        """Ends the goal because another trajectory replaces it; `text` is the reason."""
        cancelled = self._config.preempted == "cancel"
        self._finish(self._config.preempted, SUCCESSFUL if cancelled else INVALID_GOAL, text)

    def watch(self, time_ns: int, tracking: Tracking) -> None:
        """Ends the goal when it is reached or missed, and publishes feedback."""
        goal = self._active
        if goal is None:
            return
        if self._monitor.due(time_ns) and self._action.wants_feedback:
            self._publish_feedback(goal, time_ns, tracking)
        names, errors = self._config.tolerances.names, tracking.errors
        if time_ns < self._follower.end_ns:
            if self._follower.waits:
                return
            for name, tolerance, error in zip(names, self._path, errors, strict=True):
                if tolerance.violated(*error):
                    text = f'joint "{name}" has {tolerance.excess(*error)} on the path'
                    self._finish("abort", PATH, text)
                    self._follower.hold(time_ns)
                    return
            return
        missed = [
            f'joint "{name}" has {tolerance.excess(*error)} at the goal'
            for name, tolerance, error in zip(names, self._goal, errors, strict=True)
            if tolerance.violated(*error)
        ]
        if not missed:
            self._finish("succeed", SUCCESSFUL, "")
            return
        endless = self._config.waits_without_goal_time and self._goal_time == 0
        late_ns = self._follower.end_ns + _SETTLING_NS + round(min(self._goal_time, 1e9) * 1e9)
        if not endless and time_ns > late_ns:
            self._finish("abort", GOAL, missed[0])
            self._follower.hold(time_ns)

    def _on_goal(self, goal: Goal) -> None:
        if not self._running():
            self._refuse(goal, "the controller is not running")
        elif not self._started():
            # It starts at its next update, from the positions of that time.
            self._early.append(goal)
        else:
            self._take(goal)

    def _refuse_early(self, text: str) -> None:
        early, self._early = self._early, []
        for goal in early:
            if not goal.done:
                self._refuse(goal, text)

    def _refuse(self, goal: Goal, text: str) -> None:
        goal.reject(self._result(INVALID_GOAL, text), text)

    def _take(self, goal: Goal) -> None:
        """Follows the trajectory of a goal, or rejects the goal."""
        time_ns = self.part.time_ns
        try:
            if goal.goal.multi_dof_trajectory.points:
                raise InvalidTrajectoryError(
                    INVALID_GOAL, "joints with several degrees of freedom are not supported"
                )
            if not goal.goal.trajectory.points:
                raise InvalidTrajectoryError(INVALID_GOAL, "the trajectory has no points")
            trajectory = self._reader.read(goal.goal.trajectory, time_ns, self._follower.current)
            path, end = self._config.tolerances.of(goal.goal)
        except InvalidTrajectoryError as error:
            goal.reject(self._result(error.result, error.message), error.message)
            return
        self.preempt("replaced by a new goal")
        self._path, self._goal = path, end
        span = goal.goal.goal_time_tolerance
        seconds = span.sec + span.nanosec / 1e9
        # 0 keeps the default; a negative time means no limit.
        self._goal_time = seconds if seconds > 0 else self._config.tolerances.goal_time
        if seconds < 0:
            self._goal_time = math.inf
        self._active = goal
        goal.accept()
        self._follower.follow(trajectory, time_ns)

    def _on_cancel(self, goal: Goal) -> None:
        if goal is self._active:
            self._finish("cancel", SUCCESSFUL, "cancelled")
            self._follower.hold(self.part.time_ns)
        else:
            goal.cancel(self._result(SUCCESSFUL, ""), "cancelled")

    def _finish(self, ending: Ending, code: int, text: str) -> None:
        goal, self._active = self._active, None
        if goal is not None:
            getattr(goal, ending)(self._result(code, text), text)

    def _result(self, code: int, text: str) -> Any:
        return self._action.message("Result", error_code=code, error_string=text)

    def _publish_feedback(self, goal: Goal, time_ns: int, tracking: Tracking) -> None:
        message = zero("control_msgs_ros2/action/FollowJointTrajectory_Feedback")
        message.header, message.joint_names = (
            header(time_ns, ""),
            list(self._config.tolerances.names),
        )
        points = tracking_points(self._joints, tracking)
        message.desired, message.actual, message.error = points
        goal.feedback(message)


def tracking_points(joints: Sequence[JointActuator], tracking: Tracking) -> tuple[Any, Any, Any]:
    """Returns the desired state, the actual state and the error as JointTrajectoryPoint messages.

    Args:
        joints: The joints.
        tracking: Desired states and errors of the joints.
    """
    desired, errors = tracking.desired, tracking.errors
    return (
        trajectory_point(desired.position, desired.velocity, desired.acceleration),
        trajectory_point([each.position for each in joints], [each.velocity for each in joints]),
        trajectory_point([error[0] for error in errors], [error[1] for error in errors]),
    )


def trajectory_point(
    positions: Sequence[float] = (),
    velocities: Sequence[float] = (),
    accelerations: Sequence[float] = (),
    effort: Sequence[float] = (),
) -> Any:
    """Returns a JointTrajectoryPoint message."""
    return message_class("trajectory_msgs/msg/JointTrajectoryPoint")(
        positions=np.array(positions, dtype=float),
        velocities=np.array(velocities, dtype=float),
        accelerations=np.array(accelerations, dtype=float),
        effort=np.array(effort, dtype=float),
    )
