"""Services and actions of a world."""

from __future__ import annotations

import threading
import time
import weakref
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any, Literal, overload

from cartwheel.api.arguments import refused, text
from cartwheel.api.exchange.actions import ActionServingWorld
from cartwheel.api.exchange.serving import ProgramHandler, ServiceServer
from cartwheel.api.timing import TIMEOUT, timed_out
from cartwheel.codes.graph import MESSAGE_TYPE_UNKNOWN, SERVICE_TIMED_OUT
from cartwheel.codes.world import RUN_NESTED
from cartwheel.errors import GraphError, SimulationError, UnknownNameError
from cartwheel.graph import Action, Service, made_message
from cartwheel.graph import Goal as GraphGoal
from cartwheel.messages import service_classes
from cartwheel.messages.store import finding_with, service_name
from cartwheel.messages.typed import Kind, M, name_of
from cartwheel.simulation import Simulation
from cartwheel.simulation.clock import NANOSECONDS
from cartwheel.simulation.limits import duration_ns

if TYPE_CHECKING:
    from cartwheel.assembly.ros1 import Ros1Connection
    from cartwheel.gazebo import GazeboApi

_GAZEBO = "/gazebo/"
_LOOK = 0.02
"""Wall time between two checks whether a service has responded, s."""

Status = Literal["pending", "active", "succeeded", "cancelled", "aborted", "rejected"]


class CallingWorld(ActionServingWorld):
    """The part of `World` that calls services and sends goals to actions."""

    _gazebo: GazeboApi | None = None

    @property
    def services(self) -> tuple[str, ...]:
        """Names of the services, sorted."""
        return tuple(service.name for service in self.graph.services())

    @property
    def actions(self) -> tuple[str, ...]:
        """Names of the actions, sorted."""
        return tuple(action.name for action in self.graph.actions())

    def call(
        self, service: str, request: Any = None, *, timeout: float = TIMEOUT, **fields: Any
    ) -> Any:
        """Calls a service, and returns its response.

        Services respond at once, so no simulation time passes.

        Args:
            service: Service name.
            request: A request, or a mapping of its fields. Omitted fields have their defaults.
            timeout: Maximum wall time for a service that does slow work, such as reading a file, s.
            fields: The fields instead of `request`; see `publish`.

        Raises:
            UnknownNameError: The service does not exist.
            TimedOutError: The service does not respond in time.
            CartwheelError: The service refuses the request, or `timeout` is out of range.
            GraphError: The request type does not have a given field.
            SimulationError: The world is closed.
        """
        self._check_open()
        limit = duration_ns(timeout, "the timeout in s") / NANOSECONDS
        try:
            offered = self.graph.service(text(service, "service"))
        except UnknownNameError as error:
            if service.startswith(_GAZEBO) and not self._offers_gazebo:
                error.hint = "Call serve_gazebo first, which provides Gazebo's services."
            raise
        kind = service_classes(offered.type)[0].__msgtype__
        made = made_message(service, kind, request, fields)
        with self._used(change=True) as simulation, finding_with(self.session.types):
            inside = self.lock.runner == threading.get_ident()
            if not inside:
                simulation.drain_queued()
            if not offered.threaded:
                handler = offered.handler
                if isinstance(handler, ProgramHandler):
                    return handler.respond(made)
                return _checked(offered, handler(made))
            if inside:
                raise SimulationError(
                    f'a callback calls the service "{service}", which requires the world to wait',
                    code=RUN_NESTED,
                    hint="Call the service outside of callbacks.",
                    values={"service": service},
                )
            return self._await(simulation, offered, made, limit)

    def _await(self, simulation: Simulation, service: Service, request: Any, seconds: float) -> Any:
        """Calls a service on a thread, and meanwhile runs the functions that it posts."""
        future: Future[Any] = Future()

        def work() -> None:
            try:
                future.set_result(service.handler(request))
            except BaseException as error:  # noqa: BLE001 - raised by `call`
                future.set_exception(error)

        threading.Thread(target=work, name=f"call {service.name}", daemon=True).start()
        end = time.monotonic() + seconds
        while not future.done():
            simulation.wait(_LOOK)
            if time.monotonic() > end and not future.done():
                raise timed_out(
                    f'the service "{service.name}" did not respond within {seconds:g} s',
                    {"service": service.name, "timeout": seconds},
                )
        simulation.drain_queued()
        return _checked(service, future.result())

    @overload
    def serve(self, name: str, type: type[M], handler: Callable[[M], object]) -> ServiceServer: ...
    @overload
    def serve(self, name: str, type: str, handler: Callable[[Any], object]) -> ServiceServer: ...
    def serve(self, name: str, type: Kind, handler: Callable[[Any], object]) -> ServiceServer:
        """Offers a service, also to ROS and other connections.

        Calls of other programs are handled between two steps of `run`. If the handler raises an
        exception there, the caller gets an error, and `run` raises the exception after the current
        step. An exception in a `call` of the same program is raised by `call`.

        Args:
            name: Service name.
            type: A name such as ``std_srvs/srv/SetBool``, also of a type that a package of the
                workspace defines, or the class of the requests, such as ``SetBool_Request``.
            handler: Receives a request, and returns a response or a mapping of its fields. Omitted
                fields have their defaults. It may return None if the response has no fields.

        Returns:
            The service, whose `close` withdraws it.

        Raises:
            UnknownNameError: The type does not exist.
            SimulationError: The world is closed.
            GraphError: The name is already in use or invalid, the definition of the type is
                invalid, or it is the type of an action.
        """
        self._check_open()
        text(name, "name")
        if not callable(handler):
            raise refused("handler", "a function", handler)
        kind = service_name(name_of(type).removesuffix("_Request"))
        if "/action/" in kind:
            raise GraphError(
                f"{kind} is the type of an action, not of a service",
                code=MESSAGE_TYPE_UNKNOWN,
                hint="World.serve_action offers actions.",
                values={"kind": "service type", "name": kind, "meant": ""},
            )
        types, faults = self.session.types, self.session.simulation.faults
        types.named(kind)
        with finding_with(types):
            made = ProgramHandler(name, kind, handler, types, faults.defer)
        service = self.graph.serve(name, kind, made, node="World.serve")
        return ServiceServer(self.graph, service)

    def serve_gazebo(self) -> None:
        """Provides the services and topics of Gazebo, such as ``/gazebo/set_model_state``.

        They are those of ROS 1, and a connection to ROS 1 provides them without this call. After
        ``/gazebo/pause_physics``, `run` waits for ``/gazebo/unpause_physics``.

        Raises:
            SimulationError: The world is closed.
        """
        from cartwheel.gazebo import GazeboApi

        with self._used():
            if not self._offers_gazebo:
                self._gazebo = GazeboApi(self.session)
                self._gazebo.start()

    def connect_ros1(self, node: str = "gazebo", arguments: Sequence[str] = ()) -> Ros1Connection:
        with self._used():
            # The connection provides the same services.
            self._withdraw_gazebo()
            return super().connect_ros1(node, arguments)

    @property
    def _offers_gazebo(self) -> bool:
        return any(name.startswith(_GAZEBO) for name in self.services)

    def _withdraw_gazebo(self) -> None:
        if self._gazebo is not None:
            self._gazebo.close()
            self._gazebo = None

    def _end(self) -> None:
        self._withdraw_gazebo()
        super()._end()

    def send_goal(self, action: str, goal: Any = None, **fields: Any) -> Goal:
        """Sends a goal to an action, such as a trajectory of a controller.

        Args:
            action: Action name.
            goal: A goal message, or a mapping of its fields. Omitted fields have their defaults.
            fields: The fields instead of `goal`; see `publish`. A duration can be given in s.

        Returns:
            The goal, whose `Goal.result` runs the world until it is reached.

        Raises:
            UnknownNameError: The action does not exist.
            GraphError: The goal type does not have a given field.
            SimulationError: The world is closed.
        """
        self._check_open()
        offered = self.graph.action(text(action, "action"))
        made = made_message(action, f"{offered.type}_Goal", goal, fields)
        with self._used(change=True) as simulation, finding_with(self.session.types):
            if self.lock.runner != threading.get_ident():
                simulation.drain_queued()
            return Goal(self, offered, made)


class Goal:
    """A goal of an action, sent by `World.send_goal`."""

    def __init__(self, world: CallingWorld, action: Action, goal: Any) -> None:
        self._world = world
        self._action = action
        self._ear = _Ear(self, action)
        action.listen(self._ear)
        submitted = action.submit(goal)
        assert submitted is not None  # the identifier is new
        self._ear.begin(submitted)

    def __repr__(self) -> str:
        return f"<Goal of {self._action.name}, {self.status}>"

    @property
    def status(self) -> Status:
        """``pending``, ``active``, ``succeeded``, ``cancelled``, ``aborted`` or ``rejected``."""
        names: dict[str, Status] = {
            "PENDING": "pending",
            "ACTIVE": "active",
            "SUCCEEDED": "succeeded",
            "CANCELLED": "cancelled",
            "ABORTED": "aborted",
            "REJECTED": "rejected",
        }
        return names[self._ear.sent.state.name]

    @property
    def done(self) -> bool:
        """Whether the goal has ended, in any state."""
        return self._ear.sent.done

    @property
    def text(self) -> str:
        """Explanation of the final state; may be empty."""
        return self._ear.sent.text

    @property
    def feedback(self) -> Any:
        """The newest feedback message; None if there is none."""
        return feedbacks[-1] if (feedbacks := self.feedbacks) else None

    @property
    def feedbacks(self) -> list[Any]:
        """All feedback messages, oldest first."""
        return list(self._ear.heard)

    def result(self, timeout: float = TIMEOUT) -> Any:
        """Runs the world until the goal has ended, and returns the result message.

        The result does not say whether the goal succeeded; see `status`.

        Args:
            timeout: Maximum simulation time, s.

        Raises:
            TimedOutError: The goal has not ended within the time, or `World.stop` was called.
            CartwheelError: `timeout` is out of range.
            SimulationError: See `World.run`.
        """
        __tracebackhide__ = True
        if not self.done:
            self._world._until(lambda: self.done, timeout=timeout)
        if not self.done:
            raise timed_out(
                f'the goal of "{self._action.name}" has not ended within {timeout:g} s; it is '
                f"{self.status}, with {len(self.feedbacks)} feedback messages",
                {
                    "action": self._action.name,
                    "timeout": timeout,
                    "status": self.status,
                    "feedbacks": len(self.feedbacks),
                },
            )
        return self._ear.sent.result

    def cancel(self) -> None:
        """Requests the cancellation of the goal. Does nothing if it has ended.

        Raises:
            SimulationError: The world is closed.
        """
        with self._world._used(change=True):
            if not self.done:
                self._action.cancel(identity=self._ear.sent.id)


class _Ear:
    """Listens to an action for a goal as long as the program has the goal.

    A goal that has ended is active again when a state of an earlier time is restored.
    """

    def __init__(self, goal: Goal, action: Action) -> None:
        self._action = action
        self._goal = weakref.ref(goal, self._leave)
        self._sent: GraphGoal | None = None
        self.heard: list[Any] = []
        """The feedback on the goal, oldest first."""
        self._early: list[tuple[GraphGoal, Any]] = []
        """Feedback on any goal before it was known which one was sent."""

    def begin(self, sent: GraphGoal) -> None:
        """Listens to this goal only."""
        self._sent = sent
        self.heard += [feedback for goal, feedback in self._early if goal is sent]
        self._early.clear()

    @property
    def sent(self) -> GraphGoal:
        """The goal. A state from another process or world, if restored, contains a copy of it."""
        assert self._sent is not None
        known = self._action.goal(self._sent.id)
        if known is not None and known is not self._sent and known.is_copy_of(self._sent):
            self._sent = known
        return self._sent

    @property
    def wants_feedback(self) -> bool:
        """Whether feedback is received, which the action asks."""
        return self._sent is None or not self.sent.done

    def goal_changed(self, goal: GraphGoal) -> None:
        """Called by the action when the state of one of its goals changes."""

    def goal_goes_on(self, goal: GraphGoal, feedback: Any) -> None:
        """Called by the action with feedback on one of its goals."""
        if self._sent is None:
            self._early.append((goal, feedback))
        elif goal is self.sent:
            self.heard.append(feedback)

    def _leave(self, _: object) -> None:
        self._action.leave(self)


def _checked(service: Service, response: Any) -> Any:
    if response is None:
        raise GraphError(
            f'service "{service.name}" returned no response',
            code=SERVICE_TIMED_OUT,
            values={"service": service.name},
        )
    return response
