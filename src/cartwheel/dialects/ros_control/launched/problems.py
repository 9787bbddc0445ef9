"""Mistakes in launch files that start controllers."""

from __future__ import annotations

import contextlib
import functools
import itertools
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from cartwheel import yaml_text
from cartwheel.codes.devices import (
    CONTROLLER_ONLY_LOADED,
    CONTROLLER_UNDEFINED,
    CONTROLLERS_FILE_UNREADABLE,
)
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.launches import LaunchUse, root_of
from cartwheel.description.launches.effort import UNKNOWN
from cartwheel.description.model import RobotDescription
from cartwheel.dialects.ros_control.files import is_ros2, name_and_file, read_parameters, read_yaml
from cartwheel.dialects.ros_control.launched.names import ends_of, ros1_entries
from cartwheel.dialects.ros_control.launched.own_managers import own_managers
from cartwheel.errors import Diagnostic, Origin, PluginError

_TEXTS = (".yaml", ".yml", ".launch", ".py", ".xml", ".xacro", ".urdf", ".sdf", ".world")
"""Ends of the names of files that may contain parameters of controllers, also within a tag."""
_MOST_TEXTS = 2000
"""Maximum number of such files that are read."""
_SHOWN = 4
"""Maximum number of controllers that a message lists."""
_MOST_FOLDERS = 5000
"""Maximum number of folders that are searched for them."""
_MOST_NAMES = 10_000
"""Maximum number of full names of the controllers of a launch file."""


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


def unfound(starter: LaunchUse | None) -> Iterator[Diagnostic]:
    """The missing files with the parameters of the controllers that a launch file starts."""
    if starter is None:
        return
    started = {name.rpartition("/")[2]: None for name in starter.spawned}
    for each in starter.unfound:
        if started and not each.controller:
            yield CONTROLLERS_FILE_UNREADABLE.diagnostic(
                f'the controller file "{each.file}" is in a home folder, so on other computers no '
                "controller starts",
                origin=each.origin,
                values={
                    "file": str(each.file),
                    "controllers": tuple(started),
                    "needed_for": "controllers",
                },
                hint="roslaunch stops at the <rosparam>. Write $(find PACKAGE)/config/"
                f"{each.file.name}, with the name of your package.",
            )
        elif each.controller in started:
            yield CONTROLLERS_FILE_UNREADABLE.diagnostic(
                f'the controller file "{each.file}" does not exist, so the controller '
                f'"{each.controller}" does not start',
                origin=each.origin,
                values={"file": str(each.file), "controllers": (each.controller,)},
                hint="roslaunch stops at the <rosparam>.",
            )


def undefined(
    robot: RobotDescription, starter: LaunchUse | None, within: Path | None = None
) -> Iterator[Diagnostic]:
    """Controllers that a launch file starts, but that no file near it or the robot defines."""
    folder = within or root_of(Path(robot.origin.file))
    if starter is None or not starter.spawned or starter.incomplete or folder is None:
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
    absent, foreign = (tuple(map(str, each)) for each in (starter.absent, starter.foreign))
    for name in starter.spawned:
        if name in left:
            yield CONTROLLER_UNDEFINED.diagnostic(
                f'"{starter.file.name}" starts the controller "{name}", but no file near it '
                "contains its parameters, so it cannot be loaded",
                origin=Origin(file=shown_path(starter.file)),
                values={"controller": name, "absent": absent, "foreign": foreign},
                hint=f"The launch file loads files that were not found: {lost}. They may be in "
                "packages that are not installed."
                if lost
                else "",
            )


def misplaced(
    robot: RobotDescription, starter: LaunchUse | None, launches: Sequence[LaunchUse]
) -> Iterator[Diagnostic]:
    """Controllers that a launch file starts in another namespace than that of the controller
    manager, or than that of their parameters.

    Controllers with the same two namespaces are one problem.

    Only what the launch file certainly states counts, and only parameters that no launch file loads
    into the namespace in which the controller manager looks for them.

    Args:
        robot: The robot.
        starter: The launch file.
        launches: All launch files near the robot.
    """
    if starter is None or not starter.sought:
        return
    unmanaged = [*_unmanaged(robot, starter, launches)]
    if unmanaged or starter.absent:
        yield from unmanaged
        return
    read = functools.cache(_parameters)
    own = _paths(starter, read)
    missed = [each for each in starter.sought if own is not None and _full(*each) not in own]
    if own is None or not missed:
        return
    known: set[str] = set()
    for use in launches:
        paths = _paths(use, read)
        if paths is None:
            return
        known |= paths.keys()
    longer: dict[str, str] = {}
    for path in own:
        _, _, inner = path.partition("/")
        for end in ends_of(inner) if inner else ():
            longer.setdefault(end, path)
    apart: dict[tuple[str, str, Path], dict[str, None]] = {}
    for space, name in missed:
        if _full(space, name) in known:
            continue
        found = longer.get(name, name if space and name in own else None)
        if found is None:
            continue
        stated = found.removesuffix(name).rstrip("/")
        apart.setdefault((space.strip("/"), stated, own[found]), {})[name] = None
    for (space, stated, file), names in apart.items():
        yield _misplaced(starter, file, [*names], f"/{space}", f"/{stated}")


def unmanaged_in_ros2(
    robot: RobotDescription, starter: LaunchUse | None, launches: Sequence[LaunchUse]
) -> Iterator[Diagnostic]:
    """Controllers whose spawner of ROS 2 waits for a controller manager in a namespace that has
    none, in a launch file that starts the robot in Gazebo.
    """
    if starter is not None and starter.simulated and UNKNOWN not in starter.managers:
        yield from _unmanaged(robot, starter, launches, ros2=True)


def of_other_managers(
    robot: RobotDescription, starter: LaunchUse | None, launches: Sequence[LaunchUse]
) -> frozenset[str]:
    """The controllers that a launch file starts only with managers outside of Gazebo, such as that
    of the driver of a real robot, whose namespace is another one.
    """
    place = manager_place(robot, launches, ros2=True) if starter and starter.managers else None
    if starter is None or place is None:
        return frozenset()
    spaces: dict[str, set[str]] = {}
    for space, name in starter.sought_in_ros2:
        spaces.setdefault(name, set()).add(space.strip("/"))
    others = starter.managers - {place[0]}
    return frozenset(name for name, found in spaces.items() if found <= others)


def _unmanaged(
    robot: RobotDescription,
    starter: LaunchUse,
    launches: Sequence[LaunchUse],
    *,
    ros2: bool = False,
) -> Iterator[Diagnostic]:
    """Controllers whose spawner waits for a controller manager in a namespace that has none."""
    place = manager_place(robot, launches, ros2=ros2)
    if place is None:
        return
    manager, why = place
    known = {
        each
        for use in launches
        for each in (use.sought_in_ros2 if ros2 else use.sought)
        if each[0].strip("/") == manager
    }
    # Another model of the launch file may have a manager in its own namespace.
    others = {each.strip("/") for each in starter.spaces} if starter.several else set[str]()
    apart: dict[str, dict[str, None]] = {}
    programs: dict[str, str] | None = None
    for space, name in starter.sought_in_ros2 if ros2 else starter.sought:
        is_global = name.startswith(f"{manager}/")
        is_other = space.strip("/") not in (manager, *starter.managers, *others)
        if is_other and (manager, name) not in known and not is_global:
            programs = own_managers(starter) if programs is None else programs
            if space.strip("/") in programs or UNKNOWN in programs:
                continue
            apart.setdefault(space.strip("/"), {})[name] = None
    for space, names in apart.items():
        listed = ", ".join(f'"{name}"' for name in [*names][:_SHOWN])
        more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
        what = "controller" if len(names) == 1 else "controllers"
        tag = f"<robotNamespace>/{space}</robotNamespace>"
        tag = f"<ros><namespace>/{space}</namespace></ros>" if ros2 else tag
        yield CONTROLLER_UNDEFINED.diagnostic(
            f'"{starter.file.name}" starts the {what} {listed}{more} with a controller manager in '
            f'"/{space}", but the robot\'s is in "/{manager}", {why}, so nothing starts them',
            origin=Origin(file=shown_path(starter.file)),
            values={
                "controller": next(iter(names)),
                "controllers": tuple(names),
                "namespace": f"/{space}",
                "manager": f"/{manager}",
            },
            hint=f'Set {tag} in the plugin, or start the controllers in "/{manager}".',
        )


def manager_place(
    robot: RobotDescription, launches: Sequence[LaunchUse], *, ros2: bool
) -> tuple[str, str] | None:
    """The namespace of the controller manager in Gazebo, without the first slash, and why it is
    there; None if it is uncertain.

    Source: gazebo_ros_control, gazebo_ros2_control, gz_ros2_control, and gazebo_ros, which adds the
    namespace of a spawned model to the plugins that state none.
    """
    name = "ros2_control" if ros2 else "gazebo_ros_control"
    managers = [tag for tag in robot.plugins if name in tag.filename]
    file = Path(robot.origin.file).resolve()
    own = [each for each in launches if each.description and each.description.resolve() == file]
    if len(managers) != 1 or any(each.unknown for each in own):
        return None
    element = managers[0].element
    ros = element.find("ros") if ros2 else None
    stated = element.find("robotNamespace") if not ros2 else ros and ros.find("namespace")
    if stated is not None:
        tag = "<ros><namespace>" if ros2 else "<robotNamespace>"
        return stated.text.strip().strip("/"), f"which its {tag} states"
    spaces = frozenset[str]().union(*(each.spaces for each in own))
    if len(spaces) != 1 or UNKNOWN in spaces:
        return None
    (space,) = spaces
    if ros2 and not space:
        return "", "because its plugin states no other namespace"
    return space.strip("/"), "the namespace of the node that spawns it"


def _misplaced(
    starter: LaunchUse, file: Path, names: Sequence[str], wanted: str, stated: str
) -> Diagnostic:
    """The diagnostic for controllers with parameters in the namespace `stated`, not `wanted`."""
    first, *others = names
    if others:
        listed = ", ".join(f'"{name}"' for name in names[:_SHOWN])
        more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
        message = (
            f'"{starter.file.name}" starts the controllers {listed}{more}, whose controller '
            f'manager looks for their parameters in "{wanted}", but "{file.name}" sets them in '
            f'"{stated}"'
        )
    else:
        one, other = (f"/{_full(space, first)}" for space in (wanted, stated))
        message = (
            f'"{starter.file.name}" starts the controller "{first}", whose controller manager '
            f'looks for its parameters in "{one}", but "{file.name}" sets "{other}"'
        )
    return CONTROLLER_UNDEFINED.diagnostic(
        message,
        origin=Origin(file=shown_path(file)),
        values={
            "controller": first,
            "controllers": tuple(names),
            "namespace": wanted,
            "stated": stated,
        },
        hint="The namespace in the file and that of the spawner must be equal.",
    )


def misplaced_names(problem: Diagnostic) -> tuple[str, ...]:
    """The controllers in a diagnostic of `misplaced`."""
    names = problem.values["controllers"]
    return tuple(map(str, names)) if isinstance(names, tuple) else ()


def _paths(
    use: LaunchUse, read: Callable[[Path], Mapping[str, bool] | None]
) -> dict[str, Path] | None:
    """The full names of the controllers in the files of a launch file, without the first slash.

    None if a name or a namespace is uncertain, or if there are too many.
    """
    found: dict[str, Path] = {}
    for space, path in dict.fromkeys(use.places):
        names = read(path)
        if names is None or (names and UNKNOWN in space) or len(found) > _MOST_NAMES:
            return None
        file = name_and_file(path)[1]
        for name, is_global in names.items():
            found[_full(space, name)] = file
            if is_global:
                found[name] = file
    return found


def _parameters(path: Path) -> dict[str, bool] | None:
    """The names of ROS 1's controllers in a file, and whether they may be global names.

    None if a name is uncertain.
    """
    file = name_and_file(path)[1]
    try:
        content = read_parameters(path)
        # The launch file decides about the name of a single controller without one.
        single = file == path and isinstance(read_yaml(file).get("type"), str)
    except PluginError:
        return None
    if is_ros2(content):
        return {}
    entries = ros1_entries(content, str(path))
    names = [f"{entry.namespace}/{entry.name}".strip("/") for entry in entries]
    if any("$(" in name or (single and name == file.stem) for name in names):
        return None
    # rosparam takes a key that begins with a slash as a global name.
    is_global = any(str(key).startswith("/") for key in content)
    return dict.fromkeys(names, is_global)


def _full(space: str, name: str) -> str:
    return f"{space}/{name}".strip("/")


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
            origin=Origin(file=shown_path(starter.file)),
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
