"""Combines diagnostics of one kind into one that lists the other locations."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import PurePath

from cartwheel.cli.showing import difference
from cartwheel.errors import Diagnostic, Origin

_SHOWN = 3
"""Number of locations or names to show, besides the first."""
_ORDER = ("error", "warning", "info")


def grouped(diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
    """One diagnostic for each kind, where diagnostics may differ only in names and numbers.

    Errors come first; within a severity, diagnostics are sorted by file and line, with files in
    order of appearance. The first diagnostic in a group is complete, followed by some of the other
    locations. Diagnostics with different values are not merged.
    """
    groups: dict[tuple[object, ...], list[Diagnostic]] = {}
    files: dict[str, int] = {"": -1}
    for each in diagnostics:
        groups.setdefault(each.kind, []).append(each)
        files.setdefault(_file(each), len(files))
    result: list[Diagnostic] = []
    for members in groups.values():
        alike = all(dict(each.values) == dict(members[0].values) for each in members)
        if len(members) == 1 or (len(members) == 2 and not alike):
            result.extend(members)
        else:
            result.append(_one(members, alike=alike))

    def order(each: Diagnostic) -> tuple[int, int, int]:
        line = each.origin.line if each.origin is not None else 0
        return (_ORDER.index(each.severity), files[_file(each)], line)

    return sorted(result, key=order)


def _file(diagnostic: Diagnostic) -> str:
    return diagnostic.origin.file if diagnostic.origin is not None else ""


def _one(members: list[Diagnostic], *, alike: bool) -> Diagnostic:
    first, others = members[0], members[1:]
    places = [_place(each, first.origin) for each in others]
    if not alike:
        names = (difference(each, first) for each in others)
        places = [
            f'"{name}" {place}'.strip() if name else place
            for name, place in zip(names, places, strict=True)
        ]
    places = [place for place in dict.fromkeys(places) if place]
    more = ", …" if len(places) > _SHOWN else ""
    text = f"{first.message} (and {len(others)} more"
    if places:
        text += f": {', '.join(places[:_SHOWN])}{more}"
    return replace(first, message=f"{text})")


def _place(each: Diagnostic, beside: Origin | None) -> str:
    if each.origin is None:
        return ""
    if beside is not None and each.origin.file == beside.file:
        return f"line {each.origin.line}" if each.origin.line else ""
    return str(replace(each.origin, file=PurePath(each.origin.file).name))
