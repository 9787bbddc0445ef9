"""Robots that are written in worlds, as those of gz-sim's tutorials."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import replace
from pathlib import Path

from cartwheel.corpus.movers import is_mover, may_drive
from cartwheel.description import load_world
from cartwheel.description.elements.node import Node
from cartwheel.description.files.regular_files import text_if_regular
from cartwheel.description.files.source_folders import source_folders
from cartwheel.description.loading import open_description
from cartwheel.description.model import RobotDescription
from cartwheel.errors import CartwheelError, DescriptionError, Origin, UnknownNameError
from cartwheel.geometry import Pose

_SUFFIXES = (".world", ".sdf", ".xacro")
_MOST = 50
"""Maximum number of robots in one world."""
_FIRST = re.compile(r"<(world|model|robot)[\s>]")
_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)
_REFERENCE = re.compile(r"<(?:(/?)include\b|uri>\s*([^<>\s]{1,4096})\s*</uri>)")
"""The beginning or end of an ``<include>``, or a ``<uri>``."""
_STEEPEST = 0.6
"""Largest roll or pitch of a model because of the ground in its world, rad."""


def robots_in_worlds(folder: Path, package_path: Sequence[Path] = ()) -> Iterator[tuple[Path, str]]:
    """World files with the names of their models that plugins move.

    Included models count if the world adds a plugin to them that moves them. Others are tested by
    their own files.

    Args:
        folder: A folder, which is searched with its subfolders, or a world.
        package_path: Additional folders to search for packages.
    """
    for path in [folder] if folder.is_file() else _files(folder):
        for name in _robots(path, package_path):
            yield path, name


def worlds_in(folder: Path) -> Iterator[Path]:
    """The world files in a folder and its subfolders, or a file if it is a world."""
    for path in [folder] if folder.is_file() else _files(folder):
        # A plugin of a robot may have a parameter with this name.
        first = _FIRST.search(text_of(path))
        if first is not None and first[1] == "world":
            yield path


def load_from_world(
    file: Path, model: str, arguments: Mapping[str, str], package_path: Sequence[Path]
) -> tuple[RobotDescription, Callable[[Origin | None], bool]]:
    """A model of a world, and a function that returns whether an origin is in this model or in the
    controller files that it names.

    Raises:
        CartwheelError: The world cannot be loaded, or has no such model.
    """
    world = load_world(file, arguments=arguments, package_path=package_path)
    robot = next((each for each in world.models if each.name == model), None)
    if robot is None:
        raise UnknownNameError("model", model, (each.name for each in world.models))
    start = robot.origin
    after = [
        each.origin.line
        for each in world.models
        if each.origin.file == start.file and each.origin.line > start.line
    ]
    end = min(after, default=None)
    plugins = {_place(each.origin) for tag in robot.plugins for each in tag.element.walk()}
    named = {
        Path(element.text.strip()).name
        for tag in robot.plugins
        for element in tag.element.find_all("parameters")
    }

    def is_inside(origin: Origin | None) -> bool:
        if origin is None:
            return False
        if _place(origin) in plugins:
            # The world may add plugins to a model that it includes.
            return True
        if origin.file != start.file:
            # A controller file may be in a folder other than the stated one.
            return Path(origin.file).name in named
        return start.line <= origin.line and (end is None or origin.line < end)

    found = {id(each): each for each in (*robot.diagnostics, *world.diagnostics)}
    inside = tuple(each for each in found.values() if is_inside(each.origin))
    return replace(robot, pose=_level(robot.pose), diagnostics=inside), is_inside


def _level(pose: Pose) -> Pose:
    """The pose on level ground of a model that stands on a slope in its world."""
    roll, pitch, yaw = pose.rpy
    if max(abs(roll), abs(pitch)) > _STEEPEST:
        return pose
    return Pose.from_xyz_rpy(pose.position, (0.0, 0.0, yaw))


def text_of(path: Path) -> str:
    """A file's text without comments; empty if it cannot be read."""
    return _COMMENT.sub("", text_if_regular(path))


def _files(folder: Path) -> Iterator[Path]:
    for here, names in source_folders(folder):
        yield from (here / name for name in names if name.endswith(_SUFFIXES))


def _robots(path: Path, package_path: Sequence[Path]) -> list[str]:
    text = text_of(path)
    if any(each not in text for each in ("<world", "<plugin")):
        return []
    try:
        root = open_description(path, {}, package_path).root
    except DescriptionError:
        return []
    worlds = root.all("world") if root.tag in ("sdf", "gazebo") else []
    found = [name for world in worlds for model in world.all("model") if (name := _robot(model))]
    added = {
        _place(plugin.origin)
        for world in worlds
        for include in world.all("include")
        for plugin in include.all("plugin")
        if is_mover(plugin.get("filename") or "")
    }
    if added:
        found += _included(path, added, package_path)
    return list(dict.fromkeys(found))[:_MOST]


def _included(
    path: Path, added: Set[tuple[str, int]], package_path: Sequence[Path]
) -> Iterator[str]:
    """The names of the models to which a world adds plugins at these places."""
    try:
        world = load_world(path, package_path=package_path)
    except CartwheelError:
        return
    for model in world.models:
        places = {_place(tag.origin) for tag in model.plugins}
        if not model.static and not places.isdisjoint(added):
            yield model.name


def _place(origin: Origin) -> tuple[str, int]:
    return origin.file, origin.line


def _robot(model: Node) -> str:
    """The name of a model that a plugin moves; otherwise empty."""
    static = model.child("static")
    if static is not None and static.text.strip().lower() in ("1", "true"):
        return ""
    joints = {each.get("name") or "" for each in model.all("joint") if each.get("type") != "fixed"}
    moves = any(_moves(plugin, joints) for plugin in model.all("plugin"))
    return (model.get("name") or "").strip() if moves else ""


def _moves(plugin: Node, joints: Set[str]) -> bool:
    """Whether a plugin moves its model: by its name, or because it names joints of the model."""
    name, words, remaining = plugin.get("filename") or "", set[str](), [plugin]
    while remaining:
        node = remaining.pop()
        words.update(node.text.split())
        remaining += node.children
    return is_mover(name) or may_drive(name, words, joints)


def mounted(texts: Mapping[Path, str], worlds: Sequence[Path]) -> Set[Path]:
    """The folders of SDF models that other models include, but none of the worlds.

    Gazebo finds ``model://NAME`` in a folder NAME.
    """
    named = {name for world in worlds for name in _models(text_of(world))}
    users: dict[str, set[Path]] = {}
    for path, text in texts.items():
        if path not in worlds:
            for name in _models(text):
                users.setdefault(name, set()).add(path.parent)
    return {
        path.parent
        for path in texts
        if path.parent.name not in named and users.get(path.parent.name, set()) - {path.parent}
    }


def _models(text: str) -> Iterator[str]:
    """The names of the models that an SDF file includes."""
    inside = False
    for found in _REFERENCE.finditer(text):
        uri = found[2]
        if uri is None:
            inside = not found[1]
        elif inside and not uri.startswith(("http://", "https://")):
            yield uri.removesuffix("/model.sdf").rstrip("/").rpartition("/")[2]
