"""Diagnostics that say the same of many places, as one line each."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from pathlib import PurePath

from cartwheel.errors import Diagnostic, Origin

_SHOWN = 3
"""Places, or names, beside the first."""
_ORDER = ("error", "warning", "info")
_NAMES = re.compile(r'"([^"]*)"')
_VARYING = re.compile(r'"[^"]*"|[-+]?\d[\d.eE+-]*|(?:Searched|Looked for)[: ].*')


def grouped(diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
    """One for all that differ in names and numbers alone, the gravest first.

    The first of a group is told whole, with the places of some more; of what differs in
    nothing but names, a group begins with the third.
    """
    groups: dict[tuple[str, str], list[Diagnostic]] = {}
    for each in diagnostics:
        groups.setdefault((each.severity, _VARYING.sub("…", each.message)), []).append(each)
    found = []
    for members in groups.values():
        alike = len({each.message for each in members}) == 1
        if len(members) == 1 or (len(members) == 2 and not alike):
            found.extend(members)
        else:
            found.append(_one(members, alike=alike))
    return sorted(found, key=lambda each: _ORDER.index(each.severity))


def _one(members: list[Diagnostic], *, alike: bool) -> Diagnostic:
    first, others = members[0], members[1:]
    places = list(dict.fromkeys(_place(each, first.origin) for each in others))
    if not alike:
        places = [f"{_difference(each, first)}{_place(each, first.origin)}" for each in others]
    more = ", …" if len(places) > _SHOWN else ""
    end = "" if first.message.endswith(("?", ".")) else "."
    text = f"{first.message}{end} {len(others)} more like it"
    if any(places):
        text += f": {', '.join(places[:_SHOWN])}{more}"
    return replace(first, message=text)


def _place(each: Diagnostic, beside: Origin | None) -> str:
    if each.origin is None:
        return ""
    if beside is not None and each.origin.file == beside.file:
        return f":{each.origin.line}"
    return f"{PurePath(each.origin.file).name}:{each.origin.line}"


def _difference(each: Diagnostic, first: Diagnostic) -> str:
    """The first name that the two do not share."""
    pairs = zip(_NAMES.findall(each.message), _NAMES.findall(first.message), strict=False)
    return next((f'"{name}" ' for name, other in pairs if name != other), "")
