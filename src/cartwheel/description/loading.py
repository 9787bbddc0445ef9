"""Loads descriptions in any supported format."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from cartwheel.codes import files as codes
from cartwheel.description.elements import xml
from cartwheel.description.elements.xml import Node
from cartwheel.description.files.named_files import bundled_worlds, find_description
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.readable_files import Reach
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.description.received_text import refuse_xacro, require_files
from cartwheel.description.xml_text import write_xml
from cartwheel.errors import DescriptionError, Diagnostic, Origin
from cartwheel.similar_names import meant

_LAUNCHED = (
    "cartwheel run and cartwheel.launch start it. Elsewhere, pass the description that it loads."
)
_OTHER_KINDS = {
    "launch": ("a launch file", _LAUNCHED),
    "package": ("a package manifest", "Pass a description from the package."),
    "COLLADA": ("a mesh", "Pass the description that uses the mesh."),
    "model": ("a model.config, or a <model> without <sdf> around it", ""),
    "world": ("a <world> without <sdf> around it", ""),
    "mujoco": ("a MuJoCo model, not a ROS or Gazebo description", ""),
}
"""Root elements of other file types, with a hint for each."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Opened:
    """A description with its xacro expanded, before interpretation."""

    root: Node
    packages: Packages
    text: str
    diagnostics: tuple[Diagnostic, ...]
    files: tuple[str, ...]
    """The xacro files that produced it, or the file itself."""
    arguments: Mapping[str, str] = field(default_factory=dict)
    """Arguments of the xacro, including defaults."""


def load(
    path: Path | str,
    *,
    arguments: Mapping[str, str] | None = None,
    package_path: Sequence[Path] = (),
    reach: Reach | None = None,
) -> RobotDescription | WorldDescription:
    """Reads a xacro, URDF, SDF or world file. The format is detected from the contents.

    Args:
        path: The file, a folder with a model, the name of a built-in description, or, without
            `reach`, the XML itself; see `load_text`.
        arguments: Values of ``name:=value`` arguments for a xacro.
        package_path: Additional folders to search for packages and models.
        reach: Files that an untrusted description may read; None for the user's own files.

    Raises:
        DescriptionError: The description cannot be used; the error has the location and a hint.
    """
    if reach is None and isinstance(path, str) and path.lstrip().startswith("<"):
        return load_text(path, arguments=arguments, package_path=package_path)
    return understand(open_description(path, arguments or {}, package_path, reach))


def load_robot(
    path: Path | str,
    *,
    arguments: Mapping[str, str] | None = None,
    package_path: Sequence[Path] = (),
    reach: Reach | None = None,
) -> RobotDescription:
    """Reads a file like `load`; it must describe a robot or model."""
    found = load(path, arguments=arguments, package_path=package_path, reach=reach)
    if isinstance(found, WorldDescription):
        raise DescriptionError(
            f'the file describes the world "{found.name}", not a robot',
            code=codes.WRONG_KIND,
            values={"kind": "world", "name": found.name},
            origin=found.origin,
            hint="Load the file as the world, and spawn robots into this world.",
        )
    return found


def load_world(
    path: Path | str,
    *,
    arguments: Mapping[str, str] | None = None,
    package_path: Sequence[Path] = (),
) -> WorldDescription:
    """Reads a file like `load`; it must describe a world."""
    try:
        found = load(path, arguments=arguments, package_path=package_path)
    except DescriptionError as error:
        if error.code is codes.FILE_MISSING and error.values.get("name") == str(path):
            _suggest_world(error, Path(path))
        raise
    if isinstance(found, RobotDescription):
        raise DescriptionError(
            f'the file describes the model "{found.name}", not a world',
            code=codes.WRONG_KIND,
            values={"kind": "model", "name": found.name},
            origin=found.origin,
            hint='Spawn the model into a world, such as the built-in world "empty".',
        )
    return found


def _suggest_world(error: DescriptionError, path: Path) -> None:
    """Suggests a bundled world instead of a bundled robot or model for a name without a folder."""
    named = str(error.values.get("meant", ""))
    if len(path.parts) != 1 or Path(named or "?").is_file():
        return
    worlds = bundled_worlds()
    near = meant(path.name, worlds)
    if near or not named:
        error.values = {**error.values, "meant": near}
        error.hint = f'Did you mean "{near}"?' if near else f"Bundled worlds: {', '.join(worlds)}."


def load_text(
    text: str | bytes,
    *,
    file: str = "<string>",
    arguments: Mapping[str, str] | None = None,
    package_path: Sequence[Path] = (),
) -> RobotDescription | WorldDescription:
    """Reads a description from text, such as a ``robot_description`` parameter.

    Args:
        text: The XML.
        file: File name for errors; if the file exists, packages are searched near it.
        arguments: As for `load`.
        package_path: As for `load`.
    """
    if not text.strip():
        raise DescriptionError(
            "the description is empty", code=codes.FILE_UNREADABLE, origin=Origin(file=file)
        )
    near = None if file.startswith("<") else Path(file)
    values = arguments or {}
    packages = Packages(near, package_path, arguments=values.values())
    return understand(_expand(text, file, packages, values))


def load_plain(
    text: str | bytes, *, file: str, package_path: Sequence[Path] = (), reach: Reach | None = None
) -> RobotDescription | WorldDescription:
    """Reads a description received over the network; only ``$(find …)`` is expanded.

    Args:
        text: The XML.
        file: File name for errors.
        package_path: As for `load`.
        reach: Files that it may read in addition to packages and models.

    Raises:
        DescriptionError: The description cannot be used, or must be expanded first.
    """
    if not text.strip():
        raise DescriptionError(
            "the description is empty", code=codes.FILE_UNREADABLE, origin=Origin(file=file)
        )
    packages = Packages(None, package_path, reach=reach or Reach())
    root = xml.parse(text, file)
    changed = refuse_xacro(root, packages)
    if changed:
        text = write_xml(root)
    elif isinstance(text, bytes):
        text = text.decode("utf-8", "replace")
    return understand(
        Opened(root=root, packages=packages, text=text, diagnostics=(), files=(file,))
    )


def open_description(
    path: Path | str,
    arguments: Mapping[str, str],
    package_path: Sequence[Path] = (),
    reach: Reach | None = None,
) -> Opened:
    """Finds and reads a file, and expands its xacro."""
    found = find_description(path, package_path)
    if found.suffix == ".py":
        raise DescriptionError(
            "the file is a launch file",
            code=codes.NOT_A_DESCRIPTION,
            origin=Origin(file=str(found)),
            hint=_LAUNCHED,
        )
    content = xml.read_bytes(found)
    packages = Packages(found, package_path, reach=reach, arguments=arguments.values())
    return _expand(content, xml.shown_path(found), packages, arguments)


def _expand(
    content: str | bytes, file: str, packages: Packages, arguments: Mapping[str, str]
) -> Opened:
    root = xml.parse(content, file)
    if xml.needs_xacro(root):
        # Imported here: xacro would double the startup time of simulations that do not need it.
        from cartwheel.description.xacro import expand

        expansion = expand(content, file, packages, arguments)
        return Opened(
            root=expansion.root,
            packages=packages,
            text=write_xml(expansion.root),
            diagnostics=expansion.diagnostics,
            files=expansion.files,
            arguments=expansion.arguments,
        )
    text = content if isinstance(content, str) else content.decode("utf-8", "replace")
    unused = tuple(
        codes.ARGUMENT_UNKNOWN.diagnostic(
            f'the argument "{name}" has no effect: the file does not use xacro',
            origin=Origin(file=file),
            values={"name": name, "meant": ""},
        )
        for name in arguments
    )
    return Opened(root=root, packages=packages, text=text, diagnostics=unused, files=(file,))


def understand(opened: Opened) -> RobotDescription | WorldDescription:
    """Interprets an opened description.

    Raises:
        DescriptionError: The file is not a description, or contains an error.
    """
    root = opened.root
    if opened.packages.reach is not None:
        require_files(root, opened.packages)
    if root.tag == "robot":
        from cartwheel.description.urdf import read_urdf

        made = read_urdf(
            root,
            opened.packages,
            text=opened.text,
            diagnostics=opened.diagnostics,
        )
        diagnostics = (*made.diagnostics, *opened.packages.moves())
        return replace(made, arguments=opened.arguments, diagnostics=diagnostics)
    if root.tag in ("sdf", "gazebo"):
        from cartwheel.description.sdf import read_sdf

        found = read_sdf(root, opened.packages, text=opened.text)
        diagnostics = (*opened.diagnostics, *found.diagnostics, *opened.packages.moves())
        return replace(found, diagnostics=diagnostics)
    kind, hint = _OTHER_KINDS.get(root.tag, ("", ""))
    raise root.fail(
        f"the file is {kind}" if kind else f"the root element <{root.tag}> is not supported",
        hint or "The root element must be <robot> (xacro, URDF) or <sdf> (SDF, world).",
        code=codes.NOT_A_DESCRIPTION,
    )
