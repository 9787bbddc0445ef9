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
from cartwheel.bridges.ros2.middleware import (
    CALLS,
    DEFAULT,
    LATCHED,
    Answer,
    Middleware,
    Reply,
    Served,
)
from cartwheel.codes.wires import CALL_LIMIT, GOAL_REJECTED, MALFORMED_MESSAGE
from cartwheel.errors import Diagnostic, GraphError
from cartwheel.graph import Goal, GoalState
from cartwheel.messages import decode_cdr, encode_cdr, message_class, stamp, zero
from cartwheel.messages.ros2.types import ros2_service, ros2_type

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
        middleware: Middleware to offer the action on.
        tell: Receives warnings.
        node: See `Middleware.publish`.
    """

    def __init__(
        self,
        graph: BridgedGraph,
        action: BridgedAction,
        *,
        loop: Loop,
        middleware: Middleware,
        tell: Callable[[Diagnostic], None],
        node: str,
    ) -> None:
        self.action = action
        self.node = node
        self._graph = graph
        self._loop = loop
        self._tell = tell
        self._submitting = False
        self._readers = False
        self._waiting: dict[str, list[Reply]] = {}
        """Pending result requests of active goals. Used on the owner's thread."""
        self._closed = False
        self._status_due = False
        self._status_at = 0.0
        """Time of the last status message. Used on the owner's thread, like `_status_due`."""
        base, kind = f"{action.name}/_action", action.type
        self._types = {
            "send_goal": f"{kind}_SendGoal",
            "cancel_goal": _CANCEL,
            "get_result": f"{kind}_GetResult",
        }
        self._status = middleware.publish(
            f"{base}/status", ros2_type(_STATUS), LATCHED, lambda _: None, node=node
        )
        self._feedback = middleware.publish(
            f"{base}/feedback",
            ros2_type(f"{kind}_FeedbackMessage"),
            DEFAULT,
            self._found_readers,
            node=node,
        )
        self._services = [
            middleware.serve(
                f"{base}/{name}",
                (Served(ros2_service(self._types[name]), self._answer(name, handler)),),
                depth=CALLS,
                node=node,
            )
            for name, handler in (
                ("send_goal", self._send_goal),
                ("cancel_goal", self._cancel_goal),
                ("get_result", self._get_result),
            )
        ]
        graph.post(self._join)

    def close(self) -> None:
        """Removes the action from ROS 2. Call it on the loop's thread."""
        self._closed = True
        self._graph.post(lambda: self.action.leave(self))
        for each in (self._status, self._feedback, *self._services):
            each.close()

    @property
    def wants_feedback(self) -> bool:
        """See `ActionListener`."""
        return self._readers

    # -- on the loop's thread

    def _found_readers(self, there: bool) -> None:
        self._readers = there

    def _answer(self, name: str, handler: Callable[[Any, Reply], None]) -> Answer:
        def answer(data: bytes, reply: Reply) -> None:
            try:
                request = decode_cdr(data, ros2_service(self._types[name]).request)
            except GraphError as error:
                self._tell(
                    MALFORMED_MESSAGE.because(
                        f"malformed request to {self.action.name}/_action/{name}",
                        error,
                        values={"service": f"{self.action.name}/_action/{name}"},
                    )
                )
                return
            self._graph.post(lambda: handler(request, reply))

        return answer

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
            for reply in self._waiting.pop(goal.id, ()):
                self._send_result(goal, reply)

    def goal_goes_on(self, goal: Goal, feedback: Any) -> None:
        """See `ActionListener`."""
        if self._readers:
            self._publish(
                self._feedback.send,
                message_class(f"{self.action.type}_FeedbackMessage")(
                    goal_id=_uuid(goal.id), feedback=feedback
                ),
            )

    def _send_goal(self, request: Any, reply: Reply) -> None:
        # The client must receive the acceptance before any feedback on its goal.
        self._submitting = True
        try:
            goal = self.action.submit(request.goal, identity=_identity(request.goal_id))
        finally:
            self._submitting = False
        accepted = goal is not None and goal.state is not GoalState.REJECTED
        moment = stamp(self.action.time_ns())
        self._respond(reply, "send_goal", accepted=accepted, stamp=moment)
        if goal is not None and goal.state is GoalState.REJECTED:
            # The response has no field for the reason.
            self._tell(
                GOAL_REJECTED.diagnostic(
                    f"{self.action.name}: a goal was rejected: {goal.text}",
                    values={"action": self.action.name, "reason": goal.text},
                )
            )
        elif goal is not None:
            self.goal_changed(goal)

    def _cancel_goal(self, request: Any, reply: Reply) -> None:
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
        self._respond(
            reply,
            "cancel_goal",
            return_code=code,
            goals_canceling=[_info(goal) for goal in meant],
        )

    def _get_result(self, request: Any, reply: Reply) -> None:
        goal = self._known(_identity(request.goal_id))
        if goal is None or goal.state is GoalState.REJECTED:
            self._send_result(None, reply)
        elif goal.done:
            self._send_result(goal, reply)
        elif sum(len(replies) for replies in self._waiting.values()) < _WAITING:
            self._waiting.setdefault(goal.id, []).append(reply)
        else:
            self._tell(
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

    def _send_result(self, goal: Goal | None, reply: Reply) -> None:
        if goal is None:
            result = zero(f"{self.action.type}_Result")
            self._respond(reply, "get_result", status=_UNKNOWN, result=result)
        else:
            self._respond(reply, "get_result", status=_STATES[goal.state], result=goal.result)

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

    def _respond(self, reply: Reply, name: str, **fields: Any) -> None:
        self._publish(reply, message_class(ros2_service(self._types[name]).response)(**fields))

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
