"""Diagnostics for parts that a reader skips because of an error."""

from __future__ import annotations

from collections.abc import Mapping

from cartwheel.errors import Code, DescriptionError, Diagnostic, Origin, Severity, Value


def loss(
    error: DescriptionError,
    consequence: str,
    *,
    of: str = "",
    severity: Severity = "error",
    code: Code | None = None,
    origin: Origin | None = None,
    values: Mapping[str, Value] | None = None,
) -> Diagnostic:
    """The error as a diagnostic, with the effect on the simulation.

    Args:
        error: Why the part cannot be used.
        consequence: The effect, as a sentence without capital letter and full stop.
        of: The tag of the skipped element, such as ``collision``; stored in the value ``left_out``.
        severity: The diagnostic's severity.
        code: Replaces the error's code.
        origin: Replaces the error's origin.
        values: Additional values.
    """
    left_out = {"left_out": of} if of else {}
    return (code or error.code).diagnostic(
        f"{error.message}, so {consequence}",
        origin=origin or error.origin,
        hint=error.hint or "",
        severity=severity,
        mark=error.mark,
        values={**error.values, **left_out, **(values or {})},
    )
