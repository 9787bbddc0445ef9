"""Services that a program offers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.codes.graph import SERVICE_FAILED
from cartwheel.errors import GraphError
from cartwheel.graph import Graph, Service, made_response
from cartwheel.messages import service_classes
from cartwheel.messages.library.library import TypeLibrary
from cartwheel.messages.store import finding_with


class ProgramHandler:
    """Calls the function of a program that responds to a service.

    An error of the function stops the run of the world, as that of a subscriber does. `World.call`
    uses `respond` instead, which raises the error.

    Args:
        name: Service name.
        type_name: ``pkg/srv/Name``.
        function: Takes a request, and returns a response or a mapping of its fields.
        types: Finds the types of messages within the function.
        defer: Makes the run raise an error after the step.
    """

    def __init__(
        self,
        name: str,
        type_name: str,
        function: Callable[[Any], Any],
        types: TypeLibrary,
        defer: Callable[[BaseException], None],
    ) -> None:
        self._name = name
        self._response = service_classes(type_name)[1]
        self._function = function
        self._types = types
        self._defer = defer

    def __call__(self, request: Any) -> Any:
        """The response for another program, or for a plugin."""
        try:
            return self.respond(request)
        except BaseException as error:
            self._defer(error)
            raise GraphError(
                f'the handler of service "{self._name}" raised {type(error).__name__}: {error}',
                code=SERVICE_FAILED,
                values={"service": self._name, "error": type(error).__name__},
            ) from error

    def respond(self, request: Any) -> Any:
        """The response. Errors of the function are raised.

        Raises:
            GraphError: The function returns no response, or one of a different type.
        """
        with finding_with(self._types):
            return made_response(self._name, self._response, self._function(request))


class ServiceServer:
    """A service that a program offers. `World.serve` returns it."""

    def __init__(self, graph: Graph, service: Service) -> None:
        self._graph = graph
        self._service: Service | None = service
        self.name = service.name
        """Name of the service."""
        self.type = service.type
        """Type of the service, such as ``std_srvs/srv/SetBool``."""

    def __repr__(self) -> str:
        return f"<ServiceServer {self.name} {self.type}>"

    def close(self) -> None:
        """Withdraws the service. Further calls have no effect."""
        service, self._service = self._service, None
        if service is not None:
            self._graph.withdraw(service)
