"""Diagnostics and errors as short texts that do not depend on their wording."""

from __future__ import annotations

from cartwheel.errors import CartwheelError, Diagnostic


def coded(each: Diagnostic | CartwheelError) -> str:
    """The name of its code, and the likely meant name where it has one."""
    meant = each.values.get("meant")
    return f"{each.code.name} {meant}" if meant else each.code.name


def placed(each: Diagnostic) -> str:
    """Its place, severity and `coded`."""
    return f"{each.origin} {each.severity} {coded(each)}"
