"""The parameters that ROS 2's spawner sets on a controller manager."""

from __future__ import annotations

from typing import Any

from cartwheel.messages import message_class, zero
from cartwheel.plugins.base import Plugin

_PACKAGE = "rcl_interfaces"
_FIELDS = {
    1: "bool_value",
    2: "integer_value",
    3: "double_value",
    4: "string_value",
    5: "byte_array_value",
    6: "bool_array_value",
    7: "integer_array_value",
    8: "double_array_value",
    9: "string_array_value",
}
"""Where a value of each type stands. Source: rcl_interfaces, ParameterType."""


class ParameterServices:
    """Services to set and get parameters of any name, as the manager's node has them.

    Args:
        plugin: Whose services they are.
        node: The node's name, with its namespace.
    """

    def __init__(self, plugin: Plugin[Any], node: str) -> None:
        self._values: dict[str, Any] = {}
        """``ParameterValue`` by name."""
        for name, kind, handler in (
            ("set_parameters", "SetParameters", self._set),
            ("get_parameters", "GetParameters", self._get),
        ):
            plugin.serve(f"{node}/{name}", f"{_PACKAGE}/srv/{kind}", handler)

    def below(self, name: str) -> dict[str, Any]:
        """Plain values of all parameters below a name."""
        prefix = f"{name}."
        return {
            key.removeprefix(prefix): getattr(value, _FIELDS[value.type])
            for key, value in self._values.items()
            if key.startswith(prefix)
        }

    def _set(self, request: Any) -> Any:
        for parameter in request.parameters:
            if parameter.value.type in _FIELDS:
                self._values[parameter.name] = parameter.value
            else:
                self._values.pop(parameter.name, None)
        done = message_class(f"{_PACKAGE}/msg/SetParametersResult")
        results = [done(successful=True, reason="") for _ in request.parameters]
        return message_class(f"{_PACKAGE}/srv/SetParameters_Response")(results=results)

    def _get(self, request: Any) -> Any:
        nothing = zero(f"{_PACKAGE}/msg/ParameterValue")
        return message_class(f"{_PACKAGE}/srv/GetParameters_Response")(
            values=[self._values.get(name, nothing) for name in request.names]
        )
