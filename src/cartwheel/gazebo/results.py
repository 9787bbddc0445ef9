"""Result codes and messages of simulation_interfaces."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.errors import Pickled, UnknownNameError, one_line
from cartwheel.messages import zero

PACKAGE = "simulation_interfaces"
UNSUPPORTED, OK, NOT_FOUND, INCORRECT_STATE, FAILED = range(5)
"""Values in Result.msg; services define additional values."""

Handler = Callable[[Any, Any], None]
"""Handles a request by setting the response's fields."""


class Refusal(Pickled, Exception):  # noqa: N818 - it is an answer
    """A result code that is not a success."""

    def __init__(self, result: int, text: str) -> None:
        super().__init__(text)
        self.result = result


def outcome(function: Callable[[], None]) -> tuple[int, str]:
    """Runs a function and returns its result code and message."""
    try:
        function()
    except Refusal as refusal:
        return refusal.result, str(refusal)
    except UnknownNameError as error:
        return NOT_FOUND, one_line(error)
    except Exception as error:  # noqa: BLE001 - the caller waits for an answer
        return FAILED, one_line(error)
    return OK, ""


def answering(kind: str, handler: Handler) -> Callable[[Any], Any]:
    """A graph handler for the service type ``simulation_interfaces/srv/{kind}``."""

    def handle(request: Any) -> Any:
        response = zero(f"{PACKAGE}/srv/{kind}_Response")
        result, text = outcome(lambda: handler(request, response))
        if hasattr(response, "result"):
            response.result.result = result
            # A successful result may also have a message.
            response.result.error_message = text or response.result.error_message
        return response

    return handle
