"""The six standard ROS 2 services of a node with parameters."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from cartwheel.codes.graph import FIELD_VALUE_INVALID
from cartwheel.errors import GraphError
from cartwheel.messages.convert import zero
from cartwheel.messages.ros2.parameters import listed
from cartwheel.messages.store import message_class, service_classes

MOST = 10_000
"""Maximum number of names, prefixes or parameters in a request. A response is much larger."""
_PACKAGE = "rcl_interfaces"


class ParameterHandlers(ABC):
    """Handles the requests of the services, which subclasses answer from their parameters."""

    def offer(self, node: str, serve: Callable[[str, str, Callable[[Any], Any]], object]) -> None:
        """Offers the services.

        Args:
            node: Full name of the node, with namespace.
            serve: Offers a service: name, type, handler.
        """
        for name, kind, handler in (
            ("describe_parameters", "DescribeParameters", self._describe),
            ("get_parameter_types", "GetParameterTypes", self._types),
            ("get_parameters", "GetParameters", self._get),
            ("list_parameters", "ListParameters", self._list),
            ("set_parameters", "SetParameters", self._set),
            ("set_parameters_atomically", "SetParametersAtomically", self._set_atomically),
        ):
            serve(f"{node}/{name}", f"{_PACKAGE}/srv/{kind}", _limited(handler))

    @abstractmethod
    def names(self) -> Iterable[str]:
        """Returns the names of all parameters, separated by dots."""

    @abstractmethod
    def value(self, name: str) -> Any:
        """Returns a ``ParameterValue``; "not set" for an unknown name."""

    @abstractmethod
    def describe(self, descriptor: Any) -> None:
        """Completes a ``ParameterDescriptor``, which contains the name and the type."""

    @abstractmethod
    def change(self, given: Sequence[Any]) -> str:
        """Sets all given parameters, or none. Returns the reason; empty if they were set."""

    def _describe(self, request: Any) -> Any:
        descriptors = []
        for name in request.names:
            descriptor = zero(f"{_PACKAGE}/msg/ParameterDescriptor")
            descriptor.name, descriptor.type = name, self.value(name).type
            self.describe(descriptor)
            descriptors.append(descriptor)
        return _response("DescribeParameters", descriptors=descriptors)

    def _types(self, request: Any) -> Any:
        types = [self.value(name).type for name in request.names]
        return _response("GetParameterTypes", types=np.array(types, np.uint8))

    def _get(self, request: Any) -> Any:
        return _response("GetParameters", values=[self.value(name) for name in request.names])

    def _list(self, request: Any) -> Any:
        result = listed(self.names(), list(request.prefixes), int(request.depth))
        return _response("ListParameters", result=result)

    def _set(self, request: Any) -> Any:
        results = [self._result([each]) for each in request.parameters]
        return _response("SetParameters", results=results)

    def _set_atomically(self, request: Any) -> Any:
        return _response("SetParametersAtomically", result=self._result(request.parameters))

    def _result(self, given: Sequence[Any]) -> Any:
        reason = self.change(given)
        result = message_class(f"{_PACKAGE}/msg/SetParametersResult")
        return result(successful=not reason, reason=reason)


def _limited(handler: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """A handler that raises a GraphError if a request is too large."""

    def handle(request: Any) -> Any:
        for field in ("names", "parameters", "prefixes"):
            count = len(getattr(request, field, ()))
            if count > MOST:
                raise GraphError(
                    f"{field}: expected at most {MOST:,} elements, got {count:,}",
                    code=FIELD_VALUE_INVALID,
                    values={"field": field, "count": count},
                )
        return handler(request)

    return handle


def _response(kind: str, **fields: Any) -> Any:
    return service_classes(f"{_PACKAGE}/srv/{kind}")[1](**fields)
