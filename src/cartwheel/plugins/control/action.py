"""Actions as ROS 1 has them: five topics, goals with a state each."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.messages import header, message_class, stamp, zero
from cartwheel.plugins.control.controller import Controller, Rhythm

PENDING, ACTIVE, PREEMPTED, SUCCEEDED, ABORTED, REJECTED, PREEMPTING, RECALLING, RECALLED = range(9)
_DONE = (PREEMPTED, SUCCEEDED, ABORTED, REJECTED, RECALLED)
_STATUS_RATE = 5.0
"""Hz."""
_KEPT_NS = 5_000_000_000
"""How long a goal that is done is told of."""


class Goal:
    """A goal and what became of it.

    Attributes:
        goal: The message.
        status: One of actionlib_msgs/GoalStatus.
    """

    def __init__(self, server: ActionServer, identity: Any, goal: Any) -> None:
        self._server = server
        self.identity = identity
        self.goal = goal
        self.status = PENDING
        self.text = ""
        self.done_ns = 0

    @property
    def done(self) -> bool:
        """Whether it has ended in any way."""
        return self.status in _DONE

    def accept(self) -> None:
        """It is worked at from now on."""
        self.status = ACTIVE
        self._server._tell_status()

    def reject(self, result: Any, text: str) -> None:
        """It is not taken on."""
        self._end(REJECTED, result, text)

    def succeed(self, result: Any, text: str = "") -> None:
        """It is reached."""
        self._end(SUCCEEDED, result, text)

    def abort(self, result: Any, text: str = "") -> None:
        """It cannot be reached."""
        self._end(ABORTED, result, text)

    def cancel(self, result: Any, text: str = "") -> None:
        """It was called off, or another one took its place."""
        self._end(PREEMPTED, result, text)

    def feedback(self, feedback: Any) -> None:
        """How it goes."""
        self._server._tell_feedback(self, feedback)

    def message(self) -> Any:
        """``actionlib_msgs/GoalStatus``."""
        return message_class("actionlib_msgs/msg/GoalStatus")(
            goal_id=self.identity, status=self.status, text=self.text
        )

    def _end(self, status: int, result: Any, text: str) -> None:
        self.status, self.text = status, text
        self._server._tell_result(self, result)


class ActionServer:
    """The topics ``goal``, ``cancel``, ``status``, ``feedback`` and ``result`` of an action.

    Args:
        controller: Below whose name they are.
        name: Of the action.
        kind: Type of the action: ``control_msgs/FollowJointTrajectory``.
        on_goal: Takes a new goal: accepts, rejects or ends it.
        on_cancel: Ends a goal that is to be cancelled.
    """

    def __init__(
        self,
        controller: Controller,
        name: str,
        kind: str,
        *,
        on_goal: Callable[[Goal], None],
        on_cancel: Callable[[Goal], None],
    ) -> None:
        package, _, action = kind.partition("/")
        self._kind = f"{package}/msg/{action}"
        self._part = controller.part
        self._node = controller.node
        self._on_goal, self._on_cancel = on_goal, on_cancel
        self._goals: list[Goal] = []
        self._count = 0
        self._rhythm = Rhythm(_STATUS_RATE)
        self._status = controller.advertise(
            f"{name}/status", "actionlib_msgs/msg/GoalStatusArray", rate=_STATUS_RATE
        )
        self._feedback = controller.advertise(f"{name}/feedback", f"{self._kind}ActionFeedback")
        self._result = controller.advertise(f"{name}/result", f"{self._kind}ActionResult")
        controller.subscribe(f"{name}/goal", f"{self._kind}ActionGoal", self._heard, always=True)
        controller.subscribe(
            f"{name}/cancel", "actionlib_msgs/msg/GoalID", self._called_off, always=True
        )

    def new(self, part: str) -> Any:
        """An empty ``Result`` or ``Feedback``."""
        return zero(f"{self._kind}{part}")

    @property
    def feedback_wanted(self) -> bool:
        """Whether anybody reads how it goes."""
        return self._feedback.wanted

    def tick(self, time_ns: int) -> None:
        """Tells the states of all goals when it is due, for others to see that it is there."""
        if self._rhythm.due(time_ns):
            self._goals = [
                goal for goal in self._goals if not goal.done or time_ns - goal.done_ns < _KEPT_NS
            ]
            self._tell_status()

    def start(self, time_ns: int) -> None:
        """Begins to tell."""
        self._goals = [goal for goal in self._goals if not goal.done]
        self._rhythm.start(time_ns)

    def _heard(self, message: Any) -> None:
        identity = message.goal_id
        if not identity.id:
            self._count += 1
            seconds = self._part.time_ns / 1e9
            identity = message_class("actionlib_msgs/msg/GoalID")(
                stamp=stamp(self._part.time_ns), id=f"{self._node}-{self._count}-{seconds:.9f}"
            )
        if any(goal.identity.id == identity.id for goal in self._goals):
            return
        goal = Goal(self, identity, message.goal)
        self._goals.append(goal)
        self._on_goal(goal)

    def _called_off(self, message: Any) -> None:
        """An id stands for its goal, a time for all before it, neither for all."""
        before = message.stamp.sec * 1_000_000_000 + message.stamp.nanosec
        for goal in list(self._goals):
            moment = goal.identity.stamp
            made = moment.sec * 1_000_000_000 + moment.nanosec
            meant = (
                (not message.id and not before)
                or goal.identity.id == message.id
                or (before and made <= before)
            )
            if meant and not goal.done:
                self._on_cancel(goal)

    def _tell_status(self) -> None:
        if self._status.wanted:
            self._status.publish(
                message_class("actionlib_msgs/msg/GoalStatusArray")(
                    header=header(self._part.time_ns, ""),
                    status_list=[goal.message() for goal in self._goals],
                )
            )

    def _tell_feedback(self, goal: Goal, feedback: Any) -> None:
        if self._feedback.wanted:
            self._feedback.publish(
                message_class(f"{self._kind}ActionFeedback")(
                    header=header(self._part.time_ns, ""),
                    status=goal.message(),
                    feedback=feedback,
                )
            )

    def _tell_result(self, goal: Goal, result: Any) -> None:
        goal.done_ns = self._part.time_ns
        if self._result.wanted:
            self._result.publish(
                message_class(f"{self._kind}ActionResult")(
                    header=header(self._part.time_ns, ""), status=goal.message(), result=result
                )
            )
        self._tell_status()
