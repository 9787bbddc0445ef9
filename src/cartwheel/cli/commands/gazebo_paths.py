"""Gazebo's search paths: environment variables, and exports of ROS packages.

Source: gazebo 11, `SystemPaths`; gazebo_ros, gazebo_ros_paths_plugin.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree

from cartwheel.codes.command import WORLD_NOT_FOUND
from cartwheel.description.files.package_folders import share
from cartwheel.errors import CartwheelError
from cartwheel.similar_names import meant_one

_LEVELS = 4
"""Maximum number of folders between a workspace's source folder and a package."""
_IGNORE = ("CATKIN_IGNORE", "AMENT_IGNORE", "COLCON_IGNORE", "rospack_nosubdirs")
_EXPORTS = {
    "gazebo_model_path": "GAZEBO_MODEL_PATH",
    "gazebo_media_path": "GAZEBO_RESOURCE_PATH",
}
"""Attributes of ``<gazebo_ros>`` in the ``<export>`` of a package.xml, and their variables."""


def find_world(name: str, environment: Mapping[str, str] | None = None) -> Path:
    """The file of a world in Gazebo's command line.

    Args:
        name: A path, or a path below a folder in GAZEBO_RESOURCE_PATH or Cartwheel's own folder.
        environment: For tests; `os.environ` otherwise.

    Raises:
        CartwheelError: The world was not found; the hint lists the searched folders.
    """
    environment = os.environ if environment is None else environment
    given = Path(name).expanduser()
    folders = [Path.cwd()]
    if not given.is_absolute():
        folders += _paths(environment, "GAZEBO_RESOURCE_PATH")
        folders += [share(), share() / "worlds"]
    for folder in folders:
        if (folder / given).is_file():
            return folder / given
    if given.is_absolute():
        raise CartwheelError(
            f"the world {name} does not exist", code=WORLD_NOT_FOUND, values={"world": name}
        )
    shipped = sorted(f"worlds/{path.name}" for path in (share() / "worlds").glob("*.world"))
    near = meant_one(name, shipped)
    known = f'Did you mean "{near}"?' if near else f"Bundled worlds: {', '.join(shipped)}."
    searched = ", ".join(str(folder) for folder in folders[:-1])
    raise CartwheelError(
        f'the world "{name}" was not found',
        code=WORLD_NOT_FOUND,
        hint=(
            f"{known} Searched: {searched}. "
            "Add the folder of the world to GAZEBO_RESOURCE_PATH, or pass the full path."
        ),
        values={"world": name, "meant": near},
    )


def adopt_exports(environment: dict[str, str]) -> None:
    """Adds the exports of packages in ROS_PACKAGE_PATH to Gazebo's variables."""
    found: dict[str, list[Path]] = {variable: [] for variable in _EXPORTS.values()}
    for root in _paths(environment, "ROS_PACKAGE_PATH"):
        for manifest in _manifests(root, _LEVELS):
            for variable, path in _exports(manifest):
                if path not in found[variable]:
                    found[variable].append(path)
    for variable, paths in found.items():
        known = _paths(environment, variable)
        added = [path for path in paths if path not in known]
        if added:
            environment[variable] = os.pathsep.join(str(path) for path in (*known, *added))


def _exports(manifest: Path) -> Iterator[tuple[str, Path]]:
    try:
        data = manifest.read_bytes()
        if b"<gazebo_ros" not in data:
            return
        # A file in the user's own workspace.
        root = ElementTree.fromstring(data)  # noqa: S314
    except (OSError, ElementTree.ParseError):
        return
    for element in root.iterfind("export/gazebo_ros"):
        for attribute, variable in _EXPORTS.items():
            for part in element.get(attribute, "").split(os.pathsep):
                if part:
                    path = part.replace("${prefix}", str(manifest.parent))
                    yield variable, Path(os.path.normpath(path))


def _manifests(folder: Path, levels: int) -> Iterator[Path]:
    manifest = folder / "package.xml"
    if manifest.is_file():
        yield manifest
        return
    if levels == 0 or any((folder / name).exists() for name in _IGNORE):
        return
    try:
        inner = sorted(entry.path for entry in os.scandir(folder) if entry.is_dir())
    except OSError:
        return
    for path in inner:
        if not os.path.basename(path).startswith("."):  # noqa: PTH119 - there may be many
            yield from _manifests(Path(path), levels - 1)


def _paths(environment: Mapping[str, str], variable: str) -> list[Path]:
    value = environment.get(variable, "")
    return [Path(part).expanduser() for part in value.split(os.pathsep) if part]
