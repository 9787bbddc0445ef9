"""Finds the robots in a folder: files that a user would load, without included files."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Literal

from cartwheel.codes.files import FILE_MISSING, XACRO_NAME_UNKNOWN
from cartwheel.corpus.movers import is_mover
from cartwheel.corpus.worlds import mounted, robots_in_worlds, text_of, worlds_in
from cartwheel.description.elements.node import Node
from cartwheel.description.files.named_files import find_description
from cartwheel.description.files.package_folders import package_above, package_name
from cartwheel.description.files.source_folders import source_folders
from cartwheel.description.launches.launch_use import LaunchUse
from cartwheel.description.launches.variants import SUFFIXES
from cartwheel.description.loading import open_description, understand
from cartwheel.errors import DescriptionError
from cartwheel.similar_names import meant

_SEMANTICS = (".srdf", ".srdf.xacro")
"""MoveIt's files, which begin like a robot."""
_ROOT = re.compile(r"<(robot|sdf|gazebo)\b")
_ROBOT, _NAMED = re.compile(r"<robot\b([^<>]*)>"), re.compile(r"\sname\s*=")
_INCLUDE = re.compile(
    r"""<(?:xacro:)?include\b[^<>]*?\bfilename\s*=\s*["']([^"']+)["']""", re.DOTALL
)
_LINK = re.compile(r"""<link\s[^<>]*?\bname\s*=\s*["']([^"']*)["']""")
_LONGEST = 4096
"""Maximum length of a path in Linux."""
_FIND = re.compile(r"\$\(find(?:-pkg-share)?\s+([^\s()]+)\s*\)")
_WORLDS = (".world", ".world.xacro", ".world.sdf")
_ACTIVE = re.compile(r"""<(?:plugin|sensor|include|joint\b[^<>]*?\btype\s*=\s*["'](?!fixed))\b""")
"""Elements of an SDF model that is not scenery. An included model may contain the others."""
_TO_WORLD = re.compile(r"<(?:parent|child)>\s*world\s*<")
_OF_ONE_JOINT = re.compile(r"joint")
"""Names of movers of single joints, such as those of a gimbal."""
_PLUGIN = re.compile(r"""<plugin\b[^<>]*?\bfilename\s*=\s*["']([^"']+)["']""", re.DOTALL)
_DEFINED = {
    "property": r"""<(?:xacro:)?property\b[^<>]*?\bname\s*=\s*["']{}["']""",
    "macro": r"""<(?:xacro:)?macro\b[^<>]*?\bname\s*=\s*["'](?:xacro:)?{}["']""",
    "argument": r"""<(?:xacro:)?arg\b[^<>]*?\bname\s*=\s*["']{}["']""",
}
"""Definitions by the kind of name."""
_MACRO, _MACRO_END = re.compile(r"<(?:xacro:)?macro\b"), re.compile(r"</(?:xacro:)?macro\s*>")
_USED = re.compile(
    r"<(?:link|joint|gazebo|xacro:(?!(?:include|macro|property|arg|if|unless)\b)\w+)\b"
)
"""What a description contains beside definitions: elements, and calls of macros."""
_OF_ROBOTS = frozenset({"plugin", "sensor", "transmission", "ros2_control"})
"""Elements of a URDF that is more than a part without commands."""
_ROOT_LINK = re.compile(r"base|robot|root|world|map|odom", re.IGNORECASE)
"""Beginnings of the names of root links."""
_VARIABLE = re.compile(r"\$\{[^}]*\}|\$\([^)]*\)")


Kind = Literal["macros", "part", "world", "scenery", "old version"]
"""Why a file is not a robot.

- ``macros``: the file defines only macros or properties.
- ``part``: the file is a part of a robot: a description in a launch file includes it; or it is not
  complete, and another file includes it; or it refers to links, macros, properties or arguments
  that another file defines; or it has no link of its own, and its macros attach theirs to a link
  that does not exist; or all its links hang below one joint whose parent does not exist, without
  plugins; or its ``<robot>`` has no name, and no plugin that moves it; or it is an SDF model that
  another model includes, but no world and no launch file, and that is not fixed to the world and
  has no plugin that moves more than single joints.
- ``world``: the file is a world.
- ``scenery``: the file is an SDF model without plugins, sensors and movable joints.
- ``old version``: the file of a model that its ``model.config`` does not choose.
"""


@dataclass(frozen=True, kw_only=True, slots=True)
class Survey:
    """The descriptions in a folder, sorted by path."""

    robots: tuple[Path, ...]
    skipped: tuple[tuple[Path, Kind], ...] = ()
    """Files that are not robots, each with the reason."""
    in_worlds: tuple[tuple[Path, str], ...] = ()
    """Worlds, each with the name of a model that plugins move."""


def survey(
    folder: Path,
    *,
    arguments: Mapping[str, str] = MappingProxyType({}),
    package_path: Sequence[Path] = (),
    launches: Iterable[LaunchUse] = (),
) -> Survey:
    """Sorts the descriptions in a folder and its subfolders into robots and other files, and finds
    the robots that are written in worlds.

    Unreadable files count as robots, unless they are parts, so that the test reports the error.

    Args:
        folder: A folder, or a single description, which is a robot.
        arguments: Arguments of the descriptions that declare them.
        package_path: Additional folders to search for packages.
        launches: Contents of launch files. The descriptions that they name are neither parts nor
            scenery.
    """
    in_worlds = tuple(robots_in_worlds(folder, package_path))
    worlds: list[tuple[Path, Kind]] = [(path, "world") for path in worlds_in(folder)]
    if folder.is_file():
        robots = () if in_worlds or worlds else (folder,)
        return Survey(robots=robots, in_worlds=in_worlds, skipped=() if in_worlds else (*worlds,))
    files = list(_files(folder))
    texts = {path: text for path in files if (text := _text(path)) is not None}
    launches = list(launches)
    used = frozenset(
        each.description.resolve()
        for each in launches
        if each.description is not None and not each.guessed
    )
    whole = _Folder(
        texts=texts,
        included=_included(texts.values()),
        launched=used,
        passed=frozenset(name for each in launches for name in each.arguments),
        parts=_included(text for path, text in texts.items() if path.resolve() in used),
        mounted=mounted(texts, [path for path, _ in worlds]),
        arguments=arguments,
        package_path=package_path,
    )
    kinds = {path: whole.kind(path) for path in texts}
    skipped = [(path, kind) for path, kind in kinds.items() if kind is not None]
    skipped += [each for each in worlds if each[0] not in kinds]
    return Survey(
        robots=tuple(path for path, kind in kinds.items() if kind is None),
        skipped=tuple(sorted(skipped)),
        in_worlds=in_worlds,
    )


def robots_in(folder: Path, *, package_path: Sequence[Path] = ()) -> list[Path]:
    """The complete robot descriptions in a folder and its subfolders, sorted by path; see `survey`.

    Args:
        folder: A folder, or a single description.
        package_path: Additional folders to search for packages.
    """
    return list(survey(folder, package_path=package_path).robots)


def _included(texts: Iterable[str]) -> list[re.Pattern[str]]:
    names = {name for text in texts for name in _INCLUDE.findall(text)}
    return [pattern for name in sorted(names) if (pattern := _pattern(name)) is not None]


@dataclass(frozen=True, kw_only=True)
class _Folder:
    texts: Mapping[Path, str]
    """Texts of all descriptions, without comments."""
    included: Sequence[re.Pattern[str]]
    """Patterns for the ends of the paths of included files."""
    launched: frozenset[Path]
    passed: frozenset[str]
    """Names of the arguments that launch files pass to descriptions."""
    arguments: Mapping[str, str]
    """Those that the user stated."""
    package_path: Sequence[Path]
    parts: Sequence[re.Pattern[str]]
    """Patterns for the ends of the paths of files that launched descriptions include."""
    mounted: Set[Path]
    """Folders of the SDF models that other models include, but no world."""

    def kind(self, path: Path) -> Kind | None:
        """Why a file is not a robot; None for a robot."""
        launched = path.resolve() in self.launched
        places = _places(path)
        part = not launched and _is_among(self.included, places)
        if path.name.endswith(_WORLDS):
            return "world"
        try:
            opened = open_description(path, self.arguments, self.package_path)
            root = opened.root
            if root.tag != "robot":
                return self._sdf_kind(path, root, launched=launched)
            if not root.all("link"):
                return "macros"
            if launched:
                return None
            if _is_among(self.parts, places):
                return "part"
            if part:
                understand(opened)
        except DescriptionError as error:
            if path.suffix == ".sdf" and not _is_chosen(path):
                return "old version"
            if not launched and _only_defines(self.texts[path]):
                return "macros"
            if not launched:
                part = part or self._is_elsewhere(path, error)
                part = part or self._is_nameless(path, error)
            return "part" if part else None
        is_part = (part or path.suffix == ".xacro") and (
            ("name" not in root.attributes and (part or not _moves(self.texts[path])))
            or self._hangs(path, root)
            or _only_attaches(self.texts[path], root)
        )
        return "part" if is_part or _is_fragment(root) else None

    def _sdf_kind(self, path: Path, root: Node, *, launched: bool) -> Kind | None:
        if root.tag not in ("sdf", "gazebo") or not root.all("model"):
            return "world"
        if not _is_chosen(path):
            return "old version"
        text = self.texts[path]
        if not launched and not _ACTIVE.search(text):
            return "scenery"
        if not launched and path.parent in self.mounted and not _is_base(text):
            return "part"
        return None

    def _is_elsewhere(self, path: Path, error: DescriptionError) -> bool:
        """Whether xacro fails because a name is unknown that another file defines."""
        kind, name = error.values.get("kind"), error.values.get("name")
        if error.code is not XACRO_NAME_UNKNOWN:
            return False
        if not isinstance(kind, str) or not isinstance(name, str):
            return False
        if kind == "argument" and name in self.passed:
            return True
        found = re.compile(
            _DEFINED.get(kind, r"(?!)").format(re.escape(name.removeprefix("xacro:"))), re.DOTALL
        )
        return any(found.search(text) for other, text in self.texts.items() if other != path)

    def _is_nameless(self, path: Path, error: DescriptionError) -> bool:
        """Whether a xacro that needs a file or a name, such as that of an argument, has a
        ``<robot>`` without a name that no plugin moves.
        """
        if error.code not in (FILE_MISSING, XACRO_NAME_UNKNOWN):
            return False
        text = self.texts[path]
        root = _ROBOT.search(text)
        nameless = root is not None and not _NAMED.search(root[1])
        return path.suffix == ".xacro" and nameless and not _moves(text)

    def _hangs(self, path: Path, root: Node) -> bool:
        """Whether a joint connects the file's links to a link that only another file contains."""
        parents = _missing_parents(root)
        return any(parents & self._links[other] for other in self.texts if other != path)

    @cached_property
    def _links(self) -> Mapping[Path, frozenset[str]]:
        """The names of the links in each text."""
        return {path: frozenset(_LINK.findall(text)) for path, text in self.texts.items()}


def _places(path: Path) -> list[str]:
    """A file's path, and that below the name of its package, whose folder may have another name."""
    package = package_above(path.parent)
    name = package_name(package) if package is not None else None
    if package is None or name is None:
        return [path.as_posix()]
    return [path.as_posix(), f"/{name}/{path.relative_to(package).as_posix()}"]


def _is_among(patterns: Sequence[re.Pattern[str]], places: Sequence[str]) -> bool:
    return any(one.search(place) for one in patterns for place in places)


def _missing_parents(root: Node) -> set[str]:
    """The parents of joints that the description does not define."""
    links = {each.attributes.get("name", "") for each in root.children if each.tag == "link"}
    parents = {
        each.attributes.get("link", "")
        for joint in root.children
        if joint.tag == "joint"
        for each in joint.children
        if each.tag == "parent"
    }
    return parents - links - {"", "world"}


def _is_fragment(root: Node) -> bool:
    """Whether all links hang below one joint whose parent is a link of another robot.

    The parent may also be the root link that a robot lacks by mistake: if the robot has plugins,
    sensors or joints to command, or by the name of the parent.
    """
    missing = _missing_parents(root)
    parents, children = (
        [each.attributes.get("link", "") for joint in root.all("joint") for each in joint.all(end)]
        for end in ("parent", "child")
    )
    links = {each.attributes.get("name", "") for each in root.all("link")}
    tags = {each.tag for each in root.children}
    tags |= {each.tag for tag in root.all("gazebo") for each in tag.children}
    if sum(each in missing for each in parents) != 1 or not tags.isdisjoint(_OF_ROBOTS):
        return False
    (parent,) = missing
    return links <= {*children} and not _ROOT_LINK.match(parent) and not meant(parent, links)


def _is_base(text: str) -> bool:
    """Whether an SDF model is fixed to the world, or plugins move more than single joints of it."""
    movers = [name for name in _PLUGIN.findall(text) if is_mover(name)]
    return bool(_TO_WORLD.search(text)) or not all(_OF_ONE_JOINT.search(name) for name in movers)


def _moves(text: str) -> bool:
    """Whether a description contains a plugin that moves a robot or its joints."""
    return any(is_mover(name) for name in _PLUGIN.findall(text))


def _only_attaches(text: str, root: Node) -> bool:
    """Whether a file consists of macro calls that attach sensors to a link of another robot."""
    return not re.search(r"<link\b", text) and bool(_missing_parents(root))


def _files(folder: Path) -> Iterator[Path]:
    for here, names in source_folders(folder):
        if "worlds" in here.relative_to(folder).parts and "model.config" not in names:
            continue  # of the files of worlds, only their models can be robots
        for name in names:
            if name.endswith(SUFFIXES) and not name.endswith(_SEMANTICS):
                yield here / name


def _text(path: Path) -> str | None:
    """A description's text without comments; None for any other file."""
    text = text_of(path)
    return text if _ROOT.search(text) else None


def _pattern(name: str) -> re.Pattern[str] | None:
    """A pattern for the end of an included file's path; None if nothing of the path is known."""
    if len(name) > _LONGEST:
        return None
    known = _VARIABLE.sub("*", _FIND.sub(r"\1", name.strip()))
    known = known.removeprefix("file://").removeprefix("package://").lstrip("./")
    parts = [_part(part) for part in known.split("/") if part]
    if not re.search(r"\w", known.removesuffix(".xacro").removesuffix(".urdf")):
        return None
    return re.compile("/" + "/".join(parts) + "$")


def _part(name: str) -> str:
    """A pattern for the name of a file or folder with unknown parts.

    What precedes the last unknown part is found once. Otherwise, the time would grow exponentially.
    """
    first, *rest = (re.escape(piece) for piece in name.split("*"))
    if not rest:
        return first
    *between, last = rest
    return first + "".join(f"(?>[^/]*?{piece})" for piece in between) + f"[^/]*{last}"


def _only_defines(text: str) -> bool:
    """Whether a xacro only defines macros, although its includes cannot be expanded alone."""
    rest, place = [], 0
    while (macro := _MACRO.search(text, place)) and (end := _MACRO_END.search(text, macro.end())):
        rest.append(text[place : macro.start()])
        place = end.end()
    rest.append(text[place:])
    return len(rest) > 1 and not _USED.search("".join(rest))


def _is_chosen(path: Path) -> bool:
    """Whether a model file is the one in its model.config, which may also list older versions."""
    if not (path.parent / "model.config").is_file():
        return True
    try:
        return path.samefile(find_description(path.parent))
    except DescriptionError:
        # The model.config refers to a file that does not exist.
        return True
