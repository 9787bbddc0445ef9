"""Diagnostics for parts that a reader leaves out because of an error."""

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
    """The error as a diagnostic, with what the simulation does without the part.

    Args:
        error: Why the part cannot be used.
        consequence: What happens, as a sentence without capital and full stop.
        of: The tag of the element that is left out, such as ``collision``; it becomes the value
            ``left_out``.
        severity: Of the diagnostic.
        code: Where it is not that of the error.
        origin: Where it is not that of the error.
        values: Further ones.
    """
    left_out = {"left_out": of} if of else {}
    return (code or error.code).diagnostic(
        f"{error.message}: {consequence}",
        origin=origin or error.origin,
        hint=error.hint or "",
        severity=severity,
        mark=error.mark,
        values={**error.values, **left_out, **(values or {})},
    )
