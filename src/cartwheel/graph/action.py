"""Actions in one process: goals that take time, can be called off, and end in a result.

Whoever works at the goals makes an `Action`; the forms that actions have on a wire (ROS 1's
topics, ROS 2's services) are `ActionListener`s of it. All of it is for the owner's thread.
"""

from __future__ import annotations

import enum
import itertools
from collections.abc import Callable, Iterable
from typing import Any, Protocol

from cartwheel.graph.names import resolve_name
from cartwheel.messages import message_class, zero

_KEPT_NS = 10_000_000_000
"""How long a goal that is done is known at least, for those who ask for its result."""
_KEPT = 20
"""So many of them are known however long ago they ended."""
_MOST = 100
"""Goals that are known at a time: each change of one publishes the states of all."""


class GoalState(enum.Enum):
    """What a goal has come to."""

    PENDING = enum.auto()
    """Nobody has looked at it."""
    ACTIVE = enum.auto()
    SUCCEEDED = enum.auto()
    CANCELLED = enum.auto()
    """It was called off, or another one took its place."""
    ABORTED = enum.auto()
    REJECTED = enum.auto()
    """It was not taken on."""


class Goal:
    """A goal and what became of it.

    Attributes:
        id: Its name among all goals of the action.
        stamp_ns: When it was made, simulation time.
        goal: The message, ``…_Goal``.
        result: The message, ``…_Result``, once it is done.
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
        """Whether it has ended in any way."""
        return self.state not in (GoalState.PENDING, GoalState.ACTIVE)

    def accept(self) -> None:
        """It is worked at from now on."""
        self.state = GoalState.ACTIVE
        self._action._tell(self)

    def reject(self, result: Any, text: str) -> None:
        """It is not taken on."""
        self._end(GoalState.REJECTED, result, text)

    def succeed(self, result: Any, text: str = "") -> None:
        """It is reached."""
        self._end(GoalState.SUCCEEDED, result, text)

    def abort(self, result: Any, text: str = "") -> None:
        """It cannot be reached."""
        self._end(GoalState.ABORTED, result, text)

    def cancel(self, result: Any, text: str = "") -> None:
        """It was called off, or another one took its place."""
        self._end(GoalState.CANCELLED, result, text)

    def feedback(self, feedback: Any) -> None:
        """How it goes: ``…_Feedback``."""
        for listener in self._action.listeners:
            listener.goal_goes_on(self, feedback)

    def _end(self, state: GoalState, result: Any, text: str) -> None:
        self.state, self.result, self.text = state, result, text
        self.done_ns = self._action.time_ns()
        self._action._tell(self)


class ActionListener(Protocol):
    """A form of an action on a wire."""

    @property
    def wants_feedback(self) -> bool:
        """Whether anybody reads how goals go."""

    def goal_changed(self, goal: Goal) -> None:
        """A goal has another state."""

    def goal_goes_on(self, goal: Goal, feedback: Any) -> None:
        """How a goal goes."""


class Offers(Protocol):
    """Where actions are known by their names."""

    def offer(self, action: Action) -> None:
        """Makes an action known.

        Raises:
            GraphError: The name is taken.
        """

    def take_back(self, action: Action) -> None:
        """It is known no longer."""


class Action:
    """An action of a graph, offered until it is closed.

    Args:
        graph: Where it is offered.
        name: As topics are called.
        type_name: ``pkg/action/Name``.
        node: Who offers it, for listings.
        time_ns: Tells simulation time.
        on_goal: Takes a new goal: accepts, rejects or ends it.
        on_cancel: Ends a goal that is to be called off.

    Raises:
        GraphError: The name is taken, or is none.
    """

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
    ) -> None:
        self._graph = graph
        self.name = resolve_name(name)
        self.type = type_name
        self.node = node
        self.time_ns = time_ns
        self._on_goal, self._on_cancel = on_goal, on_cancel
        self._goals: dict[str, Goal] = {}
        self._numbers = itertools.count(1)
        self.listeners: tuple[ActionListener, ...] = ()
        graph.offer(self)

    def close(self) -> None:
        """Takes it off the graph."""
        self._graph.take_back(self)

    def message(self, part: str, **fields: Any) -> Any:
        """A ``Result`` or ``Feedback``."""
        return message_class(f"{self.type}_{part}")(**fields)

    @property
    def wants_feedback(self) -> bool:
        """Whether anybody reads how goals go."""
        return any(listener.wants_feedback for listener in self.listeners)

    @property
    def goals(self) -> list[Goal]:
        """Those that are worked at and those that ended lately, in order."""
        return list(self._goals.values())

    def goal(self, identity: str) -> Goal | None:
        """One of `goals`."""
        return self._goals.get(identity)

    def listen(self, listener: ActionListener) -> None:
        """Tells it of all goals from now on."""
        self.listeners += (listener,)

    def leave(self, listener: ActionListener) -> None:
        """Tells it of goals no longer."""
        self.listeners = tuple(each for each in self.listeners if each is not listener)

    def submit(self, goal: Any, *, identity: str = "", stamp_ns: int | None = None) -> Goal | None:
        """Hands a goal in; None where one of that name is known.

        Args:
            goal: The message, ``…_Goal``.
            identity: Its name; one is made where it has none.
            stamp_ns: When it was made, simulation time; now where it is not said.
        """
        now = self.time_ns()
        self._forget(now)
        identity = identity or f"{self.node}-{next(self._numbers)}-{now / 1e9:.9f}"
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
        """Calls goals off: that of a name and all made until a time; all where neither is said.

        Returns:
            Those that were under way.
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

    def restart(self) -> None:
        """Time began anew: goals that are done were never there."""
        self._goals = {key: goal for key, goal in self._goals.items() if not goal.done}

    def _tell(self, goal: Goal) -> None:
        for listener in self.listeners:
            listener.goal_changed(goal)

    def _forget(self, now: int) -> None:
        done = [goal for goal in self._goals.values() if goal.done]
        for goal in self._late(done, now):
            del self._goals[goal.id]
        # Clients may send any number of goals within the time for which one is kept.
        kept = [goal for goal in done if goal.id in self._goals]
        for goal in kept[: max(0, len(self._goals) - _MOST + 1)]:
            del self._goals[goal.id]

    @staticmethod
    def _late(done: list[Goal], now: int) -> Iterable[Goal]:
        done.sort(key=lambda goal: goal.done_ns)
        return [goal for goal in done[:-_KEPT] if now - goal.done_ns > _KEPT_NS]
