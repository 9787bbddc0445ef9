"""Texts and numbers in a form that is the same in each run of the same program."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .adapter import tree
from .subjects import CORPUS, ROOT

PLACES = {str(CORPUS): "<corpus>", str(ROOT): "<here>", str(tree()): "<here>"}
"""Folders of this machine, and what replaces them."""
_MEASURED = (
    (re.compile(r"\bin \d+(\.\d+)? ?s\b"), "in # s"),
    (re.compile(r"(?<![\w.])\d+(\.\d+)?(e\+?\d+)?x(?!\w)"), "#x"),
    (re.compile(r"\d+(\.\d+)? times real time"), "# times real time"),
    (re.compile(r"(?<=:)\d{4,5}\b(?!\.\d)"), "#"),
    (re.compile(r"\d+(\.\d+)? ?([kM]i?B)\b"), r"# \2"),
    (re.compile(r"\bpid \d+"), "pid #"),
    (re.compile(r"\d{4}-\d\d-\d\d[T_ -]\d\d[:-]\d\d[:-]\d\d(\.\d+)?"), "<date>"),
)
_NUMBER = re.compile(r"(?<![\w.])-?\d+(\.\d+)?(e[-+]?\d+)?")


def path(text: str, places: Mapping[str, str] | None = None) -> str:
    """A text in which the folders of this machine are replaced."""
    known = {**(places or {}), **PLACES}
    for place in sorted(known, key=len, reverse=True):
        text = text.replace(place, known[place])
    return text


def output(text: str, places: Mapping[str, str], *, live: bool) -> list[str]:
    """The lines of an output without times, ports and folders of this machine.

    Args:
        text: What a command printed.
        places: Folders and what replaces them.
        live: Whether all numbers are replaced, because a simulation ran against the clock.
    """
    text = path(text, places)
    for pattern, instead in _MEASURED:
        text = pattern.sub(instead, text)
    if live:
        text = _NUMBER.sub("#", text)
    return [" ".join(line.split()) for line in text.splitlines() if line.strip()]


def numbers(values: Iterable[float]) -> dict[str, list[Any]]:
    """Numbers as decimals and in hexadecimal, both exact."""
    given = [float(value) for value in values]
    return {
        "decimal": [value if np.isfinite(value) else str(value) for value in given],
        "hex": [value.hex() for value in given],
    }


def value(given: Any) -> Any:
    """A value of a diagnostic or a message, as JSON."""
    if isinstance(given, str):
        return path(given)
    if isinstance(given, (Path, bytes)):
        return path(str(given))
    if isinstance(given, Mapping):
        return {str(key): value(each) for key, each in given.items()}
    if isinstance(given, (list, tuple)):
        return [value(each) for each in given]
    if isinstance(given, np.ndarray):
        return [value(each) for each in given.tolist()]
    if isinstance(given, np.generic):
        return value(given.item())
    if isinstance(given, float) and not np.isfinite(given):
        return str(given)
    return given


def diagnostic(given: Any) -> dict[str, Any]:
    """Code, severity, place and values. The words may change, so they are not kept."""
    origin = given.origin
    return {
        "code": given.code.number,
        "severity": given.severity,
        "file": path(origin.file) if origin else "",
        "line": origin.line if origin else 0,
        "values": value(dict(given.values)),
        "fault": given.details.strip().splitlines()[-1:],
    }


def error(given: Exception) -> dict[str, Any]:
    """An error of the user's, or a fault of the program's."""
    if hasattr(given, "diagnostic"):
        return diagnostic(given.diagnostic())
    return {"fault": path(repr(given))}


def digest(*parts: bytes) -> str:
    made = hashlib.sha256()
    for part in parts:
        made.update(len(part).to_bytes(8, "little"))
        made.update(part)
    return made.hexdigest()
