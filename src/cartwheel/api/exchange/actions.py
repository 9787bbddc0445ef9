"""Actions that a program offers."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, overload

from cartwheel.api.arguments import refused, text
from cartwheel.api.handles import Sealed
from cartwheel.api.messaging import MessagingWorld
from cartwheel.graph import Action, ActionTopics, made_message
from cartwheel.graph import Goal as GraphGoal
from cartwheel.graph.action import GoalState
from cartwheel.graph.actionlib import STATUS_RATE
from cartwheel.messages import message_class, zero
from cartwheel.messages.store import finding_with
from cartwheel.messages.typed import Kind, M, name_of

if TYPE_CHECKING:
    from cartwheel.session import Session

_NODE = "World.serve_action"


class ActionServingWorld(MessagingWorld):
    """The part of `World` that offers actions."""

    @overload
    def serve_action(
        self,
        name: str,
        type: type[M],
        on_goal: Callable[[ReceivedGoal[M]], object],
        *,
        on_cancel: Callable[[ReceivedGoal[M]], object] | None = None,
    ) -> ActionServer: ...
    @overload
    def serve_action(
        self,
        name: str,
        type: str,
        on_goal: Callable[[ReceivedGoal[Any]], object],
        *,
        on_cancel: Callable[[ReceivedGoal[Any]], object] | None = None,
    ) -> ActionServer: ...
    def serve_action(
        self,
        name: str,
        type: Kind,
        on_goal: Callable[[ReceivedGoal[Any]], object],
        *,
        on_cancel: Callable[[ReceivedGoal[Any]], object] | None = None,
    ) -> ActionServer:
        """Offers an action, also to ROS and other connections.

        Goals of other programs arrive between two steps of `run`. An exception in one of the
        functions aborts the goal, and `run` raises it after the step.

        Args:
            name: Action name.
            type: A name such as ``nav2_msgs/action/NavigateToPose``, also of a type that a package
                of the workspace defines, or the class of the goals, such as
                ``FollowJointTrajectory_Goal``.
            on_goal: Receives each goal, and ends it now or later, for example in an action of
                `World.on`. Unless it rejects the goal, the goal is active afterwards.
            on_cancel: Receives a goal that a client cancels, and ends it now or later. None:
                `ReceivedGoal.cancel` without a result.

        Returns:
            The action, whose `close` withdraws it.

        Raises:
            UnknownNameError: The type does not exist.
            SimulationError: The world is closed.
            GraphError: The name is already in use or invalid, or the definition of the type is
                invalid.
        """
        self._check_open()
        text(name, "name")
        for each, given in (("on_goal", on_goal), ("on_cancel", on_cancel or on_goal)):
            if not callable(given):
                raise refused(each, "a function", given)
        kind = name_of(type).removesuffix("_Goal")
        self.session.types.named(kind)
        with self._used(), finding_with(self.session.types):
            message_class(f"{kind}_Goal")
            return ActionServer(self.session, name, kind, on_goal, on_cancel or _cancel)


class ReceivedGoal(Generic[M]):
    """A goal of an action that a program offers with `World.serve_action`."""

    def __init__(self, action: Action, goal: GraphGoal) -> None:
        self._action, self._received = action, goal
        self.goal: M = goal.goal
        """The goal message."""

    def __repr__(self) -> str:
        return f"<ReceivedGoal of {self._action.name}, {self._received.state.name.lower()}>"

    @property
    def done(self) -> bool:
        """Whether the goal has ended, in any state."""
        return self._received.done

    def feedback(self, message: Any = None, **fields: Any) -> None:
        """Sends feedback; see `World.publish` for the arguments. Does nothing after the end."""
        made = self._made("Feedback", message, fields)
        if not self.done:
            self._accept()
            self._received.feedback(made)

    def succeed(self, result: Any = None, text: str = "", **fields: Any) -> None:
        """Ends the goal as succeeded.

        Args:
            result: The result message, or a mapping of its fields. Omitted fields have their
                defaults.
            text: Explanation for the client, in ROS 1.
            fields: The fields instead of `result`; see `World.publish`.

        Raises:
            GraphError: The result does not have a field, or a value does not fit.
        """
        self._end(GraphGoal.succeed, result, text, fields)

    def abort(self, result: Any = None, text: str = "", **fields: Any) -> None:
        """Ends the goal as aborted; see `succeed`."""
        self._end(GraphGoal.abort, result, text, fields)

    def cancel(self, result: Any = None, text: str = "", **fields: Any) -> None:
        """Ends the goal as cancelled; see `succeed`."""
        self._end(GraphGoal.cancel, result, text, fields)

    def reject(self, text: str = "") -> None:
        """Rejects the goal. Only `on_goal` can reject it; later, it is aborted."""
        if self._received.state is GoalState.PENDING:
            self._received.reject(zero(f"{self._action.type}_Result"), text)
        else:
            self.abort(text=text)

    def _accept(self) -> None:
        if self._received.state is GoalState.PENDING:
            self._received.accept()

    def _end(
        self,
        end: Callable[[GraphGoal, Any, str], None],
        result: Any,
        text: str,
        fields: dict[str, Any],
    ) -> None:
        made = self._made("Result", result, fields)
        if not self.done:
            self._accept()
            end(self._received, made, text)

    def _made(self, part: str, message: Any, fields: dict[str, Any]) -> Any:
        return made_message(self._action.name, f"{self._action.type}_{part}", message, fields)


def _cancel(goal: ReceivedGoal[Any]) -> None:
    goal.cancel()


class ActionServer(Sealed):
    """An action that a program offers. `World.serve_action` returns it.

    Args:
        session: The session.
        name: Action name.
        kind: ``pkg/action/Name``.
        on_goal: Receives each goal.
        on_cancel: Receives a goal that a client cancels.
    """

    __slots__ = ("_action", "_functions", "_goals", "_session", "_task", "_topics")

    def __init__(
        self,
        session: Session,
        name: str,
        kind: str,
        on_goal: Callable[[ReceivedGoal[Any]], object],
        on_cancel: Callable[[ReceivedGoal[Any]], object],
    ) -> None:
        simulation = session.simulation
        engine = simulation.engine
        self._session: Session | None = session
        self._functions = on_goal, on_cancel
        self._goals: dict[str, ReceivedGoal[Any]] = {}
        self._action = Action(
            session.graph, name, kind, node=_NODE, time_ns=lambda: engine.time_ns,
            on_goal=self._receive, on_cancel=self._cancel,
        )  # fmt: skip
        try:
            # ROS 1 clients find the server by its status.
            self._topics = ActionTopics(session.graph, self._action)
        except BaseException:
            self._action.close()
            raise
        self._task = simulation.schedule(STATUS_RATE, after=self._topics.publish_status)
        simulation.on_reset.append(self._reset)

    def __repr__(self) -> str:
        return f"<ActionServer {self.name} {self.type}>"

    @property
    def name(self) -> str:
        """Name of the action."""
        return self._action.name

    @property
    def type(self) -> str:
        """Type of the action, such as ``nav2_msgs/action/NavigateToPose``."""
        return self._action.type

    def close(self) -> None:
        """Aborts all goals, and withdraws the action. Further calls have no effect."""
        session, self._session = self._session, None
        if session is None or session.simulation.closed:
            return
        self._abort("the action was withdrawn")
        session.simulation.on_reset.remove(self._reset)
        session.simulation.unschedule(self._task)
        self._topics.close()
        self._action.close()

    def _receive(self, goal: GraphGoal) -> None:
        received = self._goals[goal.id] = ReceivedGoal[Any](self._action, goal)
        self._call(self._functions[0], received)
        received._accept()
        self._forget()

    def _cancel(self, goal: GraphGoal) -> None:
        if goal.id in self._goals:
            self._call(self._functions[1], self._goals[goal.id])
            self._forget()

    def _call(
        self, function: Callable[[ReceivedGoal[Any]], object], goal: ReceivedGoal[Any]
    ) -> None:
        assert self._session is not None
        try:
            with finding_with(self._session.types):
                function(goal)
        except BaseException as error:  # noqa: BLE001 - raised by `run`
            goal.abort(text=f"{type(error).__name__}: {error}")
            self._session.simulation.faults.defer(error)

    def _reset(self) -> None:
        self._abort("the world was reset")
        self._action.restart()

    def _abort(self, why: str) -> None:
        for goal in list(self._goals.values()):
            goal.abort(text=why)
        self._goals.clear()

    def _forget(self) -> None:
        self._goals = {name: goal for name, goal in self._goals.items() if not goal.done}
