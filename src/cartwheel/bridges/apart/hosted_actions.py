"""Access to a graph's actions for a bridge in a different process."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from cartwheel.bridges.apart.link import Link
from cartwheel.bridges.apart.offers import Offer, Offers
from cartwheel.bridges.apart.remote_action import GoalNews, news_of
from cartwheel.calls import answered
from cartwheel.codes.graph import ACTION_GONE
from cartwheel.errors import GraphError
from cartwheel.graph import Action, Goal, Graph
from cartwheel.messages import decode_cdr, encode_cdr


class HostedActions:
    """Performs the requests of `RemoteAction`.

    Args:
        link: Link to the bridge's process.
        graph: Graph with the actions.
        time_ns: Returns the simulation time.
    """

    def __init__(self, link: Link, graph: Graph, time_ns: Callable[[], int]) -> None:
        self._link = link
        self._graph = graph
        self._time_ns = time_ns
        self._offers: Offers[Action] = Offers()
        self._tellers: dict[int, _Teller] = {}

    def update(self) -> tuple[Offer, ...]:
        """Updates and returns all actions by name. Called on the link's thread, like `do`."""
        found = self._offers.update(self._graph.actions())
        self._tellers = {
            one.number: self._tellers.get(one.number)
            or _Teller(self._link, one.number, self._time_ns)
            for one in found
        }
        return found

    def close(self) -> None:
        """Stops reporting goals. Callable on any thread."""
        known = self._offers.known
        for number, teller in self._tellers.items():
            # An action that has ended, or is not registered yet, has no listener.
            if number in known:
                action = known[number]
                self._graph.post(lambda action=action, teller=teller: action.leave(teller))  # type: ignore[misc]

    def do(self, number: int, what: str, *arguments: Any) -> Future[Any] | None:
        """Calls a method of an action on the graph owner's thread."""
        if number in self._tellers:
            action, teller = self._offers.known[number], self._tellers[number]
            function = getattr(self, f"_{what}")
            return answered(self._graph.post, lambda: function(action, teller, *arguments))
        if what in ("listen", "want_feedback"):
            return None
        raise GraphError("the action no longer exists", code=ACTION_GONE)

    # -- on the owner's thread

    @staticmethod
    def _listen(action: Action, teller: _Teller, wanted: bool) -> None:
        action.leave(teller)
        if wanted:
            action.listen(teller)

    @staticmethod
    def _want_feedback(_: Action, teller: _Teller, wanted: bool) -> None:
        teller.wants_feedback = wanted

    def _goals(self, action: Action, _: _Teller) -> list[GoalNews]:
        return [news_of(goal, self._time_ns()) for goal in action.goals]

    def _goal(self, action: Action, _: _Teller, identity: str) -> GoalNews | None:
        goal = action.goal(identity)
        return None if goal is None else news_of(goal, self._time_ns())

    def _submit(self, action: Action, _: _Teller, data: bytes, identity: str) -> GoalNews | None:
        goal = action.submit(decode_cdr(data, f"{action.type}_Goal"), identity=identity)
        return None if goal is None else news_of(goal, self._time_ns())

    def _cancel(self, action: Action, _: _Teller, identity: str, before_ns: int) -> list[GoalNews]:
        meant = action.cancel(identity=identity, before_ns=before_ns)
        return [news_of(goal, self._time_ns()) for goal in meant]


class _Teller:
    """Sends the goals of an action to the bridge; an `ActionListener`."""

    def __init__(self, link: Link, number: int, time_ns: Callable[[], int]) -> None:
        self._link = link
        self._number = number
        self._time_ns = time_ns
        self.wants_feedback = False

    def goal_changed(self, goal: Goal) -> None:
        """See `ActionListener`."""
        self._link.notify("goal", self._number, news_of(goal, self._time_ns()), None)

    def goal_goes_on(self, goal: Goal, feedback: Any) -> None:
        """See `ActionListener`."""
        if self.wants_feedback:
            news = news_of(goal, self._time_ns())
            self._link.notify_in_time("goal", self._number, news, encode_cdr(feedback))
