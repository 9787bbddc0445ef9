"""Parameters that are changed while a node runs, as ROS 1's dynamic_reconfigure offers them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any, Literal

from cartwheel.codes.graph import PARAMETER_UNKNOWN, PARAMETER_VALUE_INVALID
from cartwheel.errors import GraphError, UnknownNameError
from cartwheel.graph.graph import Graph, Publisher
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
"""Of each type: the field of a ``Config`` that holds it, and its class here."""
_INT32 = 1 << 31


@dataclass(frozen=True, kw_only=True, slots=True)
class ReconfigureParameter:
    """One value that may be changed."""

    name: str
    type: Literal["bool", "int", "double", "str"]
    default: Value
    minimum: Value | None = None
    maximum: Value | None = None
    """Values beyond are moved to the bound; None where there is none."""
    description: str = ""
    level: int = 0
    """A bit mask for clients: what a change touches."""
    edit_method: str = ""
    """How a client shows it; see `choices`."""


def choices(*values: str, description: str = "") -> str:
    """The `edit_method` of a text that is one of a few: clients show a list to choose from."""
    listed = [
        {"name": value, "type": "str", "value": value, "description": value} for value in values
    ]
    return str({"enum": listed, "enum_description": description})


class ReconfigureServer:
    """Serves ``<name>/set_parameters`` and tells what there is to set and how it is set.

    ``<name>/parameter_descriptions`` and ``<name>/parameter_updates`` are latched; the values
    are also kept as parameters of the graph, ``<name>/<parameter>``. Source:
    dynamic_reconfigure. For the owner's thread.

    Args:
        graph: Where it is offered.
        name: Its namespace, global: ``/camera1``.
        parameters: What may be set, in the order of listings.
        on_change: Is given all values at each request, makes them count, and may return those
            that it corrects. It refuses a request by raising a `CartwheelError`.
        node: Who offers it, for listings.
        initial: The values now, where they are not the defaults; bounds do not hold for them.
        preset: Whether the graph's parameters of these names count before all else, as what
            a launch file sets. `on_change` is not called for them: read `values`.

    Raises:
        GraphError: The service is offered already.
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
            self._descriptions = self._advertise("parameter_descriptions", "ConfigDescription")
            opened.callback(self._descriptions.close)
            self._updates = self._advertise("parameter_updates", "Config")
            opened.callback(self._updates.close)
            self._opened = opened.pop_all()
        self._descriptions.publish(self._description())
        self._tell()

    @property
    def values(self) -> dict[str, Value]:
        """The present values, by name."""
        return dict(self._values)

    def update(self, values: Mapping[str, Value]) -> None:
        """Tells readers of values that changed in another way; `on_change` is not called.

        Raises:
            UnknownNameError: There is no parameter of such a name.
            GraphError: A value is of another type.
        """
        self._values |= {key: _typed(self._known(key), value) for key, value in values.items()}
        self._tell()

    def close(self) -> None:
        """Takes the service and the topics off the graph."""
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
        self._tell()
        return self._response(config=self._config(self._values))

    def _known(self, name: str) -> ReconfigureParameter:
        if name not in self._parameters:
            raise UnknownNameError(
                f"parameter of {self._name}", name, self._parameters, code=PARAMETER_UNKNOWN
            )
        return self._parameters[name]

    def _preset(self) -> dict[str, Value]:
        found = {}
        for key, parameter in self._parameters.items():
            value = self._graph.parameters.get(f"{self._name}/{key}")
            if value is not None:
                found[key] = _clamped(parameter, _typed(parameter, value))
        return found

    def _tell(self) -> None:
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
            **lists, groups=[state(name="Default", state=True, id=0, parent=0)]
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
            groups=[group(name="Default", type="", parameters=described, parent=0, id=0)],
            max=self._config({p.name: _bound(p, upper=True) for p in self._parameters.values()}),
            min=self._config({p.name: _bound(p, upper=False) for p in self._parameters.values()}),
            dflt=self._config({p.name: p.default for p in self._parameters.values()}),
        )


def _bound(parameter: ReconfigureParameter, *, upper: bool) -> Value:
    """A bound as a description tells it, where there is none the widest of the type."""
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
    """The value as its parameter's type; whole numbers may stand for others, and 0, 1 for bools."""
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
