"""The base class of devices, plugins and controllers."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Protocol, TypeVar

from cartwheel.codes import running
from cartwheel.component.scope import Scope, Shared
from cartwheel.errors import Code, GraphError, Origin, Severity, Value
from cartwheel.graph import (
    Graph,
    JointInput,
    Publisher,
    Qos,
    ReconfigureParameter,
    ReconfigureServer,
    checked_handler,
)
from cartwheel.graph.reconfigure import OnChange
from cartwheel.graph.reconfigure import Value as Parameter
from cartwheel.messages import service_classes
from cartwheel.messages.limits import unfit
from cartwheel.messages.typed import Kind, name_of
from cartwheel.simulation import LinkHandle
from cartwheel.simulation.limits import STRONGEST, number


class Closable(Protocol):
    """A resource that a component holds while it is loaded."""

    def close(self) -> None:
        """Releases the resource."""


def is_connection(item: object) -> bool:
    """Whether an item is a connection to another program, which a saved state does not contain."""
    return bool(getattr(type(item), "is_connection", False))


K = TypeVar("K", bound=Closable)
D = TypeVar("D", bound="Component")


class Component:
    """Base class of devices, plugins and controllers.

    Everything that a component advertises, subscribes to, serves or keeps is closed with it.

    Args:
        scope: The component's model and names.
    """

    _unsaved = frozenset({"_items"})
    """Attributes that a saved state does not contain."""

    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self.part = scope.part
        """The model's part of the simulation."""
        self._open = contextlib.ExitStack()
        if scope.holder is None:
            scope.holder = self
        else:
            scope.holder._open.callback(self._open.close)
        self._devices: list[Component] = []
        self._items: list[object] = []
        """What the component registered with the graph or keeps open."""
        self.publishers: list[Publisher] = []
        """The component's own topics, without those of its devices."""
        self._crowded = False

    @property
    def graph(self) -> Graph:
        """The graph on which the component publishes."""
        return self.scope.shared.graph

    @property
    def shared(self) -> Shared:
        """The objects that all components of the simulation share."""
        return self.scope.shared

    @property
    def node(self) -> str:
        """Node name for listings."""
        return self.scope.node

    @property
    def title(self) -> str:
        """Name of the component and its model in messages."""
        return self.scope.title

    @property
    def origin(self) -> Origin | None:
        """File and line at which the component is described."""
        return self.scope.origin

    def reset(self) -> None:
        """Restores the initial state when simulation time is reset to zero."""
        for device in self._devices:
            device.reset()

    def close(self) -> None:
        """Withdraws all topics and services, when the model is deleted."""
        self._open.close()

    def drop_references(self) -> None:
        """After `close`: clears the references of this component and its devices, which may form
        cycles.
        """
        for device in self._devices:
            device.drop_references()
        vars(self).clear()

    def keep(self, item: K) -> K:
        """Registers an item that is closed with the component, and returns it."""
        self._items.append(item)
        self._open.callback(item.close)
        return item

    def add(self, device: D) -> D:
        """Registers a device that is reset and closed with the component, and returns it."""
        self._devices.append(device)
        self._open.callback(device.close)
        return device

    @property
    def items(self) -> tuple[object, ...]:
        """The component's publishers, subscriptions, services and other things that it keeps.

        Connections to other programs are excluded.
        """
        return tuple(each for each in self._items if not is_connection(each))

    def components(self) -> Iterable[Component]:
        """The devices of the component, and what else is saved as a component of its own."""
        return tuple(self._devices)

    def structure(self) -> Any:
        """What `rebuild` needs to create components that were added at run time."""
        return None

    def rebuild(self, structure: Any) -> None:
        """Adds and closes components, so that they are those of a saved `structure`."""

    def resolve(self, name: str) -> str:
        """Returns a topic or service name in the component's namespace, after remapping."""
        return self.scope.resolve(name)

    def frame(self, name: str) -> str:
        """Returns a frame ID with the robot's prefix."""
        return self.scope.frame(name)

    def advertise(
        self, topic: str, type_name: Kind, *, rate: float | None = None, qos: Qos = "default"
    ) -> Publisher:
        """Advertises a topic. The publisher is closed with the component.

        Args:
            topic: Name, resolved in the component's scope.
            type_name: Message type: ``pkg/msg/Name``, or a class of `cartwheel.msgs`.
            rate: Publish rate for listings, Hz.
            qos: Quality of service on ROS 2.
        """
        kind = self._named(type_name)
        name = self.scope.published(topic, kind)
        publisher = self.graph.advertise(
            name, kind, node=self.node, rate=rate, qos=qos, checked=self._foreign
        )
        self.publishers.append(publisher)
        if not self.scope.common:
            self.part.published.add(publisher.topic)
        return self.keep(publisher)

    def subscribe(
        self, topic: str, type_name: Kind, callback: Callable[[Any], None], *, unset: bool = False
    ) -> None:
        """Subscribes to a topic. The subscription is closed with the component.

        Messages with numbers that cannot be simulated are ignored, with a warning for the first.

        Args:
            topic: Name, resolved in the component's scope.
            type_name: As for `advertise`.
            callback: Receives each message, before the next step.
            unset: Accept NaN and infinity, which some commands use for values that are not set.
        """
        checked = self.checked(callback, unset=unset)
        name, kind, receiver = self.scope.subscribed(topic, self._named(type_name), checked)
        subscription = self.graph.subscribe(name, receiver, type_name=kind, node=self.node)
        if not self.scope.common:
            self.part.subscribed.add(subscription.topic)
        owner = self.scope.owner
        if owner is not None:
            subscription.on_error = lambda _, error: self.part.fail(owner, error)
        self.keep(subscription)

    def serve(
        self,
        name: str,
        type_name: str,
        handler: Callable[[Any], Any],
        *,
        threaded: bool = False,
    ) -> bool:
        """Offers a service, which is withdrawn with the component.

        If another component already offers the service, a warning is reported: two robots of the
        same kind can share topics, and a service must not prevent the second one from loading.

        Returns:
            Whether the service is offered.
        """
        self._named(type_name)
        if self._foreign:
            handler = checked_handler(name, service_classes(type_name)[1], handler)
        try:
            service = self.graph.serve(
                self.resolve(name), type_name, handler, node=self.node, threaded=threaded
            )
        except GraphError as error:
            if not self._crowded:
                # Components that share one name usually share several: one warning is enough.
                self._crowded = True
                self.warn(
                    running.SERVICE_TAKEN,
                    error.message,
                    hint="Give one of the two models a namespace.",
                    values={"name": self.resolve(name)},
                )
            return False
        self.part.services.add(service.name)
        self._items.append(service)
        self._open.callback(self.graph.withdraw, service)
        return True

    def message_class(self, type_name: str) -> Any:
        """Returns the class of a message type, which a package of the workspace may define.

        Args:
            type_name: ``pkg/msg/Name``.

        Raises:
            UnknownNameError: The type does not exist.
            GraphError: The definition of the type is invalid.
        """
        return self.graph.types.message_class(type_name)

    def _named(self, kind: Kind) -> str:
        """The name of a type, which is also looked for in packages that Cartwheel contains.

        Cartwheel's own components use only its own types, for which no files are searched.
        """
        name = name_of(kind)
        if self._foreign:
            self.graph.types.named(name)
        return name

    @property
    def _foreign(self) -> bool:
        """Whether the component is defined in a different package."""
        return not type(self).__module__.startswith("cartwheel.")

    def take_positions(
        self, joints: Sequence[str], put: Callable[[Mapping[str, float], float], None]
    ) -> None:
        """Accepts manual joint positions while the component is loaded; see `JointInput`."""
        inputs = self.graph.joint_inputs
        joint_input = self.joint_input(joints, put)
        inputs.add(joint_input)
        self._items.append(joint_input)
        self._open.callback(inputs.remove, joint_input)

    def joint_input(
        self, joints: Sequence[str], put: Callable[[Mapping[str, float], float], None]
    ) -> JointInput:
        """Creates an input for manual joint positions.

        Positions that cannot be simulated raise a `CartwheelError` in the caller.

        Args:
            joints: Names of the joints.
            put: Receives positions in rad or m by joint, and the duration of the motion in s.
        """

        def checked(wanted: Mapping[str, float], seconds: float) -> None:
            for joint, position in wanted.items():
                number(position, f'the position of joint "{joint}"')
            number(seconds, "the duration in s")
            self.part.count_command()
            put(wanted, seconds)

        return JointInput(
            model=self.part.name,
            owner=self.scope.input_name or self.node,
            joints=tuple(joints),
            put=checked,
        )

    def reconfigure(
        self,
        name: str,
        parameters: tuple[ReconfigureParameter, ...],
        on_change: OnChange,
        *,
        initial: Mapping[str, Parameter] | None = None,
        preset: bool = False,
    ) -> ReconfigureServer | None:
        """Offers parameters that can be changed at run time, as a `ReconfigureServer`.

        Returns None, with a warning, if another server already offers them or a preset value is not
        allowed.
        """
        full = self.resolve(name)
        try:
            server = ReconfigureServer(
                self.graph,
                full,
                parameters,
                on_change,
                node=self.node,
                initial=initial,
                preset=preset,
            )
        except GraphError as error:
            self.warn(
                running.RECONFIGURE_UNAVAILABLE,
                f"{error.message}, so {full} cannot be reconfigured",
                hint=error.hint or "",
                values={"name": full},
            )
            return None
        self.part.services.add(server.service)
        return self.keep(server)

    def warn(
        self,
        code: Code,
        message: str,
        *,
        at: Origin | None = None,
        hint: str = "",
        values: Mapping[str, Value] | None = None,
        severity: Severity = "warning",
    ) -> None:
        """Reports a diagnostic about this component.

        Args:
            code: Kind of the diagnostic. Other packages define their own: ``Code("ACME1", …)``.
            message: One sentence.
            at: File and line of the element in question; defaults to the component's own.
            hint: The likely fix, as a sentence.
            values: Names and numbers in the message, for programs.
            severity: Defaults to a warning, regardless of the code's severity.
        """
        self.part.report(
            code.diagnostic(
                message,
                origin=at or self.origin,
                hint=hint,
                values=values,
                severity=severity,
            )
        )

    def place_of(self, parameter: str) -> Origin | None:
        """Returns the file and line of a parameter; the component's own if it is not stated."""
        return self.scope.place_of(parameter)

    def link_or_root(self, name: str) -> LinkHandle:
        """Returns the link with this name, which must exist; the root link if it is empty."""
        return self.part.link(name or self.part.description.canonical_link)

    def checked(self, callback: Callable[[Any], None], *, unset: bool) -> Callable[[Any], None]:
        """Wraps a callback so that it only receives commands that can be simulated.

        Other commands are ignored. Only the first of them causes a warning.

        Args:
            callback: Receives the valid messages.
            unset: Accept NaN and infinity, which some commands use for values that are not set.
        """
        warned = False

        def checked(message: Any) -> None:
            nonlocal warned
            reason = unfit(message, most=STRONGEST, unset=unset)
            if not reason:
                self.part.count_command()
                callback(message)
            elif not warned:
                warned = True
                self.warn(
                    running.COMMAND_NOT_SIMULATED,
                    f"a command is ignored because {reason} cannot be simulated "
                    "(further invalid commands on this topic are ignored without a warning)",
                )

        return checked
