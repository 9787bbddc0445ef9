"""Actions of a graph in a different process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from cartwheel.bridges.apart.link import Link
from cartwheel.bridges.apart.offers import Offer
from cartwheel.graph import Action, ActionListener, Goal, GoalState
from cartwheel.messages import decode_cdr, encode_cdr


@dataclass(frozen=True, kw_only=True, slots=True)
class GoalNews:
    """State of a goal for the other process."""

    id: str
    stamp_ns: int
    state: GoalState
    text: str
    result: bytes | None
    time_ns: int
    """Simulation time of this state."""


def news_of(goal: Goal, time_ns: int) -> GoalNews:
    """Current state of a goal."""
    return GoalNews(
        id=goal.id,
        stamp_ns=goal.stamp_ns,
        state=goal.state,
        text=goal.text,
        result=None if goal.result is None else encode_cdr(goal.result),
        time_ns=time_ns,
    )


class Clock(Protocol):
    """Source of simulation time."""

    time_ns: int
    """Latest known simulation time."""


class RemoteAction:
    """An action in the simulation; a `BridgedAction`. Its methods wait for the simulation.

    Args:
        link: Link to the simulation's process.
        known: Description of the action.
        clock: Simulation time.
    """

    def __init__(self, link: Link, known: Offer, clock: Clock) -> None:
        self._link = link
        self._number = known.number
        self._clock = clock
        self.name, self.type, self.node = known.name, known.type, known.node
        self._listener: ActionListener | None = None
        self._feedback = False

    def time_ns(self) -> int:
        """Latest known simulation time."""
        return self._clock.time_ns

    def listen(self, listener: ActionListener) -> None:
        """Sets the only listener, which is notified of all goals from now on."""
        self._listener = listener
        self._ask("listen", True)

    def leave(self, listener: ActionListener) -> None:
        """Removes the listener."""
        if self._listener is listener:
            self._listener = None
            self._link.notify("action", self._number, "listen", False)

    def tell_wants(self) -> None:
        """Requests feedback while a client receives it. Callable on any thread."""
        wanted = self._listener is not None and self._listener.wants_feedback
        if wanted != self._feedback:
            self._feedback = wanted
            self._link.notify("action", self._number, "want_feedback", wanted)

    @property
    def goals(self) -> list[Goal]:
        """See `Action.goals`."""
        return [self._goal(news) for news in self._ask("goals")]

    def goal(self, identity: str) -> Goal | None:
        """See `Action.goal`."""
        news = self._ask("goal", identity)
        return None if news is None else self._goal(news)

    def submit(self, goal: Any, *, identity: str = "") -> Goal | None:
        """See `Action.submit`."""
        news = self._ask("submit", encode_cdr(goal), identity)
        return None if news is None else self._goal(news)

    def cancel(self, *, identity: str = "", before_ns: int = 0) -> list[Goal]:
        """See `Action.cancel`."""
        return [self._goal(news) for news in self._ask("cancel", identity, before_ns)]

    def hear(self, news: GoalNews, feedback: bytes | None) -> None:
        """Passes a changed goal, or feedback on a goal, to the listener."""
        if self._listener is None:
            return
        goal = self._goal(news)
        if feedback is None:
            self._listener.goal_changed(goal)
        else:
            self._listener.goal_goes_on(goal, decode_cdr(feedback, f"{self.type}_Feedback"))

    def _goal(self, news: GoalNews) -> Goal:
        self._clock.time_ns = news.time_ns
        goal = Goal(_NOWHERE, news.id, news.stamp_ns, None)
        goal.state, goal.text = news.state, news.text
        if news.result is not None:
            goal.result = decode_cdr(news.result, f"{self.type}_Result")
        return goal

    def _ask(self, what: str, *arguments: Any) -> Any:
        return self._link.ask("action", self._number, what, *arguments)


_NOWHERE: Action = None  # type: ignore[assignment]
"""Placeholder for the action of these goals, which are read-only."""
