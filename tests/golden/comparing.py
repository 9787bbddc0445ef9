"""The differences between two records, by subject and kind."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

_SHOWN = 8
"""Differences of one kind of one subject that are listed."""
_LONGEST = 160


def differences(one: Any, other: Any) -> Iterator[tuple[str, str, str]]:
    """Subject, kind and text of each difference between two records."""
    first, second = one["subjects"], other["subjects"]
    for key in sorted({*first, *second}):
        if key not in first or key not in second:
            yield key, "subject", f"only in {'B' if key in second else 'A'}"
            continue
        for kind in sorted({*first[key], *second[key]}):
            found = list(_between(first[key].get(kind), second[key].get(kind), ""))
            for text in found[:_SHOWN]:
                yield key, kind, text
            if len(found) > _SHOWN:
                yield key, kind, f"and {len(found) - _SHOWN} more"


def _between(one: Any, other: Any, place: str) -> Iterator[str]:
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        if "hex" in one and "hex" in other:
            if one["hex"] != other["hex"]:
                yield (
                    f"{place}: differs by up to {_largest(one['hex'], other['hex']):.3g}: "
                    f"{_short(one['decimal'])} -> {_short(other['decimal'])}"
                )
            return
        for key in {**one, **other}:
            inside = f"{place} > {key}" if place else str(key)
            if key not in one:
                yield f"{inside}: only in B: {_short(other[key])}"
            elif key not in other:
                yield f"{inside}: only in A: {_short(one[key])}"
            else:
                yield from _between(one[key], other[key], inside)
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        for index, (a, b) in enumerate(zip(one, other, strict=True)):
            yield from _between(a, b, f"{place}[{index}]")
    elif one != other or type(one) is not type(other):
        if isinstance(one, list) and isinstance(other, list):
            a = [each for each in one if each not in other]
            b = [each for each in other if each not in one]
            yield (
                f"{place}: {len(one)} -> {len(other)} entries; only in A: {_short(a)}; "
                f"only in B: {_short(b)}"
            )
        else:
            yield f"{place}: {_short(one)} -> {_short(other)}"


def _largest(one: Sequence[str], other: Sequence[str]) -> float:
    """The largest difference of numbers in hexadecimal; infinite if there are more or fewer."""
    if len(one) != len(other):
        return math.inf
    pairs = zip(one, other, strict=True)
    return max(abs(float.fromhex(a) - float.fromhex(b)) for a, b in pairs if a != b)


def _short(value: Any) -> str:
    text = str(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"
