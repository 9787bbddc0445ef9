"""Actions in ROS 1, as five topics."""

from __future__ import annotations

from typing import Any

from cartwheel.budget import Budget
from cartwheel.graph.action import Action, Goal, GoalState
from cartwheel.graph.graph import Graph
from cartwheel.graph.topic import Publisher, Subscription
from cartwheel.messages import header, message_class, recast, stamp
from cartwheel.messages.ros2.types import ros2_name

STATUS_RATE = 5.0
"""Minimum publish rate of goal states in Hz."""
_AT_ONCE, _AT_ONCE_RATE = 10, 20
"""Number of goal changes that are published at once, and the number that is added per s of
simulation time. Later changes are published with the next regular states. A message contains the
states of up to 100 goals, and takes several times as long as a goal."""
_STATUS_LIST_TIMEOUT_NS = 5_000_000_000
"""Time in ns for which a completed goal stays in the published states."""
_STATES = {
    GoalState.PENDING: 0,
    GoalState.ACTIVE: 1,
    GoalState.CANCELLED: 2,
    GoalState.SUCCEEDED: 3,
    GoalState.ABORTED: 4,
    GoalState.REJECTED: 5,
}


class ActionTopics:
    """The topics ``goal``, ``cancel``, ``status``, ``feedback`` and ``result`` of an action.

    They are topics on the graph, so shell commands and recordings see them as well.
    Source: actionlib.

    Args:
        graph: Graph on which the topics are created.
        action: Action that the topics represent.

    Raises:
        GraphError: One of the topics exists with a different type.
    """

    def __init__(self, graph: Graph, action: Action) -> None:
        self._action = action
        package, _, name = ros2_name(action.type).split("/")
        self._kind = f"{package}/msg/{name}"
        self._goal = f"{action.type}_Goal"
        self._open: list[Publisher | Subscription] = []
        self._changes = Budget(_AT_ONCE, _AT_ONCE_RATE, clock=action.time_ns)

        def advertise(topic: str, kind: str, rate: float | None = None) -> Publisher:
            made = graph.advertise(f"{action.name}/{topic}", kind, node=action.node, rate=rate)
            self._open.append(made)
            return made

        self._status = advertise("status", "actionlib_msgs/msg/GoalStatusArray", STATUS_RATE)
        self._feedback = advertise("feedback", f"{self._kind}ActionFeedback")
        self._result = advertise("result", f"{self._kind}ActionResult")
        for topic, kind, callback in (
            ("goal", f"{self._kind}ActionGoal", self._on_goal),
            ("cancel", "actionlib_msgs/msg/GoalID", self._on_cancel),
        ):
            self._open.append(
                graph.subscribe(
                    f"{action.name}/{topic}", callback, type_name=kind, node=action.node
                )
            )
        action.listen(self)

    def close(self) -> None:
        """Removes the topics from the graph."""
        self._action.leave(self)
        for each in self._open:
            each.close()
        self._open.clear()

    @property
    def wants_feedback(self) -> bool:
        """See `ActionListener`."""
        return self._feedback.wanted

    def publish_status(self) -> None:
        """Publishes the states of all goals, also as a sign that the action server exists."""
        if not self._status.wanted:
            return
        now = self._action.time_ns()
        statuses = [
            self._state(goal)
            for goal in self._action.goals
            if not goal.done or now - goal.done_ns < _STATUS_LIST_TIMEOUT_NS
        ]
        self._status.publish(
            message_class("actionlib_msgs/msg/GoalStatusArray")(
                header=header(now, ""), status_list=statuses
            )
        )

    def goal_changed(self, goal: Goal) -> None:
        """See `ActionListener`."""
        if goal.done and self._result.wanted:
            self._publish(self._result, "Result", goal, goal.result)
        if self._changes.take():
            self.publish_status()

    def goal_goes_on(self, goal: Goal, feedback: Any) -> None:
        """See `ActionListener`."""
        if self._feedback.wanted:
            self._publish(self._feedback, "Feedback", goal, feedback)

    def _publish(self, publisher: Publisher, part: str, goal: Goal, message: Any) -> None:
        publisher.publish(
            message_class(f"{self._kind}Action{part}")(
                header=header(self._action.time_ns(), ""),
                status=self._state(goal),
                **{part.lower(): recast(message, f"{self._kind}{part}")},
            )
        )

    def _on_goal(self, message: Any) -> None:
        identity = message.goal_id
        made_ns = _nanoseconds(identity.stamp)
        self._action.submit(
            recast(message.goal, self._goal), identity=identity.id, stamp_ns=made_ns or None
        )

    def _on_cancel(self, message: Any) -> None:
        self._action.cancel(identity=message.id, before_ns=_nanoseconds(message.stamp))

    @staticmethod
    def _state(goal: Goal) -> Any:
        return message_class("actionlib_msgs/msg/GoalStatus")(
            goal_id=message_class("actionlib_msgs/msg/GoalID")(
                stamp=stamp(goal.stamp_ns), id=goal.id
            ),
            status=_STATES[goal.state],
            text=goal.text,
        )


def _nanoseconds(moment: Any) -> int:
    return int(moment.sec) * 1_000_000_000 + int(moment.nanosec)
