"""Diagnostics in frames on the control socket."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, get_args

from cartwheel.codes import all_codes
from cartwheel.codes.command import INTERNAL_FAULT, REQUEST_REFUSED
from cartwheel.errors import (
    UNCLASSIFIED,
    CartwheelError,
    Code,
    ControlError,
    Diagnostic,
    Origin,
    Place,
    Severity,
    Value,
    known_code,
)

Packed = dict[str, Any]


def packed(diagnostic: Diagnostic) -> Packed:
    """A diagnostic as JSON data.

    Earlier releases used only ``severity``, ``message``, ``file`` and ``line``.
    """
    origin = diagnostic.origin
    return {
        "severity": diagnostic.severity,
        "message": diagnostic.message,
        "file": origin.file if origin else "",
        "line": origin.line if origin else 0,
        "stack": list(origin.stack) if origin else [],
        "code": diagnostic.code.number,
        "name": diagnostic.code.name,
        "hint": diagnostic.hint,
        "mark": diagnostic.mark,
        "instead": diagnostic.instead,
        "place": diagnostic.place,
        "also": [packed(each) for each in diagnostic.also],
        "values": dict(diagnostic.values),
    }


def unpacked(given: Mapping[str, Any]) -> Diagnostic:
    """The diagnostic sent by `packed` or by an earlier release; malformed fields become empty."""
    also = given.get("also")
    alike = [each for each in also if isinstance(each, dict)] if isinstance(also, list) else []
    return replace(_alone(given), also=tuple(_alone(each) for each in alike))


def _alone(given: Mapping[str, Any]) -> Diagnostic:
    severity = _one_of(given, "severity", Severity, "error")
    file = _text(given, "file")
    line = given.get("line")
    origin = None
    if file:
        known = line if isinstance(line, int) and not isinstance(line, bool) else 0
        origin = Origin(file=file, line=max(0, known), stack=_texts(given, "stack"))
    return Diagnostic(
        severity=severity,
        message=_text(given, "message"),
        code=_code(_text(given, "code"), _text(given, "name"), severity),
        origin=origin,
        hint=_text(given, "hint"),
        mark=_text(given, "mark"),
        instead=_text(given, "instead"),
        place=_one_of(given, "place", Place, ""),
        values=_values(given.get("values")),
    )


def refusal(error: Exception) -> dict[str, Any]:
    """The header of a frame that rejects a request.

    ``error`` is a text for earlier releases.
    """
    if isinstance(error, CartwheelError):
        return {"error": str(error), "diagnostic": packed(error.diagnostic())}
    diagnostic = INTERNAL_FAULT.because("the simulation could not complete the request", error)
    return {"error": diagnostic.message, "diagnostic": packed(diagnostic)}


def refused(header: Mapping[str, Any]) -> ControlError:
    """The error in a frame created by `refusal` or by an earlier release."""
    given = header.get("diagnostic")
    if not isinstance(given, dict):
        return ControlError(str(header["error"]), code=REQUEST_REFUSED)
    found = unpacked(given)
    return ControlError(
        found.message,
        code=found.code,
        origin=found.origin,
        hint=found.hint or None,
        values=found.values,
        mark=found.mark,
    )


def _code(number: str, name: str, severity: Severity) -> Code:
    """The code; unknown codes from other releases are created from the received values."""
    if not number or number == UNCLASSIFIED.number:
        return UNCLASSIFIED
    all_codes()  # loads all codes
    return known_code(number) or Code(number, name, severity, "a code from a different release")


def _text(given: Mapping[str, Any], name: str) -> str:
    value = given.get(name)
    return value if isinstance(value, str) else ""


def _texts(given: Mapping[str, Any], name: str) -> tuple[str, ...]:
    value = given.get(name)
    return tuple(each for each in value if isinstance(each, str)) if isinstance(value, list) else ()


def _one_of(given: Mapping[str, Any], name: str, kind: Any, default: Any) -> Any:
    value = given.get(name)
    return value if value in get_args(kind) else default


def _values(given: Any) -> dict[str, Value]:
    found: dict[str, Value] = {}
    for name, value in given.items() if isinstance(given, dict) else ():
        if isinstance(value, list):
            if all(isinstance(each, str) for each in value):
                found[name] = tuple(value)
            elif all(isinstance(each, int | float) for each in value):
                with contextlib.suppress(OverflowError):  # JSON integers have arbitrary size
                    found[name] = tuple(map(float, value))
        elif value is None or isinstance(value, str | int | float):
            found[name] = value
    return found
