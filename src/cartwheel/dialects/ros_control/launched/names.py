"""Names of ROS 1's controllers: their paths below the namespace of the controller manager."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from cartwheel.description.launches import LaunchUse
from cartwheel.description.model import RobotDescription
from cartwheel.dialects.ros_control.files import (
    ControllerEntry,
    for_robot,
    is_ros2,
    read_parameters,
)
from cartwheel.errors import PluginError

_MOST_PARTS = 20
"""Maximum number of parts of a name and its namespaces."""


def ros1_entries(
    content: Mapping[str, Any], source: str, namespace: str = ""
) -> list[ControllerEntry]:
    """Returns the controllers in a rosparam file: mappings with a ``type``, nested or not.

    The name of a controller is its path below the namespace of the manager, as in ROS, such as
    ``front/left/wheel``. If the file contains none in this namespace, it is the path below the
    namespace that all of them share. Controllers of another robot with equal names are left out.

    Args:
        content: The content of the file.
        source: Its name.
        namespace: The namespace of the controller manager; empty if it is unknown, or global.
    """
    found = list(_ros1_entries(content, ()))
    own = tuple(part for part in namespace.split("/") if part)
    inside = [each for each in found if len(each[0]) > len(own) and each[0][: len(own)] == own]
    groups = [(shared_space([path for path, _ in found]), found)]
    if own and inside:
        others = [each for each in found if len(each[0]) <= len(own) or each[0][: len(own)] != own]
        groups = [(own, inside), (shared_space([path for path, _ in others]), others)]
    entries: dict[str, ControllerEntry] = {}
    for space, group in groups:
        for path, values in group:
            name = "/".join(path[len(space) :])
            entry = ControllerEntry(
                name=name,
                type=values["type"],
                values=values,
                namespace="/".join(space),
                source=source,
            )
            entries.setdefault(name, entry)
    return list(entries.values())


def shared_space(paths: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """The namespace that contains all controllers with these paths."""
    spaces = [path[:-1] for path in paths]
    return tuple(parts[0] for parts in itertools.takewhile(_are_equal, zip(*spaces, strict=False)))


def _are_equal(parts: Sequence[str]) -> bool:
    return len(set(parts)) == 1


def _ros1_entries(
    content: Mapping[str, Any], path: tuple[str, ...]
) -> Iterator[tuple[tuple[str, ...], Mapping[str, Any]]]:
    """The paths and parameters of controllers."""
    for key, value in content.items():
        if not isinstance(value, Mapping):
            continue
        parts = tuple(part for part in str(key).split("/") if part)
        kind = value.get("type")
        if isinstance(kind, str) and "/" in kind.replace("::", "/"):
            yield (*path, *parts), value
        elif len(path) < 4:
            yield from _ros1_entries(value, (*path, *parts))


def as_named(names: Iterable[str], entries: Iterable[ControllerEntry]) -> tuple[str, ...]:
    """Returns the names of the controllers that a spawner names.

    A spawner may name them with a part of their namespace, or without a part of their own name if
    its own namespace contains it. Names that no entry fits are returned without namespaces.
    """
    listed = list(entries)
    known = {entry.name for entry in listed}
    paths = {entry.name: f"{entry.namespace}/{entry.name}".strip("/") for entry in listed}
    whole: dict[str, list[str]] = {}
    ends: dict[str, list[str]] = {}
    for one, path in paths.items():
        whole.setdefault(path, []).append(one)
        for end in ends_of(path):
            ends.setdefault(end, []).append(one)
    found: dict[str, None] = {}
    for plain in dict.fromkeys(name.strip("/") for name in names):
        shorter = (one for end in ends_of(plain) for one in whole.get(end, ()))
        fitting = dict.fromkeys((*ends.get(plain, ()), *shorter))
        found |= dict.fromkeys([plain] if plain in known else fitting or [plain.rpartition("/")[2]])
    return tuple(found)


def ends_of(path: str) -> Iterator[str]:
    """A path and what remains of it without its first parts, up to a number of parts."""
    parts = path.split("/")
    for count in range(min(len(parts), _MOST_PARTS), 0, -1):
        yield "/".join(parts[-count:])


def named_in(
    names: Iterable[str], files: Iterable[Path], robot: RobotDescription
) -> tuple[str, ...]:
    """Returns the names of the controllers in files that a launch file names; see `as_named`."""
    entries: list[ControllerEntry] = []
    for path in files:
        with contextlib.suppress(PluginError):
            content = for_robot(read_parameters(path), path, robot)
            entries += [] if is_ros2(content) else ros1_entries(content, str(path), _space(robot))
    return as_named(names, entries)


def node_arguments(
    starter: LaunchUse | None, files: Iterable[Path], robot: RobotDescription
) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Returns the ROS arguments of controllers, by name.

    In ROS 1, a spawner may name a controller by its path, such as ``controllers/drive``. Its topics
    are then below this path, which ``__ns:=controllers`` states.
    """
    if starter is None:
        return ()
    paths = {name.strip("/") for name in starter.spawned if "/" in name.strip("/")}
    found: dict[str, tuple[str, ...]] = {}
    for path in files if paths else ():
        with contextlib.suppress(PluginError):
            content = for_robot(read_parameters(path), path, robot)
            for entry in [] if is_ros2(content) else ros1_entries(content, str(path)):
                space = entry.namespace
                if space != _space(robot).strip("/") and f"{space}/{entry.name}" in paths:
                    found[entry.name] = (f"__ns:={space}",)
    return (*starter.node_arguments, *found.items())


def used_names(
    launches: Iterable[LaunchUse],
    about: Iterable[LaunchUse],
    files: Iterable[Path],
    robot: RobotDescription,
) -> frozenset[str] | None:
    """Returns the names of all controllers that launch files start or load for a robot.

    None if they are not all known.

    Args:
        launches: All launch files near the robot.
        about: Those that may be for the robot.
        files: Files with controllers for the robot.
        robot: The robot.
    """
    own = [*about]
    if any(each.left_out is not None for each in launches) or any(each.unsure for each in own):
        return None
    return frozenset(named_in((n for e in own for n in (*e.spawned, *e.loaded)), files, robot))


def last_names(path: Path, robot: RobotDescription) -> frozenset[str]:
    """Returns the names of ROS 1's controllers in a file, without namespaces."""
    try:
        content = for_robot(read_parameters(path), path, robot)
    except PluginError:
        return frozenset()
    if is_ros2(content):
        return frozenset()
    return frozenset(
        entry.name.rpartition("/")[2] for entry in ros1_entries(content, str(path), _space(robot))
    )


def _space(robot: RobotDescription) -> str:
    """The namespace of a robot's controller manager that its tags state; empty if they do not."""
    tags = (tag.element.find("robotNamespace") for tag in robot.plugins)
    return next((each.text.strip() for each in tags if each is not None), "")
