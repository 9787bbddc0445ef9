"""The parameter services of the ROS 2 controller manager and its controllers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from cartwheel.messages import zero
from cartwheel.messages.ros2.parameter_services import ParameterHandlers
from cartwheel.messages.ros2.parameters import FIELDS, parameter_value

Serve = Callable[[str, str, Callable[[Any], Any]], Any]
"""Offers a service: name, type, handler."""


class ParameterServices(ParameterHandlers):
    """The services that read a node's parameters and, with `open_`, set them.

    Args:
        serve: Offers a service.
        node: Name of the node, with its namespace.
        values: Parameters that cannot be set, by name with dots.
        open_: Whether any other parameter can be set, as the spawner does.
    """

    def __init__(
        self, serve: Serve, node: str, values: Mapping[str, Any], *, open_: bool = False
    ) -> None:
        stated = {name: parameter_value(value) for name, value in values.items()}
        self._stated = {name: value for name, value in stated.items() if value.type}
        self._open = open_
        self._set_values: dict[str, Any] = {}
        """``ParameterValue`` by name."""
        self.offer(node, serve)

    def below(self, name: str) -> dict[str, Any]:
        """Returns the values of all parameters below a name that were set."""
        prefix = f"{name}."
        return {
            key.removeprefix(prefix): getattr(value, FIELDS[value.type])
            for key, value in self._set_values.items()
            if key.startswith(prefix)
        }

    def names(self) -> Iterable[str]:
        return {*self._stated, *self._set_values}

    def value(self, name: str) -> Any:
        value = self._set_values.get(name) or self._stated.get(name)
        return zero("rcl_interfaces/msg/ParameterValue") if value is None else value

    def describe(self, descriptor: Any) -> None:
        descriptor.read_only = not self._open

    def change(self, given: Sequence[Any]) -> str:
        refusal = next(filter(None, (self._refusal(each.name) for each in given)), "")
        if not refusal:
            for parameter in given:
                self._take(parameter)
        return refusal

    def _refusal(self, name: str) -> str:
        """Returns why a parameter cannot be set; empty if it can."""
        if self._open:
            return ""
        if name in self._stated:
            return f'parameter "{name}" is read-only'
        return f'parameter "{name}" has not been declared'

    def _take(self, parameter: Any) -> None:
        if parameter.value.type in FIELDS:
            self._set_values[parameter.name] = parameter.value
        else:
            self._set_values.pop(parameter.name, None)
