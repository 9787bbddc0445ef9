"""Action servers of devices and controllers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.component import Component
from cartwheel.devices.periodic import Periodic
from cartwheel.graph import Action, ActionTopics, Goal
from cartwheel.graph.actionlib import STATUS_RATE
from cartwheel.messages import zero
from cartwheel.messages.limits import unfit
from cartwheel.messages.store import exists
from cartwheel.simulation.limits import STRONGEST


class ActionServer:
    """An action of a component, also offered as ROS 1 topics if ROS 1 defines its type.

    Args:
        component: The component. The action closes with it.
        name: Name of the action, resolved in the component's scope.
        kind: Type in control_msgs, such as ``FollowJointTrajectory``.
        on_goal: Accepts, rejects or finishes a new goal.
        on_cancel: Finishes a goal that a client cancels.
    """

    def __init__(
        self,
        component: Component,
        name: str,
        kind: str,
        *,
        on_goal: Callable[[Goal], None],
        on_cancel: Callable[[Goal], None],
    ) -> None:
        part = component.part
        self._periodic = Periodic(STATUS_RATE)

        def take(goal: Goal) -> None:
            reason = unfit(goal.goal, most=STRONGEST, unset=True)
            if reason:
                goal.reject(zero(f"{self._action.type}_Result"), f"{reason} cannot be simulated")
            else:
                part.count_command()
                on_goal(goal)

        self._action = Action(
            component.graph,
            component.resolve(name),
            f"control_msgs_ros2/action/{kind}",
            node=component.node,
            time_ns=lambda: part.time_ns,
            on_goal=take,
            on_cancel=on_cancel,
        )
        component.keep(self._action)
        part.actions.add(self._action.name)
        self._topics: ActionTopics | None = None
        if exists(f"control_msgs/msg/{kind}Goal"):
            self._topics = ActionTopics(component.graph, self._action)
            component.keep(self._topics)

    def message(self, part: str, **fields: Any) -> Any:
        """Returns a ``Result`` or ``Feedback`` message."""
        return self._action.message(part, **fields)

    @property
    def wants_feedback(self) -> bool:
        """Whether a client receives the feedback."""
        return self._action.wants_feedback

    def tick(self, time_ns: int) -> None:
        """Publishes the status of all goals when due, by which ROS 1 clients find the server."""
        if self._periodic.due(time_ns) and self._topics is not None:
            self._topics.publish_status()

    def start(self, time_ns: int) -> None:
        """Starts to publish the status."""
        self._action.restart()
        self._periodic.start(time_ns)
