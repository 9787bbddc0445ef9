"""Diagnostics by their codes and values, which stay when their words change."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator
from typing import Any

import pytest

from cartwheel.errors import CartwheelError, Code, Diagnostic, Value


def coded(source: Any, code: Code, **values: object) -> list[Diagnostic]:
    """The diagnostics of a code that have these values.

    Args:
        source: A world, a session, or diagnostics.
        code: Their code.
        values: Those that must be among theirs.
    """
    diagnostics: Iterable[Diagnostic] = getattr(source, "diagnostics", source)
    return [
        each
        for each in list(diagnostics)
        if each.code is code and all(each.values.get(key) == one for key, one in values.items())
    ]


@contextlib.contextmanager
def raises(
    code: Code, kind: type[CartwheelError] = CartwheelError, /, **values: Value
) -> Iterator[pytest.ExceptionInfo[CartwheelError]]:
    """Expects an error with a code and, among others, these values."""
    with pytest.raises(kind) as caught:
        yield caught
    assert caught.value.code is code, repr(caught.value)
    found = {name: caught.value.values.get(name) for name in values}
    assert found == values


def named(each: Diagnostic | CartwheelError) -> str:
    """The name of its code, and the likely meant name where it has one."""
    meant = each.values.get("meant")
    return f"{each.code.name} {meant}" if meant else each.code.name


def placed(each: Diagnostic) -> str:
    """Its place, severity and `named`."""
    return f"{each.origin} {each.severity} {named(each)}"
