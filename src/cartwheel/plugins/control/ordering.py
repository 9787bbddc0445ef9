"""Which of a file's controllers start first."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from cartwheel.plugins.control.files import ControllerEntry

_BASE = re.compile(r"(DriveController|SteeringController)$")
_PLAIN = re.compile(
    r"(Group\w*Controller|ForwardCommandController|Joint(Velocity|Effort)Controller)$"
)


def in_order(entries: Sequence[ControllerEntry]) -> list[ControllerEntry]:
    """Controllers of a file so that each comes after those whose references it names.

    Of wheels that a base's controller and one of plain commands both want, as a choice for a
    launch file, the base has them: what commands single joints comes last.
    """
    if any(_BASE.search(entry.type) for entry in entries):
        entries = sorted(entries, key=lambda entry: bool(_PLAIN.search(entry.type)))
    names = {entry.name: entry for entry in entries}
    done: dict[str, ControllerEntry] = {}

    def take(entry: ControllerEntry, above: tuple[str, ...]) -> None:
        if entry.name in done or entry.name in above:
            return
        for other in _named(entry.values, names):
            take(names[other], (*above, entry.name))
        done[entry.name] = entry

    for entry in entries:
        take(entry, ())
    return list(done.values())


def _named(values: Any, names: Mapping[str, Any]) -> list[str]:
    """Of some controllers those that begin a text of the parameters, before a slash."""
    if isinstance(values, str):
        return [first] if (first := values.partition("/")[0]) in names and "/" in values else []
    if isinstance(values, Mapping):
        values = values.values()
    elif not isinstance(values, list):
        return []
    return [name for value in values for name in _named(value, names)]
