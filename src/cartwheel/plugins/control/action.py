"""The actions of controllers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.graph import Action, ActionTopics, Goal
from cartwheel.graph.actionlib import STATUS_RATE
from cartwheel.messages import store, zero
from cartwheel.messages.limits import unfit
from cartwheel.plugins.control.controller import Controller, Rhythm
from cartwheel.simulation.limits import STRONGEST


class ActionServer:
    """An action below a controller's name, on the graph as such and, if ROS 1 has it, as topics.

    Args:
        controller: Whose it is; it closes with that.
        name: Of the action.
        kind: Its type: ``FollowJointTrajectory`` of control_msgs.
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
        part = controller.part
        self._rhythm = Rhythm(STATUS_RATE)

        def take(goal: Goal) -> None:
            reason = unfit(goal.goal, most=STRONGEST, unset=True)
            if reason:
                goal.reject(zero(f"{self._action.type}_Result"), f"{reason} cannot be simulated")
            else:
                part.count_command()
                on_goal(goal)

        self._action = Action(
            controller.graph,
            controller.resolve(name),
            f"control_msgs_ros2/action/{kind}",
            node=controller.node,
            time_ns=lambda: part.time_ns,
            on_goal=take,
            on_cancel=on_cancel,
        )
        controller.keep(self._action)
        self._topics: ActionTopics | None = None
        if f"control_msgs/msg/{kind}Goal" in store().types:
            self._topics = ActionTopics(controller.graph, self._action)
            controller.keep(self._topics)

    def message(self, part: str, **fields: Any) -> Any:
        """A ``Result`` or ``Feedback``."""
        return self._action.message(part, **fields)

    @property
    def wants_feedback(self) -> bool:
        """Whether anybody reads how goals go."""
        return self._action.wants_feedback

    def tick(self, time_ns: int) -> None:
        """Tells the states of all goals when it is due, for others to see that it is there."""
        if self._rhythm.due(time_ns) and self._topics is not None:
            self._topics.tell()

    def start(self, time_ns: int) -> None:
        """Begins to tell."""
        self._action.restart()
        self._rhythm.start(time_ns)
