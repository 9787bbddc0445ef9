"""The parameter services of the ROS 2 controller manager and its controllers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from cartwheel.messages import decode_cdr, encode_cdr, zero
from cartwheel.messages.ros2.parameter_services import ParameterHandlers
from cartwheel.messages.ros2.parameters import FIELDS, parameter_value

_VALUE = "rcl_interfaces/msg/ParameterValue"
_MOST_BYTES = 4 << 20
"""Maximum size of all parameters that are set, with their names."""
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
        self._sizes: dict[str, int] = {}
        """Sizes of these values with their names, in bytes."""
        self._total = 0
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
        return zero(_VALUE) if value is None else value

    def describe(self, descriptor: Any) -> None:
        descriptor.read_only = not self._open

    def change(self, given: Sequence[Any]) -> str:
        refusal = next(filter(None, (self._refusal(each.name) for each in given)), "")
        if refusal:
            return refusal
        # A value in a request is a view of the whole request.
        encoded = {
            each.name: encode_cdr(each.value) if each.value.type in FIELDS else b""
            for each in given
        }
        sizes = {name: len(name) + len(data) if data else 0 for name, data in encoded.items()}
        grown = sum(size - self._sizes.get(name, 0) for name, size in sizes.items())
        if grown > 0 and self._total + grown > _MOST_BYTES:
            return f"the parameters would be larger than {_MOST_BYTES:,} bytes"
        self._total += grown
        for name, data in encoded.items():
            self._set_values.pop(name, None)
            self._sizes.pop(name, None)
            if data:
                self._set_values[name] = decode_cdr(data, _VALUE)
                self._sizes[name] = sizes[name]
        return ""

    def _refusal(self, name: str) -> str:
        """Returns why a parameter cannot be set; empty if it can."""
        if self._open:
            return ""
        if name in self._stated:
            return f'parameter "{name}" is read-only'
        return f'parameter "{name}" has not been declared'
