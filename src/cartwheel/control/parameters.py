"""Reads request parameters, with errors that contain the parameter's name."""

from __future__ import annotations

import math
from typing import Any

from cartwheel.codes.command import CONTROL_REQUEST_INVALID
from cartwheel.errors import ControlError, Value


class Parameters:
    """The parameters of a request.

    Args:
        values: The values from the client.

    Raises:
        ControlError: The values are not a mapping.
    """

    def __init__(self, values: Any) -> None:
        if not isinstance(values, dict):
            raise ControlError(
                "the request's parameters must be a JSON object", code=CONTROL_REQUEST_INVALID
            )
        self._values: dict[str, Any] = values

    def __contains__(self, name: str) -> bool:
        return name in self._values

    def text(self, name: str, default: str | None = None) -> str:
        """A string; required unless there is a default."""
        value = self._values.get(name)
        if value is None and default is not None:
            return default
        if not isinstance(value, str):
            raise _invalid(name, "a string")
        return value

    def texts(self, name: str) -> dict[str, str]:
        """A mapping from strings to strings."""
        value = self._values.get(name) or {}
        if not isinstance(value, dict) or not all(isinstance(v, str) for v in value.values()):
            raise _invalid(name, "an object of strings")
        return value

    def list_of_texts(self, name: str) -> list[str]:
        """A list of strings."""
        value = self._values.get(name) or []
        if not isinstance(value, list) or not all(isinstance(v, str) for v in value):
            raise _invalid(name, "a list of strings")
        return value

    def number(self, name: str, default: float | None = None) -> float:
        """A finite number; required unless there is a default."""
        value = self._values.get(name, default)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise _invalid(name, "a number")
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number):
            raise _invalid(name, f"finite (got {number})")
        return number

    def whole(self, name: str, default: int, low: int, high: int) -> int:
        """An integer within limits."""
        value = self.number(name, default)
        if value != int(value) or not low <= value <= high:
            wanted = f"a whole number between {low} and {high} (got {value:g})"
            raise _invalid(name, wanted, value=value)
        return int(value)

    def flag(self, name: str, *, default: bool) -> bool:
        """A boolean."""
        value = self._values.get(name, default)
        if not isinstance(value, bool):
            raise _invalid(name, "true or false")
        return value

    def value(self, name: str) -> Any:
        """Any value."""
        return self._values.get(name)


def _invalid(name: str, wanted: str, **values: Value) -> ControlError:
    return ControlError(
        f'the request\'s "{name}" must be {wanted}',
        code=CONTROL_REQUEST_INVALID,
        values={"parameter": name, **values},
    )
