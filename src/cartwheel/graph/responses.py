"""Responses of services that code of users handles."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.codes.graph import SERVICE_TIMED_OUT
from cartwheel.errors import GraphError
from cartwheel.graph.topic import made_message
from cartwheel.messages.classes import FILLER


def made_response(name: str, response: type[Any], given: Any) -> Any:
    """The response that a handler returned, with the types of its fields.

    Args:
        name: Service name.
        response: Class of the responses.
        given: A response, a mapping of its fields, or None if the response has no fields.

    Raises:
        GraphError: There is no response, it has a different type, or a value does not fit.
    """
    if given is None and set(response.__dataclass_fields__) != {FILLER}:
        raise GraphError(
            f'the handler of service "{name}" returned no response',
            code=SERVICE_TIMED_OUT,
            hint=f"Return a {response.__msgtype__}, or a mapping of its fields.",
            values={"service": name},
        )
    return made_message(name, response.__msgtype__, given, {})


def checked_handler(
    name: str, response: type[Any], handler: Callable[[Any], Any]
) -> Callable[[Any], Any]:
    """A handler whose responses are those of `made_response`."""
    return lambda request: made_response(name, response, handler(request))
