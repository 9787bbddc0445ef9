"""Parameters of a node: six standard ROS 2 services, and ``/parameter_events``."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from cartwheel.bridges.mirror import Closable
from cartwheel.bridges.ros2.middleware import Middleware, Outlet, publisher
from cartwheel.codes.wires import PARAMETER_REFUSED
from cartwheel.errors import CartwheelError
from cartwheel.messages import encode_cdr, message_class, stamp, zero
from cartwheel.messages.ros2.parameter_services import ParameterHandlers
from cartwheel.messages.ros2.parameters import FIELDS, parameter_type, parameter_value

Value = bool | int | float | str
Offer = Callable[[str, str, Callable[[Any], Any]], Closable]
"""Offers a service: name, type, handler."""

EVENTS, EVENT = "/parameter_events", "rcl_interfaces/msg/ParameterEvent"
_NAMES = {1: "bool", 2: "integer", 3: "double", 4: "string"}
_SETTLING = 50
"""Maximum number of checks until a new value takes effect, as the simulation may be busy."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Parameter:
    """A parameter. `get` and `set` are called on the bridge's thread and must not wait."""

    name: str
    description: str
    get: Callable[[], Value]
    set: Callable[[Any], None] | None = None
    """Sets a value, or raises a CartwheelError if it is invalid. None means read-only."""


class NodeParameters(ParameterHandlers):
    """Offers the parameters of a node.

    Args:
        node: Full name of the node, with namespace.
        parameters: All parameters.
        time_ns: Returns the simulation time, for events.
    """

    def __init__(
        self, node: str, parameters: Iterable[Parameter], *, time_ns: Callable[[], int]
    ) -> None:
        self._node = node
        self._time_ns = time_ns
        self._parameters = {one.name: one for one in parameters}
        self._events: Outlet | None = None
        self._published: dict[str, Value] = {}
        """Values by name, as last published."""
        self._settling: dict[str, int] = {}
        """Remaining checks until a new value must have taken effect."""

    def begin(self, middleware: Middleware, offer: Offer) -> None:
        """Offers the services and the topic. Call it on the loop's thread."""
        self._published = {name: one.get() for name, one in self._parameters.items()}
        self._events = middleware.publish(publisher(EVENTS, EVENT))
        self.offer(self._node, offer)

    def look(self) -> None:
        """Publishes changes since the last check. Call it on the loop's thread."""
        changed = []
        for name, one in self._parameters.items():
            value = one.get()
            left = self._settling.pop(name, 0)
            if value == self._published[name]:
                continue
            if left:
                self._settling[name] = left - 1
                continue
            self._published[name] = value
            changed.append(
                message_class("rcl_interfaces/msg/Parameter")(
                    name=name, value=parameter_value(value)
                )
            )
        if changed:
            self._publish(changed)

    def names(self) -> Iterable[str]:
        return self._parameters

    def value(self, name: str) -> Any:
        known = self._parameters.get(name)
        return parameter_value(None if known is None else known.get())

    def describe(self, descriptor: Any) -> None:
        known = self._parameters.get(descriptor.name)
        if known is not None:
            descriptor.description = known.description
            descriptor.read_only = known.set is None

    def change(self, given: Sequence[Any]) -> str:
        undo: list[tuple[Parameter, Value]] = []
        try:
            checked = [self._checked(each) for each in given]
            for known, value in checked:
                before = known.get()
                assert known.set is not None
                known.set(value)
                undo.append((known, before))
        except CartwheelError as error:
            for known, before in reversed(undo):
                assert known.set is not None
                known.set(before)
            return error.message
        for known, value in checked:
            self._published[known.name], self._settling[known.name] = value, _SETTLING
        self._publish(given)
        return ""

    def _checked(self, given: Any) -> tuple[Parameter, Value]:
        known = self._parameters.get(given.name)
        if known is None:
            raise _refused(given.name, "has not been declared")
        if known.set is None:
            raise _refused(given.name, "is read-only")
        wanted, found = parameter_type(known.get()), int(given.value.type)
        if found == wanted:
            return known, getattr(given.value, FIELDS[found])
        if (wanted, found) == (3, 2):
            # ``ros2 param set`` sends 2 as an integer.
            return known, float(given.value.integer_value)
        raise _refused(given.name, f"must be of type {_NAMES[wanted]}", type=_NAMES[wanted])

    def _publish(self, changed: Sequence[Any]) -> None:
        if self._events is None:
            return
        event = zero(EVENT)
        event.stamp = stamp(self._time_ns())
        event.node = self._node
        event.changed_parameters = list(changed)
        self._events.send(encode_cdr(event))


def _refused(parameter: str, why: str, **values: str) -> CartwheelError:
    return CartwheelError(
        f'parameter "{parameter}" {why}',
        code=PARAMETER_REFUSED,
        values={"parameter": parameter, **values},
    )
