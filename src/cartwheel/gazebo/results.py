"""How simulation_interfaces answers: results by number, and why."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.errors import UnknownNameError, one_line
from cartwheel.messages import zero

PACKAGE = "simulation_interfaces"
UNSUPPORTED, OK, NOT_FOUND, INCORRECT_STATE, FAILED = range(5)
"""Of Result.msg; services have further ones of their own."""

Handler = Callable[[Any, Any], None]
"""Takes a request and fills the response's fields."""


class Refusal(Exception):  # noqa: N818 - it is an answer
    """A result that is none of success."""

    def __init__(self, result: int, text: str) -> None:
        super().__init__(text)
        self.result = result


def outcome(function: Callable[[], None]) -> tuple[int, str]:
    """Runs a function; the result that tells what came of it, and its text."""
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
    """A handler for the graph, of the service type ``simulation_interfaces/srv/{kind}``."""

    def handle(request: Any) -> Any:
        response = zero(f"{PACKAGE}/srv/{kind}_Response")
        result, text = outcome(lambda: handler(request, response))
        if hasattr(response, "result"):
            response.result.result = result
            # What went well may have a remark all the same.
            response.result.error_message = text or response.result.error_message
        return response

    return handle
