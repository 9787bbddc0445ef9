"""Mistakes in launch files that start controllers."""

from __future__ import annotations

import contextlib
import itertools
import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from cartwheel import yaml_text
from cartwheel.codes.devices import CONTROLLER_ONLY_LOADED, CONTROLLER_UNDEFINED
from cartwheel.description.launches import LaunchUse, root_of
from cartwheel.description.model import RobotDescription
from cartwheel.dialects.ros_control.files import name_and_file, read_parameters
from cartwheel.errors import Diagnostic, Origin, PluginError

_TEXTS = (".yaml", ".yml", ".launch", ".py", ".xml", ".xacro", ".urdf", ".sdf", ".world")
"""Ends of the names of files that may contain parameters of controllers, also within a tag."""
_MOST_TEXTS = 2000
"""Maximum number of such files that are read."""
_MOST_FOLDERS = 5000
"""Maximum number of folders that are searched for them."""


def unreadable(paths: Sequence[Path], names: Sequence[str]) -> Iterator[Diagnostic]:
    """The errors in those of the files that contain the names of controllers."""
    for path in paths:
        try:
            text = yaml_text.read(name_and_file(path)[1])
        except (OSError, UnicodeDecodeError):
            continue
        held = tuple(name for name in names if f"{name.rpartition('/')[2]}:" in text)
        if held:
            try:
                read_parameters(path)
            except PluginError as error:
                found = error.diagnostic()
                yield replace(found, values={**found.values, "controllers": held})


def undefined(
    robot: RobotDescription, starter: LaunchUse | None, within: Path | None = None
) -> Iterator[Diagnostic]:
    """Controllers that a launch file starts, but that no file near it or the robot defines."""
    folder = within or root_of(Path(robot.origin.file))
    if starter is None or not starter.spawned or folder is None:
        return
    inside = starter.file.absolute().is_relative_to(folder)
    roots = dict.fromkeys((folder, folder if inside else root_of(starter.file) or folder))
    searched = [_definitions(root) for root in roots]
    if not all(searched):
        return
    left = set(starter.spawned)
    for path in itertools.chain(*searched):
        if not left:
            return
        with contextlib.suppress(OSError, UnicodeDecodeError):
            text = yaml_text.read(path)
            left -= {name for name in left if _is_key(name.rpartition("/")[2], text)}
    # Files of other packages are searched in the launch file's own package.
    lost = ", ".join(f'"{path.name}"' for path in starter.absent)
    for name in starter.spawned:
        if name in left:
            yield CONTROLLER_UNDEFINED.diagnostic(
                f'"{starter.file.name}" starts the controller "{name}", but no file near it '
                "contains its parameters, so it cannot be loaded",
                origin=Origin(file=str(starter.file)),
                values={"controller": name, "absent": tuple(map(str, starter.absent))},
                hint=f"The launch file loads files that were not found: {lost}. They may be in "
                "packages that are not installed."
                if lost
                else "",
            )


def only_loaded(starter: LaunchUse | None) -> Iterator[Diagnostic]:
    """Controllers that a launch file loads, but does not start."""
    if starter is None:
        return
    for name in starter.loaded:
        undecided = name in starter.undecided
        yield CONTROLLER_ONLY_LOADED.diagnostic(
            f'"{starter.file.name}" only loads the controller "{name}", so it does not command '
            "joints until it is started",
            severity="warning" if undecided else "info",
            origin=Origin(file=str(starter.file)),
            hint="Add --set-state active to the command." if undecided else "",
            values={"controller": name},
        )


def _definitions(folder: Path) -> list[Path]:
    """Files in a folder that may contain parameters of controllers, the likely ones first.

    Empty if there are too many to read.
    """
    found: list[Path] = []
    for count, (root, folders, names) in enumerate(os.walk(folder)):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        found += (Path(root, name) for name in sorted(names) if name.endswith(_TEXTS))
        if count >= _MOST_FOLDERS or len(found) > _MOST_TEXTS:
            return []
    return sorted(found, key=lambda path: path.suffix not in (".yaml", ".yml"))


def _is_key(name: str, text: str) -> bool:
    """Whether a text contains a name before a colon, or as the namespace of a ``<rosparam>``."""
    if name not in text:
        return False
    word = re.escape(name)
    pattern = rf"{word}\s{{0,9}}[\"']?\s{{0,9}}:|\bns\s?=\s?[\"'][^\"'<>]{{0,200}}{word}/?[\"']"
    return re.search(pattern, text) is not None
