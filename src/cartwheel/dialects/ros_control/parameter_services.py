"""The parameter services of the ROS 2 controller manager and its controllers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from cartwheel.messages import message_class, zero
from cartwheel.messages.ros2.parameters import FIELDS, listed, parameter_value

_PACKAGE = "rcl_interfaces"
Serve = Callable[[str, str, Callable[[Any], Any]], Any]
"""Offers a service: name, type, handler."""


class ParameterServices:
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
        for name, kind, handler in (
            ("describe_parameters", "DescribeParameters", self._describe),
            ("get_parameter_types", "GetParameterTypes", self._types),
            ("get_parameters", "GetParameters", self._get),
            ("list_parameters", "ListParameters", self._list),
            ("set_parameters", "SetParameters", self._set),
            ("set_parameters_atomically", "SetParametersAtomically", self._set_atomically),
        ):
            serve(f"{node}/{name}", f"{_PACKAGE}/srv/{kind}", handler)

    def below(self, name: str) -> dict[str, Any]:
        """Returns the values of all parameters below a name that were set."""
        prefix = f"{name}."
        return {
            key.removeprefix(prefix): getattr(value, FIELDS[value.type])
            for key, value in self._set_values.items()
            if key.startswith(prefix)
        }

    def _value(self, name: str) -> Any:
        value = self._set_values.get(name) or self._stated.get(name)
        return zero(f"{_PACKAGE}/msg/ParameterValue") if value is None else value

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

    def _set(self, request: Any) -> Any:
        results = []
        for parameter in request.parameters:
            refusal = self._refusal(parameter.name)
            if not refusal:
                self._take(parameter)
            results.append(_result(refusal))
        return _response("SetParameters", results=results)

    def _set_atomically(self, request: Any) -> Any:
        refusals = [self._refusal(each.name) for each in request.parameters]
        refusal = next(filter(None, refusals), "")
        if not refusal:
            for parameter in request.parameters:
                self._take(parameter)
        return _response("SetParametersAtomically", result=_result(refusal))

    def _get(self, request: Any) -> Any:
        return _response("GetParameters", values=[self._value(name) for name in request.names])

    def _types(self, request: Any) -> Any:
        types = bytes(self._value(name).type for name in request.names)
        return _response("GetParameterTypes", types=np.frombuffer(types, np.uint8))

    def _list(self, request: Any) -> Any:
        names = {*self._stated, *self._set_values}
        result = listed(names, list(request.prefixes), int(request.depth))
        return _response("ListParameters", result=result)

    def _describe(self, request: Any) -> Any:
        descriptors = []
        for name in request.names:
            descriptor = zero(f"{_PACKAGE}/msg/ParameterDescriptor")
            descriptor.name, descriptor.type = name, self._value(name).type
            descriptor.read_only = not self._open
            descriptors.append(descriptor)
        return _response("DescribeParameters", descriptors=descriptors)


def _result(refusal: str) -> Any:
    return message_class(f"{_PACKAGE}/msg/SetParametersResult")(
        successful=not refusal, reason=refusal
    )


def _response(kind: str, **fields: Any) -> Any:
    return message_class(f"{_PACKAGE}/srv/{kind}_Response")(**fields)
