"""Lists spawnable models, loadable worlds and named poses, for simulation_interfaces."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Literal
from urllib.parse import unquote

from cartwheel.description.elements import xml
from cartwheel.description.files.named_files import SUFFIXES, find_description, shipped_descriptions
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.readable_files import Reach
from cartwheel.errors import DescriptionError, one_line
from cartwheel.gazebo.entity_info import has_tags
from cartwheel.gazebo.requests import pose_message
from cartwheel.gazebo.results import FAILED, NOT_FOUND, PACKAGE, UNSUPPORTED, Handler, Refusal
from cartwheel.messages import zero
from cartwheel.simulation import Simulation

Kind = Literal["model", "world"]


class Resources:
    """Lists models and worlds: built-in ones and those in model folders.

    Args:
        simulation: The simulation.
        package_path: Folders to search for models first.
        reach: Folders that clients may access, besides those of packages and models.
    """

    def __init__(self, simulation: Simulation, package_path: Sequence[Path], reach: Reach) -> None:
        self._simulation = simulation
        self._packages = Packages(None, package_path, reach=reach)

    def offers(self) -> list[tuple[str, str, Handler, bool]]:
        """The services: name, type, handler, and whether the handler runs on a separate thread."""
        return [
            ("get_spawnables", "GetSpawnables", self._spawnables, True),
            ("get_named_poses", "GetNamedPoses", self._places, False),
            ("get_named_pose_bounds", "GetNamedPoseBounds", self._place_bounds, False),
            ("get_available_worlds", "GetAvailableWorlds", self._worlds, True),
            ("get_current_world", "GetCurrentWorld", self._world, False),
            ("load_world", "LoadWorld", self._load, False),
            ("unload_world", "UnloadWorld", self._load, False),
        ]

    def _spawnables(self, request: Any, response: Any) -> None:
        wrong, given = self._folders(request.sources)
        folders = self._packages.model_folders()
        for path, name in _described("model", (*folders, *given)):
            spawnable = zero(f"{PACKAGE}/msg/Spawnable")
            spawnable.entity_resource.uri = path.as_uri()
            spawnable.description = name
            response.spawnables.append(spawnable)
        response.result.error_message = "; ".join(wrong)

    def _worlds(self, request: Any, response: Any) -> None:
        wrong, given = self._folders(request.additional_sources)
        if wrong and not request.continue_on_error:
            raise Refusal(FAILED, "; ".join(wrong))
        if has_tags([], request.filter):
            response.worlds = [
                _world(name, uri=path.as_uri()) for path, name in _described("world", given)
            ]

    def _world(self, _: Any, response: Any) -> None:
        world = self._simulation.world
        file = Path(world.origin.file)
        response.world = _world(world.name, uri=file.absolute().as_uri() if file.is_file() else "")

    def _places(self, request: Any, response: Any) -> None:
        for name, where in self._simulation.world.places:
            place = zero(f"{PACKAGE}/msg/NamedPose")
            place.name, place.pose = name, pose_message(where)
            if has_tags([], request.tags):
                response.poses.append(place)

    def _place_bounds(self, request: Any, _: Any) -> None:
        if request.name not in dict(self._simulation.world.places):
            raise Refusal(NOT_FOUND, f'the world has no named pose "{request.name}"')
        raise Refusal(UNSUPPORTED, "named poses have no bounds")

    def _folders(self, sources: Iterable[str]) -> tuple[list[str], list[Path]]:
        """Errors for invalid sources, and the folders of the valid ones."""
        wrong, found = [], []
        for source in sources:
            folder = Path(unquote(source.removeprefix("file://")))
            try:
                self._packages.require(folder, "the folder")
            except DescriptionError as error:
                wrong.append(one_line(error))
                continue
            if "\0" not in source and folder.is_dir():
                found.append(folder)
            else:
                wrong.append(f'no such folder: "{source}"')
        return wrong, found

    def _load(self, _: Any, __: Any) -> None:
        raise Refusal(
            UNSUPPORTED,
            "a different world cannot be loaded into a running simulation; start a new simulation",
        )


def _world(name: str, *, uri: str) -> Any:
    """Creates ``WorldResource``."""
    made = zero(f"{PACKAGE}/msg/WorldResource")
    made.name, made.world_resource.uri = name, uri
    return made


def _described(kind: Kind, folders: Iterable[Path]) -> Iterator[tuple[Path, str]]:
    """The built-in models or worlds and those in folders: files and names."""
    files = list(shipped_descriptions())
    for folder in folders:
        files += _files(folder)
    for path in dict.fromkeys(each.absolute() for each in files):
        found = _kind_and_name(path)
        if found is not None and found[0] == kind:
            yield path, found[1]


def _files(folder: Path) -> Iterator[Path]:
    """The descriptions in a folder and in its model folders."""
    try:
        entries = sorted(folder.iterdir())
    except OSError:
        return
    for path in entries:
        if path.is_file() and path.name.endswith(SUFFIXES):
            yield path
        elif any((path / name).is_file() for name in ("model.config", "model.sdf")):
            with contextlib.suppress(DescriptionError):
                yield find_description(path)


def _kind_and_name(path: Path) -> tuple[Kind, str] | None:
    """The type and name in a file; None for unreadable files and parts of other descriptions."""
    try:
        root = xml.read_file(path)
    except DescriptionError:
        return None
    if root.tag == "robot":
        return ("model", root.attributes["name"]) if "name" in root.attributes else None
    for child in root.children:
        if child.tag in ("model", "world"):
            return ("model" if child.tag == "model" else "world"), child.attributes.get("name", "")
    return None
