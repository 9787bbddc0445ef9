"""Parameters that change while a node runs, as in ROS 1's dynamic_reconfigure."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any, Literal

from cartwheel.codes.graph import PARAMETER_UNKNOWN, PARAMETER_VALUE_INVALID
from cartwheel.errors import GraphError, UnknownNameError
from cartwheel.graph.graph import Graph
from cartwheel.graph.topic import Publisher
from cartwheel.messages import message_class, service_classes

Value = bool | int | float | str
OnChange = Callable[[dict[str, Value]], "Mapping[str, Value] | None"]

_PACKAGE = "dynamic_reconfigure"
_LISTS: dict[str, tuple[str, type[Value]]] = {
    "bool": ("bools", bool),
    "int": ("ints", int),
    "str": ("strs", str),
    "double": ("doubles", float),
}
"""For each type: the field of a ``Config`` that contains it, and its Python class."""
_INT32 = 1 << 31


@dataclass(frozen=True, kw_only=True, slots=True)
class ReconfigureParameter:
    """A parameter that clients can change."""

    name: str
    type: Literal["bool", "int", "double", "str"]
    default: Value
    minimum: Value | None = None
    maximum: Value | None = None
    """Larger values are reduced to this maximum. None means no limit."""
    description: str = ""
    level: int = 0
    """Bit mask of what a change affects, for clients."""
    edit_method: str = ""
    """How clients edit the value; see `choices`."""


def choices(*values: str, description: str = "") -> str:
    """The `edit_method` for a string with a fixed set of values, which clients show as a list."""
    listed = [
        {"name": value, "type": "str", "value": value, "description": value} for value in values
    ]
    return str({"enum": listed, "enum_description": description})


class ReconfigureServer:
    """Serves ``<name>/set_parameters``, and publishes parameter descriptions and values.

    ``<name>/parameter_descriptions`` and ``<name>/parameter_updates`` are latched. The values
    are also set as parameters of the graph, ``<name>/<parameter>``. Call it on the owner's thread.
    Source: dynamic_reconfigure.

    Args:
        graph: Graph that offers the service and the topics.
        name: Global namespace: ``/camera1``.
        parameters: Parameters in listing order.
        on_change: Receives all values at each request, applies them, and may return corrected
            values. It rejects a request by raising a `CartwheelError`.
        node: Node that offers the service, for listings.
        initial: Initial values that differ from the defaults. They may exceed the bounds.
        preset: Whether values of the graph's parameters with these names take precedence, such as
            values from a launch file. `on_change` is not called for them; read `values`.

    Raises:
        GraphError: The service already exists.
    """

    def __init__(
        self,
        graph: Graph,
        name: str,
        parameters: tuple[ReconfigureParameter, ...],
        on_change: OnChange,
        *,
        node: str,
        initial: Mapping[str, Value] | None = None,
        preset: bool = False,
    ) -> None:
        self._graph = graph
        self._node = node
        self._name = name.rstrip("/")
        self._parameters = {parameter.name: parameter for parameter in parameters}
        self._on_change = on_change
        self._values = {parameter.name: parameter.default for parameter in parameters}
        for key, value in (initial or {}).items():
            self._values[key] = _LISTS[self._known(key).type][1](value)
        if preset:
            self._values |= self._preset()
        self._response = service_classes(f"{_PACKAGE}/srv/Reconfigure")[1]
        with ExitStack() as opened:
            service = graph.serve(
                f"{self._name}/set_parameters",
                f"{_PACKAGE}/srv/Reconfigure",
                self._serve,
                node=node,
            )
            opened.callback(graph.withdraw, service)
            self.service: str = service.name
            """Name of the service that sets the parameters."""
            self._descriptions = self._advertise("parameter_descriptions", "ConfigDescription")
            opened.callback(self._descriptions.close)
            self._updates = self._advertise("parameter_updates", "Config")
            opened.callback(self._updates.close)
            self._opened = opened.pop_all()
        self._descriptions.publish(self._description())
        self._publish()

    @property
    def values(self) -> dict[str, Value]:
        """Current values by name."""
        return dict(self._values)

    def update(self, values: Mapping[str, Value]) -> None:
        """Publishes values that changed by other means, without calling `on_change`.

        Raises:
            UnknownNameError: No parameter has this name.
            GraphError: A value has the wrong type.
        """
        self._values |= {key: _typed(self._known(key), value) for key, value in values.items()}
        self._publish()

    def close(self) -> None:
        """Removes the service and the topics from the graph."""
        self._opened.close()

    def _advertise(self, topic: str, kind: str) -> Publisher:
        return self._graph.advertise(
            f"{self._name}/{topic}", f"{_PACKAGE}/msg/{kind}", node=self._node, qos="latched"
        )

    def _serve(self, request: Any) -> Any:
        wanted = dict(self._values)
        for field, _ in _LISTS.values():
            for item in getattr(request.config, field):
                parameter = self._known(item.name)
                wanted[item.name] = _clamped(parameter, _typed(parameter, item.value))
        corrected = self._on_change(dict(wanted))
        for key, value in (corrected or {}).items():
            wanted[key] = _typed(self._known(key), value)
        self._values = wanted
        self._publish()
        return self._response(config=self._config(self._values))

    def _known(self, name: str) -> ReconfigureParameter:
        if name not in self._parameters:
            raise UnknownNameError(
                f"{self._name} parameter", name, self._parameters, code=PARAMETER_UNKNOWN
            )
        return self._parameters[name]

    def _preset(self) -> dict[str, Value]:
        found = {}
        for key, parameter in self._parameters.items():
            value = self._graph.parameters.get(f"{self._name}/{key}")
            if value is not None:
                found[key] = _clamped(parameter, _typed(parameter, value))
        return found

    def _publish(self) -> None:
        for key, value in self._values.items():
            self._graph.parameters.set(f"{self._name}/{key}", value)
        self._updates.publish(self._config(self._values))

    def _config(self, values: Mapping[str, Value]) -> Any:
        lists: dict[str, list[Any]] = {field: [] for field, _ in _LISTS.values()}
        for key, value in values.items():
            kind = self._parameters[key].type
            cls = message_class(f"{_PACKAGE}/msg/{kind.capitalize()}Parameter")
            lists[_LISTS[kind][0]].append(cls(name=key, value=value))
        state = message_class(f"{_PACKAGE}/msg/GroupState")
        return message_class(f"{_PACKAGE}/msg/Config")(
            **lists, groups=[state(name="Default", state=True)]
        )

    def _description(self) -> Any:
        one = message_class(f"{_PACKAGE}/msg/ParamDescription")
        described = [
            one(
                name=parameter.name,
                type=parameter.type,
                level=parameter.level,
                description=parameter.description,
                edit_method=parameter.edit_method,
            )
            for parameter in self._parameters.values()
        ]
        group = message_class(f"{_PACKAGE}/msg/Group")
        return message_class(f"{_PACKAGE}/msg/ConfigDescription")(
            groups=[group(name="Default", parameters=described)],
            max=self._config({p.name: _bound(p, upper=True) for p in self._parameters.values()}),
            min=self._config({p.name: _bound(p, upper=False) for p in self._parameters.values()}),
            dflt=self._config({p.name: p.default for p in self._parameters.values()}),
        )


def _bound(parameter: ReconfigureParameter, *, upper: bool) -> Value:
    """Bound in a parameter's description: the range of its type if no bound is specified."""
    stated = parameter.maximum if upper else parameter.minimum
    if parameter.type == "bool":
        return upper
    if parameter.type == "str":
        return ""
    if stated is not None:
        return stated
    if parameter.type == "int":
        return _INT32 - 1 if upper else -_INT32
    return math.inf if upper else -math.inf


def _typed(parameter: ReconfigureParameter, value: Any) -> Value:
    """Value in its parameter's type. Whole numbers convert between types, 0 and 1 also to bool."""
    kind = parameter.type
    plain = isinstance(value, int | float) and not isinstance(value, bool)
    if kind == "str" and isinstance(value, str):
        return value
    if kind == "bool" and (isinstance(value, bool) or (plain and value in (0, 1))):
        return bool(value)
    if kind == "double" and plain and not math.isnan(value):
        return float(value)
    if kind == "int" and plain and -_INT32 <= value < _INT32 and value == int(value):
        return int(value)
    raise GraphError(
        f'parameter "{parameter.name}" must be of type {kind} (got {value!r})',
        code=PARAMETER_VALUE_INVALID,
        values={"parameter": parameter.name, "type": kind},
    )


def _clamped(parameter: ReconfigureParameter, value: Value) -> Value:
    if isinstance(value, int | float) and parameter.type in ("int", "double"):
        for stated, choose in ((parameter.minimum, max), (parameter.maximum, min)):
            if isinstance(stated, int | float):
                value = choose(value, stated)
        if math.isinf(value):
            raise GraphError(
                f'parameter "{parameter.name}" must be finite (got {value})',
                code=PARAMETER_VALUE_INVALID,
                values={"parameter": parameter.name},
            )
    return _typed(parameter, value)
