"""Numbers, vectors and truth values as descriptions write them, and what is wrong with them."""

from __future__ import annotations

import difflib
import itertools
import math
import re
from collections.abc import Iterable, Sequence

from cartwheel.codes.tags import VALUE_INVALID
from cartwheel.errors import DescriptionError, Origin
from cartwheel.geometry import Vec3

_NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?\Z", re.ASCII)
_INFINITE = re.compile(r"[+-]?inf(inity)?\Z", re.IGNORECASE)
LARGEST = 1e15
"""Of places, sizes and directions; squares of what is larger leave the range of numbers."""
FARTHEST = 1e9
"""m, of a pose's position: the engine takes states of 1e10 for diverged."""
MOST_RATIO = 1e6
"""Of a joint that follows another one, and of gears."""
FARTHEST_JOINT = 1e6
"""rad or m, of a joint's position at the start; the same bound as for commands while it runs."""
_LONGEST_NAME = 200
_MOST_NAMES = 2000
"""Names, and their letters, among which the one that was meant is looked for: the time grows with
their number, and with the square of their length."""


class _InvalidError(DescriptionError):
    """A value that is malformed or out of range; `label` says what it is of."""

    code = VALUE_INVALID

    def __init__(
        self, label: str, rest: str, stated: str | float, origin: Origin, hint: str | None = None
    ) -> None:
        shown = stated if isinstance(stated, float) else stated[:_LONGEST_NAME]
        super().__init__(
            f"{label} {rest}", origin=origin, hint=hint, values={"name": label, "stated": shown}
        )


_TRUE = frozenset({"true", "1", "yes", "on"})
_FALSE = frozenset({"false", "0", "no", "off"})


def number(text: str, label: str, origin: Origin, *, infinite: bool = False) -> float:
    """A finite number, or one of either infinity where those are allowed.

    Args:
        text: As written.
        label: What the number is, for the error.
        origin: Where it stands.
        infinite: Whether ``inf`` has a meaning there, as it has for limits.
    """
    value = text.strip()
    if _NUMBER.match(value):
        result = float(value)
        if math.isfinite(result) or infinite:
            return result
        raise _InvalidError(label, f"{_quoted(value)} is too large", value, origin)
    if _INFINITE.match(value):
        if infinite:
            return float(value)
        raise _InvalidError(label, f"{_quoted(value)} is not a finite number", value, origin)
    if value.lower().lstrip("+-") == "nan":
        raise _InvalidError(label, f"{_quoted(value)} is not a finite number", value, origin)
    if not value:
        raise _InvalidError(label, "is empty, but must be a number", value, origin)
    raise _InvalidError(
        label, f"{_quoted(value)} is not a number", value, origin, _number_hint(value)
    )


def integer(text: str, label: str, origin: Origin) -> int:
    """A whole number; ``10.0`` is one."""
    value = number(text, label, origin)
    if value != int(value):
        raise _InvalidError(label, f"{_quoted(text.strip())} is not an integer", text, origin)
    return int(value)


def vector(text: str, size: int, label: str, origin: Origin) -> tuple[float, ...]:
    """`size` finite numbers with white space between."""
    if "," in text:
        raise _InvalidError(
            label,
            f"{_quoted(text.strip())} is not a list of numbers",
            text,
            origin,
            "Separate numbers with spaces, and write decimals with a point.",
        )
    parts = text.split()
    values = tuple(number(part, label, origin) for part in parts)
    if len(values) != size:
        raise _InvalidError(
            label,
            f"{_quoted(text.strip())} must have {size} numbers (got {len(values)})",
            text,
            origin,
        )
    if max(map(abs, values), default=0.0) > LARGEST:
        raise _InvalidError(
            label, f"{_quoted(text.strip())} has a number above {LARGEST:g}", text, origin
        )
    return values


def position(values: Sequence[float], label: str, origin: Origin) -> Vec3:
    """The position of a pose, in m.

    Raises:
        DescriptionError: It is too far away.
    """
    x, y, z = values
    if max(abs(x), abs(y), abs(z)) > FARTHEST:
        raise _InvalidError(
            label,
            f"must be at most {FARTHEST:g} m away along each axis (got {x:g} {y:g} {z:g})",
            max(values, key=abs),
            origin,
        )
    return (x, y, z)


def within(value: float, most: float, label: str, origin: Origin) -> float:
    """A number of a bounded magnitude.

    Raises:
        DescriptionError: It is larger.
    """
    if abs(value) > most:
        raise _InvalidError(
            label, f"must be from {-most:g} to {most:g} (got {value:g})", value, origin
        )
    return value


def boolean(text: str, label: str, origin: Origin) -> bool:
    """A truth value in any of the spellings that Gazebo's files use."""
    value = text.strip().lower()
    if value in _TRUE:
        return True
    if value in _FALSE:
        return False
    raise _InvalidError(
        label,
        f"{_quoted(text.strip())} is neither true nor false",
        text,
        origin,
        "Write true, false, 1 or 0.",
    )


def likely(name: str, known: Iterable[str], cutoff: float = 0.7) -> str | None:
    """The one of `known` that a mistyped name likely means; letter case counts for nothing."""
    if len(name) > _LONGEST_NAME:
        return None
    known = itertools.islice((each for each in known if len(each) <= _LONGEST_NAME), _MOST_NAMES)
    by_lower = {candidate.lower(): candidate for candidate in sorted(known, reverse=True)}
    close = difflib.get_close_matches(name.lower(), by_lower, n=1, cutoff=cutoff)
    return by_lower[close[0]] if close else None


def _quoted(value: str) -> str:
    return f'"{value}"' if len(value) <= 80 else f'"{value[:77]}…"'


def _number_hint(value: str) -> str | None:
    if "${" in value or "$(" in value:
        return (
            "A plain URDF does not evaluate xacro expressions. Declare xacro in <robot>: "
            'xmlns:xacro="http://www.ros.org/wiki/xacro".'
        )
    if _NUMBER.match(value.replace(",", ".", 1)):
        return f'Write decimals with a point: "{value.replace(",", ".", 1)}".'
    return None
