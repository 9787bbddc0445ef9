"""Actions of the graph in ROS 2, as three services and two topics.

Source: rcl_action; the design article on actions.
"""

from __future__ import annotations

import functools
import hashlib
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from cartwheel.bridges.bridged import BridgedAction, BridgedGraph
from cartwheel.bridges.loop import Loop
from cartwheel.bridges.ros2.middleware import Middleware, publisher
from cartwheel.bridges.ros2.services import Handler, Respond, Services
from cartwheel.codes.wires import CALL_LIMIT, GOAL_REJECTED
from cartwheel.errors import Diagnostic
from cartwheel.graph import Goal, GoalState
from cartwheel.messages import encode_cdr, message_class, stamp, zero

_STATUS = "action_msgs/msg/GoalStatusArray"
_CANCEL = "action_msgs/srv/CancelGoal"
_UNKNOWN, _EXECUTING, _CANCELED = 0, 2, 5
_STATES = {
    GoalState.PENDING: 1,
    GoalState.ACTIVE: _EXECUTING,
    GoalState.SUCCEEDED: 4,
    GoalState.CANCELLED: _CANCELED,
    GoalState.ABORTED: 6,
}
_NONE, _REFUSED, _UNKNOWN_GOAL, _TERMINATED = range(4)
"""Return codes of a cancel request."""
_STATUS_PAUSE = 0.05
"""Minimum interval in s between status messages. Each one costs the simulation's thread several
times as much as a goal."""
_WAITING = 100
"""Maximum number of pending result requests."""


class OfferedAction:
    """An offered action. Create it on the loop's thread.

    A result request is answered when the goal ends, so no thread waits for it.

    Args:
        graph: Graph with the action.
        action: Action to offer.
        loop: Event loop of the bridge.
        middleware: Middleware to publish the topics on.
        services: Offers the services.
        warn: Receives warnings.
        node: See `Endpoint.node`.
    """

    def __init__(
        self,
        graph: BridgedGraph,
        action: BridgedAction,
        *,
        loop: Loop,
        middleware: Middleware,
        services: Services,
        warn: Callable[[Diagnostic], None],
        node: str,
    ) -> None:
        self.action = action
        self.node = node
        self._graph = graph
        self._loop = loop
        self._warn = warn
        self._submitting = False
        self.wants_feedback = False
        self._waiting: dict[str, list[Respond]] = {}
        """Pending result requests of active goals. Used on the owner's thread."""
        self._closed = False
        self._status_due = False
        self._status_at = 0.0
        """Time of the last status message. Used on the owner's thread, like `_status_due`."""
        base, kind = f"{action.name}/_action", action.type
        self._status = middleware.publish(publisher(f"{base}/status", _STATUS, "latched", node))
        self._feedback = middleware.publish(
            publisher(f"{base}/feedback", f"{kind}_FeedbackMessage", node=node), self._found_readers
        )
        self._services = [
            services.offer_deferred(f"{base}/{name}", type_name, self._posted(handler), node=node)
            for name, type_name, handler in (
                ("send_goal", f"{kind}_SendGoal", self._send_goal),
                ("cancel_goal", _CANCEL, self._cancel_goal),
                ("get_result", f"{kind}_GetResult", self._get_result),
            )
        ]
        graph.post(self._join)

    def close(self) -> None:
        """Removes the action from ROS 2. Call it on the loop's thread."""
        self._closed = True
        self._graph.post(lambda: self.action.leave(self))
        for each in (self._status, self._feedback, *self._services):
            each.close()

    # -- on the loop's thread

    def _found_readers(self, there: bool) -> None:
        self.wants_feedback = there

    def _posted(self, handler: Handler) -> Handler:
        return lambda request, respond: self._graph.post(lambda: handler(request, respond))

    # -- on the owner's thread

    def _join(self) -> None:
        self.action.listen(self)
        self._publish_status()

    def goal_changed(self, goal: Goal) -> None:
        """See `ActionListener`."""
        if self._submitting:
            return
        self._schedule_status()
        if goal.done:
            for respond in self._waiting.pop(goal.id, ()):
                self._send_result(goal, respond)

    def goal_goes_on(self, goal: Goal, feedback: Any) -> None:
        """See `ActionListener`."""
        if self.wants_feedback:
            self._publish(
                self._feedback.send,
                message_class(f"{self.action.type}_FeedbackMessage")(
                    goal_id=_uuid(goal.id), feedback=feedback
                ),
            )

    def _send_goal(self, request: Any, respond: Respond) -> None:
        # The client must receive the acceptance before any feedback on its goal.
        self._submitting = True
        try:
            goal = self.action.submit(request.goal, identity=_identity(request.goal_id))
        finally:
            self._submitting = False
        accepted = goal is not None and goal.state is not GoalState.REJECTED
        moment = stamp(self.action.time_ns())
        made = message_class(f"{self.action.type}_SendGoal_Response")
        respond(made(accepted=accepted, stamp=moment))
        if goal is not None and goal.state is GoalState.REJECTED:
            # The response has no field for the reason.
            self._warn(
                GOAL_REJECTED.diagnostic(
                    f"{self.action.name}: a goal was rejected: {goal.text}",
                    values={"action": self.action.name, "reason": goal.text},
                )
            )
        elif goal is not None:
            self.goal_changed(goal)

    def _cancel_goal(self, request: Any, respond: Respond) -> None:
        info = request.goal_info
        before_ns = info.stamp.sec * 1_000_000_000 + info.stamp.nanosec
        identity = _identity(info.goal_id) if any(info.goal_id.uuid) else ""
        known = self._known(identity) if identity else None
        if known is not None:
            identity = known.id
        meant = self.action.cancel(identity=identity, before_ns=before_ns)
        code = _NONE if meant else _REFUSED
        if not meant and identity and not before_ns:
            code = _UNKNOWN_GOAL if known is None else _TERMINATED
        made = message_class(f"{_CANCEL}_Response")
        respond(made(return_code=code, goals_canceling=[_info(goal) for goal in meant]))

    def _get_result(self, request: Any, respond: Respond) -> None:
        goal = self._known(_identity(request.goal_id))
        if goal is None or goal.state is GoalState.REJECTED:
            self._send_result(None, respond)
        elif goal.done:
            self._send_result(goal, respond)
        elif sum(len(replies) for replies in self._waiting.values()) < _WAITING:
            self._waiting.setdefault(goal.id, []).append(respond)
        else:
            self._warn(
                CALL_LIMIT.diagnostic(
                    f"more than {_WAITING} clients are waiting for results of {self.action.name}, "
                    "so one result request gets no response",
                    values={"action": self.action.name, "most": _WAITING},
                )
            )

    def _known(self, identity: str) -> Goal | None:
        """Finds a goal by its ROS 2 identifier, even if it was created on a different wire."""
        found = self.action.goal(identity)
        if found is not None:
            return found
        named = (each for each in self.action.goals if _bytes(each.id).hex() == identity)
        return next(named, None)

    def _send_result(self, goal: Goal | None, respond: Respond) -> None:
        status = _STATES[goal.state] if goal else _UNKNOWN
        result = goal.result if goal else zero(f"{self.action.type}_Result")
        made = message_class(f"{self.action.type}_GetResult_Response")
        respond(made(status=status, result=result))

    def _schedule_status(self) -> None:
        """Publishes the goal states now, or together with the next changes."""
        if self._status_due:
            return
        wait = self._status_at + _STATUS_PAUSE - time.monotonic()
        if wait <= 0:
            self._publish_status()
            return
        self._status_due = True
        later = functools.partial(self._graph.post, self._publish_status)
        self._loop.post(lambda: self._loop.after(wait, later))

    def _publish_status(self) -> None:
        self._status_due = False
        self._status_at = time.monotonic()
        GoalStatus = message_class("action_msgs/msg/GoalStatus")
        self._publish(
            self._status.send,
            message_class(_STATUS)(
                status_list=[
                    GoalStatus(goal_info=_info(goal), status=_STATES[goal.state])
                    for goal in self.action.goals
                    if goal.state in _STATES
                ]
            ),
        )

    def _publish(self, send: Callable[[bytes], None], message: Any) -> None:
        data = encode_cdr(message)
        self._loop.post(lambda: None if self._closed else send(data))


def _identity(uuid: Any) -> str:
    return bytes(uuid.uuid).hex()


def _bytes(identity: str) -> bytes:
    """16-byte identifier of a goal. Identifiers from other wires are hashed."""
    try:
        plain = bytes.fromhex(identity)
    except ValueError:
        plain = b""
    if len(plain) == 16:
        return plain
    return hashlib.md5(identity.encode(), usedforsecurity=False).digest()


def _uuid(identity: str) -> Any:
    return message_class("unique_identifier_msgs/msg/UUID")(
        uuid=np.frombuffer(_bytes(identity), np.uint8)
    )


def _info(goal: Goal) -> Any:
    return message_class("action_msgs/msg/GoalInfo")(
        goal_id=_uuid(goal.id), stamp=stamp(goal.stamp_ns)
    )
