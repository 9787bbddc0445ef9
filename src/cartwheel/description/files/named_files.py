"""Resolves user input to a description file: paths, folders, and names of built-in files."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from cartwheel.codes import files as codes
from cartwheel.description.elements import numbers, xml
from cartwheel.description.files.package_folders import is_file, share
from cartwheel.description.files.packages import Packages
from cartwheel.errors import DescriptionError, Origin

SUFFIXES = (".urdf.xacro", ".xacro", ".urdf", ".sdf", ".world")
_LISTED = 8
"""Maximum number of descriptions to list in a hint."""
_IN_EVERY_WORLD = frozenset({"ground_plane"})
"""Models that cannot be spawned because the built-in worlds already contain them."""


def find_description(path: Path | str, package_path: Sequence[Path] = ()) -> Path:
    """The description file for a path, a URI or the name of a built-in file.

    Args:
        path: A file; a folder with a model; a ``package://`` or ``model://`` URI; a path below
            GAZEBO_RESOURCE_PATH or the built-in folders, such as ``worlds/mud.world``; or a name
            such as ``empty``, ``rosbots.xacro`` or ``traffic_cone``.
        package_path: Additional folders to search for packages and models.

    Raises:
        DescriptionError: The file was not found, and the hint suggests names; or the path is empty.
    """
    text = str(path)
    if not text.strip():
        # The path of an empty text is the working folder, which nobody means by it.
        raise DescriptionError(
            "the name of the file is empty",
            code=codes.FILE_MISSING,
            values={"kind": "file", "name": text},
        )
    # A Path merges the two slashes in a URI.
    for scheme in ("package", "model", "file"):
        if text.startswith(f"{scheme}:/"):
            uri = f"{scheme}://{text.partition(':')[2].lstrip('/')}"
            if scheme == "file":
                uri = f"file:///{text.partition(':')[2].lstrip('/')}"
            found = Packages(None, package_path).resolve(uri, what="description", folder=True)
            return _in_folder(found) if found.is_dir() else found
    given = Path(path)
    try:
        exists, folder = given.exists(), given.is_dir()
    except (OSError, ValueError):  # a name that is too long or contains a zero byte
        exists = folder = False
    if folder:
        return _in_folder(given)
    if exists:
        return given
    for resources in _resource_folders():
        if is_file(resources / given):
            return resources / given
    if len(given.parts) == 1:
        found_shipped = _shipped(given.name)
        if found_shipped is not None:
            return found_shipped
    meant, hint = _meant(given)
    raise DescriptionError(
        "the file does not exist",
        code=codes.FILE_MISSING,
        origin=Origin(file=text),
        hint=hint,
        values={"kind": "file", "name": text, "meant": meant},
    )


def shipped_descriptions() -> Iterator[Path]:
    """The built-in robots, worlds and models."""
    root = share()
    for pattern in ("robots/*/urdf/*", "robots/*/*", "worlds/*", "models/*", "models/*/*"):
        for path in sorted(root.glob(pattern)):
            if path.is_file() and path.name.endswith(SUFFIXES):
                yield path


def _spawnable_names() -> list[str]:
    """Names of the built-in robots, worlds and models, without the parts of other descriptions."""
    names = {
        path.parent.name
        if path.name == "model.sdf"
        else path.stem
        if path.suffix == ".world"
        else path.name
        for path in shipped_descriptions()
        if _is_complete(path)
    }
    return sorted(names - _IN_EVERY_WORLD)


def bundled_worlds() -> list[str]:
    """Names of the built-in worlds."""
    return sorted(path.stem for path in shipped_descriptions() if path.suffix == ".world")


def _is_complete(path: Path) -> bool:
    """Whether a file describes a robot, a model or a world; xacro parts have no name."""
    try:
        root = xml.read_file(path)
    except DescriptionError:
        return False
    if root.tag == "robot":
        return "name" in root.attributes
    return any(child.tag in ("model", "world") for child in root.children)


def _resource_folders() -> list[Path]:
    """Folders that Gazebo searches for ``worlds/mud.world``, and the built-in folder."""
    named = os.environ.get("GAZEBO_RESOURCE_PATH", "").split(os.pathsep)
    folders = [Path(part).expanduser() for part in named if part]
    return [*folders, *(folder / "worlds" for folder in folders), share(), share() / "worlds"]


def _shipped(name: str) -> Path | None:
    """A file with this name, with or without its extension; or the model in such a folder."""
    all_shipped = list(shipped_descriptions())
    for path in all_shipped:
        if path.name == name:
            return path
    for path in all_shipped:
        if any(path.name == name + suffix for suffix in SUFFIXES):
            return path
    for kind in ("models", "robots"):
        for folder in (share() / kind).glob("*"):
            if folder.name == name and folder.is_dir():
                return _in_folder(folder)
    return None


def _in_folder(folder: Path) -> Path:
    """The model in a folder: the file in model.config, model.sdf, or its only description."""
    origin = Origin(file=xml.shown_path(folder))
    config = folder / "model.config"
    if config.is_file():
        sdfs = [node.text for node in xml.read_file(config).all("sdf") if node.text]
        for name in reversed(sdfs):  # the newest version is last
            if (folder / name).is_file():
                return folder / name
        if sdfs:
            raise DescriptionError(
                f'model.config refers to "{sdfs[-1]}", which does not exist',
                code=codes.FILE_MISSING,
                origin=origin,
                values={"kind": "model", "name": sdfs[-1]},
            )
    if (folder / "model.sdf").is_file():
        return folder / "model.sdf"
    found = [
        path
        for inner in (folder, folder / "urdf")
        if inner.is_dir()
        for path in sorted(inner.iterdir())
        if path.name.endswith(SUFFIXES) and path.is_file()
    ]
    same = [path for path in found if path.name.partition(".")[0] == folder.name]
    if len(found) == 1 or len(same) == 1:
        return (same or found)[0]
    names = tuple(str(path.relative_to(folder)) for path in found)
    raise DescriptionError(
        f"the folder contains {'several descriptions' if found else 'no description'}",
        code=codes.NOT_A_DESCRIPTION,
        origin=origin,
        hint=f"Pass one of: {', '.join(names[:_LISTED])}."
        if found
        else "Add a model.sdf or a .urdf file to it.",
        values={"found": names},
    )


def _meant(given: Path) -> tuple[str, str]:
    """The likely file, or an empty string, and the hint."""
    if len(given.parts) != 1:
        return xml.near_files(given)
    shipped = _spawnable_names()
    try:
        here = {entry.name for _, entry in zip(range(2000), Path.cwd().iterdir(), strict=False)}
    except OSError:
        here = set()
    near = numbers.likely(given.name, here | set(shipped))
    if near:
        return near, f'Did you mean "{near}"?'
    return "", f"Bundled descriptions: {', '.join(shipped)}." if shipped else ""
