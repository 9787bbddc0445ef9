"""Parses numbers, vectors and booleans in descriptions, with errors."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable, Sequence

from cartwheel.codes.tags import TEXT_AFTER_NUMBER, VALUE_INVALID
from cartwheel.errors import DescriptionError, Diagnostic, Origin
from cartwheel.geometry import Vec3
from cartwheel.similar_names import most_similar

_NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?\Z", re.ASCII)
_LEADING = re.compile(r"\s*([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)", re.ASCII)
_BEGINS = re.compile(
    r"[+-]?(?:(?P<hex>0[xX][0-9a-f]+(?:\.[0-9a-f]*)?(?:p[+-]?\d+)?)"
    r"|(?:\d+(?:\.\d*)?|\.\d+)(?:e[+-]?\d+)?)",
    re.ASCII | re.IGNORECASE,
)
"""The beginning of a word that C's ``strtod`` reads, apart from infinity and NaN."""
_INFINITE = re.compile(r"[+-]?inf(inity)?\Z", re.IGNORECASE)
LARGEST = 1e15
"""Maximum of positions, sizes and directions; the square of a larger value overflows."""
FARTHEST = 1e9
"""Maximum position in a pose, m: the engine considers states diverged at 1e10."""
MOST_RATIO = 1e6
"""Maximum ratio of a mimic joint or a gear."""
FARTHEST_JOINT = 1e6
"""Maximum initial joint position, rad or m; the same limit as for commands at run time."""
_LONGEST_NAME = 200
_MOST_NAMES = 2000
"""Maximum number of names, and total letters, to compare for a suggestion: the time grows with
their number, and with the square of their length.
"""


def _invalid(
    label: str, rest: str, stated: str | float, origin: Origin, hint: str | None = None
) -> DescriptionError:
    """The error for a malformed or out-of-range value; `label` names the value."""
    shown = stated if isinstance(stated, float) else stated[:_LONGEST_NAME]
    return DescriptionError(
        f"{label} {rest}",
        code=VALUE_INVALID,
        origin=origin,
        hint=hint,
        values={"name": label, "stated": shown},
    )


_TRUE = frozenset({"true", "1", "yes", "on"})
_FALSE = frozenset({"false", "0", "no", "off"})


def number(text: str, label: str, origin: Origin, *, infinite: bool = False) -> float:
    """A finite number, or an infinite one if allowed.

    Args:
        text: The text in the file.
        label: What the number is, for the error.
        origin: File and line.
        infinite: Whether ``inf`` is allowed, as for limits.
    """
    value = text.strip()
    if _NUMBER.match(value):
        result = float(value)
        if math.isfinite(result) or infinite:
            return result
        raise _invalid(label, f"{_quoted(value)} is too large", value, origin)
    if _INFINITE.match(value):
        if infinite:
            return float(value)
        raise _invalid(label, f"{_quoted(value)} is not a finite number", value, origin)
    if value.lower().lstrip("+-") == "nan":
        raise _invalid(label, f"{_quoted(value)} is not a finite number", value, origin)
    if not value:
        raise _invalid(label, "is empty, but must be a number", value, origin)
    raise _invalid(label, f"{_quoted(value)} is not a number", value, origin, _number_hint(value))


def leading(text: str, size: int = 1) -> tuple[str, str] | None:
    """Splits a text after its first `size` numbers, which Gazebo reads with C++ streams.

    Returns:
        The numbers, separated by spaces, and the rest of the text. None if Gazebo cannot read that
        many numbers either, for example from ``2e`` or ``wide``.
    """
    words: list[str] = []
    end = 0
    while len(words) < size:
        match = _LEADING.match(text, end)
        if match is None:
            return None
        end = match.end()
        follows = text[end : end + 1].lower()
        if follows == "e" or (follows == "x" and match[1] in ("0", "+0", "-0")):
            return None
        words.append(match[1])
    return " ".join(words), text[end:].strip()


def leading_words(text: str, size: int) -> tuple[str, str] | None:
    """The numbers at the beginning of the first `size` words, which libsdformat reads by itself.

    It reads single numbers, poses and colours so, in contrast to vectors: ``1e`` is 1, ``0.3a`` is
    0.3, and ``0x10`` is 16.

    Returns:
        The numbers, separated by spaces, and the rest of the text, which is empty if all words are
        numbers. None if a word does not begin with a finite number, or there are fewer words.
    """
    stated = text.split(None, size)
    found = [_BEGINS.match(word) for word in stated[:size]]
    if len(found) < size:
        return None
    words: list[str] = []
    for match in found:
        if match is None:
            return None
        try:
            words.append(repr(float.fromhex(match[0])) if match["hex"] else match[0])
        except OverflowError:
            return None
    used = " ".join(words)
    return used, "" if words == stated else text


def text_after(tag: str, stated: str, used: str, origin: Origin) -> Diagnostic:
    """The warning for an element of which only the first number or numbers are used."""
    return TEXT_AFTER_NUMBER.diagnostic(
        f"<{tag}> contains text after {'the number' if ' ' not in used else 'the numbers'} "
        f"(got {_quoted(stated)}), so {used} is used",
        origin=origin,
        hint=_number_hint(stated) or "",
        values={"tag": tag, "stated": stated[:_LONGEST_NAME], "used": used},
        mark=f"<{tag}",
    )


def vector(text: str, size: int, label: str, origin: Origin) -> tuple[float, ...]:
    """`size` finite numbers separated by white space."""
    if "," in text:
        raise _invalid(
            label,
            f"{_quoted(text.strip())} is not a list of numbers",
            text,
            origin,
            "Separate numbers with spaces, and use a decimal point.",
        )
    parts = text.split()
    values = tuple(number(part, label, origin) for part in parts)
    if len(values) != size:
        raise _invalid(
            label,
            f"{_quoted(text.strip())} must have {size} numbers (got {len(values)})",
            text,
            origin,
        )
    if max(map(abs, values), default=0.0) > LARGEST:
        raise _invalid(
            label, f"{_quoted(text.strip())} contains a number above {LARGEST:g}", text, origin
        )
    return values


def position(values: Sequence[float], label: str, origin: Origin) -> Vec3:
    """The position of a pose, m.

    Raises:
        DescriptionError: The position is too far away.
    """
    x, y, z = values
    if max(abs(x), abs(y), abs(z)) > FARTHEST:
        raise _invalid(
            label,
            f"must be at most {FARTHEST:g} m away along each axis (got {x:g} {y:g} {z:g})",
            max(values, key=abs),
            origin,
        )
    return (x, y, z)


def within(value: float, most: float, label: str, origin: Origin) -> float:
    """A number with a limited magnitude.

    Raises:
        DescriptionError: The number is too large.
    """
    if abs(value) > most:
        raise _invalid(
            label, f"must be between {-most:g} and {most:g} (got {value:g})", value, origin
        )
    return value


def boolean(text: str, label: str, origin: Origin) -> bool:
    """A boolean in any spelling used in Gazebo's files."""
    value = text.strip().lower()
    if value in _TRUE:
        return True
    if value in _FALSE:
        return False
    raise _invalid(
        label,
        f"{_quoted(text.strip())} is neither true nor false",
        text,
        origin,
        "Valid values: true, false, 1, 0.",
    )


def likely(name: str, known: Iterable[str], cutoff: float = 0.7) -> str | None:
    """The name in `known` that a misspelt name likely means, ignoring case."""
    if len(name) > _LONGEST_NAME:
        return None
    known = itertools.islice((each for each in known if len(each) <= _LONGEST_NAME), _MOST_NAMES)
    by_lower = {candidate.lower(): candidate for candidate in sorted(known, reverse=True)}
    close = most_similar(name.lower(), by_lower, cutoff)
    return by_lower[close] if close is not None else None


def _quoted(value: str) -> str:
    return f'"{value}"' if len(value) <= 80 else f'"{value[:77]}…"'


def _number_hint(value: str) -> str | None:
    if "${" in value or "$(" in value:
        return (
            "A plain URDF does not evaluate xacro expressions. Declare xacro in <robot>: "
            'xmlns:xacro="http://www.ros.org/wiki/xacro".'
        )
    if _NUMBER.match(value.replace(",", ".", 1)):
        return f'Use a decimal point: "{value.replace(",", ".", 1)}".'
    return None
