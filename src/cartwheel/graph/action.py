"""Actions within the process: long-running goals that can be cancelled and end with a result.

A server creates an `Action` and works on its goals. Each wire format (the topics of ROS 1, the
services of ROS 2) is an `ActionListener` of this action. Call everything on the owner's thread.
"""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Protocol

from cartwheel.graph.names import resolve_name
from cartwheel.messages import message_class, zero

_KEPT_NS = 10_000_000_000
"""Minimum time in ns for which a completed goal, and so its result, is kept."""
_KEPT = 20
"""Number of completed goals that are kept regardless of their age."""
_MOST = 100
"""Maximum number of goals, because each change publishes the states of all goals."""


class GoalState(enum.Enum):
    """State of a goal."""

    PENDING = enum.auto()
    """The server has not accepted or rejected the goal yet."""
    ACTIVE = enum.auto()
    SUCCEEDED = enum.auto()
    CANCELLED = enum.auto()
    """The client cancelled the goal, or a newer goal preempted it."""
    ABORTED = enum.auto()
    REJECTED = enum.auto()
    """The server did not accept the goal."""


class Goal:
    """A goal and its state.

    Attributes:
        id: Identifier, unique within the action.
        stamp_ns: Simulation time at which the goal was created.
        goal: Goal message, ``…_Goal``.
        result: Result message, ``…_Result``, once the goal is done.
    """

    def __init__(self, action: Action, identity: str, stamp_ns: int, goal: Any) -> None:
        self._action = action
        self.id = identity
        self.stamp_ns = stamp_ns
        self.goal = goal
        self.state = GoalState.PENDING
        self.text = ""
        self.result: Any = None
        self.done_ns = 0

    @property
    def done(self) -> bool:
        """Whether the goal has ended in any state."""
        return self.state not in (GoalState.PENDING, GoalState.ACTIVE)

    def is_copy_of(self, other: Goal) -> bool:
        """Whether this is a goal that was saved in a state and created again from it."""
        mine, its = ((each.id, each.stamp_ns, each.goal) for each in (self, other))
        return bool(mine == its)

    def accept(self) -> None:
        """Accepts the goal."""
        self.state = GoalState.ACTIVE
        self._action._notify(self)

    def reject(self, result: Any, text: str) -> None:
        """Rejects the goal."""
        self._end(GoalState.REJECTED, result, text)

    def succeed(self, result: Any, text: str = "") -> None:
        """Ends the goal as succeeded."""
        self._end(GoalState.SUCCEEDED, result, text)

    def abort(self, result: Any, text: str = "") -> None:
        """Ends the goal as aborted."""
        self._end(GoalState.ABORTED, result, text)

    def cancel(self, result: Any, text: str = "") -> None:
        """Ends the goal as cancelled or preempted."""
        self._end(GoalState.CANCELLED, result, text)

    def feedback(self, feedback: Any) -> None:
        """Passes feedback (``…_Feedback``) to all listeners."""
        for listener in self._action.listeners:
            listener.goal_goes_on(self, feedback)

    def _end(self, state: GoalState, result: Any, text: str) -> None:
        if self.done:
            return  # such as by a reset of the world
        self.state, self.result, self.text = state, result, text
        self.done_ns = self._action.time_ns()
        self._action._notify(self)


class ActionListener(Protocol):
    """An action's representation on a wire."""

    @property
    def wants_feedback(self) -> bool:
        """Whether any client receives feedback."""

    def goal_changed(self, goal: Goal) -> None:
        """Called when the state of a goal changes."""

    def goal_goes_on(self, goal: Goal, feedback: Any) -> None:
        """Called with feedback on a goal."""


class Offers(Protocol):
    """Registry of actions by name."""

    def offer(self, action: Action) -> None:
        """Registers an action.

        Raises:
            GraphError: The name is already in use.
        """

    def take_back(self, action: Action) -> None:
        """Unregisters an action."""


class Action:
    """An action on a graph. It exists until it is closed.

    Args:
        graph: Graph that registers the action.
        name: Action name, under the same rules as topic names.
        type_name: ``pkg/action/Name``.
        node: Node that offers the action, for listings.
        time_ns: Returns the simulation time.
        on_goal: Accepts, rejects or ends a new goal.
        on_cancel: Ends a goal whose cancellation was requested.
        dropped: Returns the result of a goal that `drop` aborts; by default, it is empty.

    Raises:
        GraphError: The name is invalid or already in use.
    """

    _unsaved = frozenset({"listeners"})

    def __init__(
        self,
        graph: Offers,
        name: str,
        type_name: str,
        *,
        node: str,
        time_ns: Callable[[], int],
        on_goal: Callable[[Goal], None],
        on_cancel: Callable[[Goal], None],
        dropped: Callable[[], Any] | None = None,
    ) -> None:
        self._graph = graph
        self.name = resolve_name(name)
        self.type = type_name
        self.node = node
        self.time_ns = time_ns
        self._on_goal, self._on_cancel = on_goal, on_cancel
        self._dropped = dropped or partial(zero, f"{type_name}_Result")
        self._goals: dict[str, Goal] = {}
        self._generated = 0
        """Number of generated identifiers."""
        self.listeners: tuple[ActionListener, ...] = ()
        graph.offer(self)

    def close(self) -> None:
        """Aborts all goals, and removes the action from the graph."""
        self.abort("the action was withdrawn")
        self._graph.take_back(self)

    def message(self, part: str, **fields: Any) -> Any:
        """Creates a ``Result`` or ``Feedback`` message of this action."""
        return message_class(f"{self.type}_{part}")(**fields)

    @property
    def wants_feedback(self) -> bool:
        """Whether any client receives feedback."""
        return any(listener.wants_feedback for listener in self.listeners)

    @property
    def goals(self) -> list[Goal]:
        """Active and recently completed goals, in the order of submission."""
        return list(self._goals.values())

    def goal(self, identity: str) -> Goal | None:
        """The known goal with this identifier, or None."""
        return self._goals.get(identity)

    def listen(self, listener: ActionListener) -> None:
        """Adds a listener, which is notified of all goals from now on."""
        self.listeners += (listener,)

    def leave(self, listener: ActionListener) -> None:
        """Removes a listener."""
        self.listeners = tuple(each for each in self.listeners if each is not listener)

    def submit(self, goal: Any, *, identity: str = "", stamp_ns: int | None = None) -> Goal | None:
        """Submits a goal. Returns None if a goal with this identifier already exists.

        Args:
            goal: Goal message, ``…_Goal``.
            identity: Goal identifier. If empty, one is generated.
            stamp_ns: Simulation time at which the goal was created. None means now.
        """
        now = self.time_ns()
        self._forget(now)
        if not identity:
            self._generated += 1
            identity = f"{self.node}-{self._generated}-{now / 1e9:.9f}"
        if identity in self._goals:
            return None
        made = Goal(self, identity, now if stamp_ns is None else stamp_ns, goal)
        is_full = len(self._goals) >= _MOST
        self._goals[identity] = made
        if is_full:
            made.reject(zero(f"{self.type}_Result"), f"{_MOST} goals are already in progress")
        else:
            self._on_goal(made)
        return made

    def cancel(self, *, identity: str = "", before_ns: int = 0) -> list[Goal]:
        """Cancels goals by identifier or creation time, or all goals if neither is given.

        A goal is cancelled if its identifier matches, or if it was created at or before
        `before_ns`.

        Returns:
            The goals that were active.
        """
        meant = [
            goal
            for goal in self._goals.values()
            if not goal.done
            and (
                (not identity and not before_ns)
                or goal.id == identity
                or (before_ns and goal.stamp_ns <= before_ns)
            )
        ]
        for goal in meant:
            if not goal.done:
                self._on_cancel(goal)
        return meant

    def abort(self, text: str) -> None:
        """Aborts all goals that have not ended; `text` is the reason."""
        for goal in tuple(self._goals.values()):
            self.drop(goal, text)

    def drop(self, goal: Goal, text: str) -> None:
        """Aborts a goal, unless it has ended; `text` is the reason."""
        if not goal.done:
            goal.abort(self._dropped(), text)

    def restart(self) -> None:
        """Forgets completed goals, because simulation time restarts."""
        self._goals = {key: goal for key, goal in self._goals.items() if not goal.done}

    def _notify(self, goal: Goal) -> None:
        for listener in self.listeners:
            listener.goal_changed(goal)

    def _forget(self, now: int) -> None:
        done = [goal for goal in self._goals.values() if goal.done]
        for goal in self._late(done, now):
            del self._goals[goal.id]
        # Clients may send any number of goals within the retention time of one goal.
        kept = [goal for goal in done if goal.id in self._goals]
        for goal in kept[: max(0, len(self._goals) - _MOST + 1)]:
            del self._goals[goal.id]

    @staticmethod
    def _late(done: list[Goal], now: int) -> Iterable[Goal]:
        done.sort(key=lambda goal: goal.done_ns)
        return [goal for goal in done[:-_KEPT] if now - goal.done_ns > _KEPT_NS]
