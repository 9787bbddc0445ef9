"""The order in which the controllers of a file start."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from cartwheel.dialects.ros_control.files import ControllerEntry
from cartwheel.dialects.ros_control.launch_arguments import texts

_BASE = re.compile(r"(DriveController|SteeringController)$")
_PLAIN = re.compile(
    r"(Group\w*Controller|ForwardCommandController|Joint(Velocity|Effort)Controller)$"
)


def in_order(
    entries: Sequence[ControllerEntry], preferred: Collection[str] = ()
) -> list[ControllerEntry]:
    """Sorts controllers so that each follows those whose references it uses.

    Some files contain both a drive controller and forward controllers for the same wheels, so that
    a launch file can choose. Controllers of single joints come last, so the drive controller
    starts.

    Args:
        entries: The controllers of the files.
        preferred: Names of controllers that come first.
    """
    drives = any(_BASE.search(entry.type) for entry in entries)
    entries = sorted(
        entries,
        key=lambda entry: (
            entry.name not in preferred,
            drives and bool(_PLAIN.search(entry.type)),
        ),
    )
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


def compete(entries: Sequence[ControllerEntry], joints: Collection[str]) -> bool:
    """Whether two controllers contain the same joint, so that only one of them can command it.

    Args:
        entries: The controllers of the files.
        joints: Names of the robot's movable joints.
    """
    seen: set[str] = set()
    for entry in entries:
        if "roadcaster" in entry.type or "JointStateController" in entry.type:
            continue
        named = {text for text in texts(entry.values) if text in joints}
        if named & seen:
            return True
        seen |= named
    return False


def _named(values: Any, names: Mapping[str, Any]) -> list[str]:
    """Returns the controllers whose name begins a string in the parameters, before a slash."""
    if isinstance(values, str):
        return [first] if (first := values.partition("/")[0]) in names and "/" in values else []
    if isinstance(values, Mapping):
        values = values.values()
    elif not isinstance(values, list):
        return []
    return [name for value in values for name in _named(value, names)]
