"""Resolves references in descriptions: packages, models, meshes and built-in files.

Packages are first searched near the file that refers to them, so that no workspace must be sourced.
Then the environment variables of ROS 1, ROS 2 and Gazebo are used.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property, lru_cache
from pathlib import Path
from typing import NoReturn
from urllib.parse import unquote

from cartwheel.codes import files as codes
from cartwheel.codes.tags import VALUE_INVALID
from cartwheel.description import fuel, numbers
from cartwheel.description.installed import source_of
from cartwheel.description.missing import Advice, advice, also_missing
from cartwheel.description.reach import (
    NAME_IT,
    Reach,
    is_below,
    is_common,
    is_inside,
    is_named,
    real,
)
from cartwheel.errors import DescriptionError, Origin

MAX_ENTRIES = 500
"""A folder with more entries is not a workspace; only these are examined."""
MAX_CRAWLED = 20_000
"""Maximum number of folders to search below one root."""
MAX_LEVELS_UP = 5
"""How far above the file or its package a workspace may begin."""

_ROS1 = "ROS_PACKAGE_PATH"
_PREFIXES = ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH", "COLCON_PREFIX_PATH")
_MODELS = ("GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "SDF_PATH")
_RESOURCES = ("GAZEBO_RESOURCE_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH")
IGNORE_MARKERS = frozenset({"CATKIN_IGNORE", "COLCON_IGNORE", "AMENT_IGNORE"})
"""Files that exclude a folder from the search for packages."""
_SKIPPED = frozenset({"build", "devel", "log", "node_modules", "__pycache__", "proc", "sys", "dev"})
_NAME = re.compile(rb"<name>\s*([^<>\s]+)\s*</name>")
_COMMENT = re.compile(rb"<!--.*?(?:-->|\Z)", re.DOTALL)
FIND = re.compile(r"\$\(find(?:-pkg-share)?\s+([^\s()]+)\s*\)")


def share() -> Path:
    """The folder with the built-in ``robots``, ``worlds`` and ``models``.

    The repository's root in a checkout, ``cartwheel/share`` in an installed package.
    """
    package = Path(__file__).resolve().parent.parent
    installed = package / "share"
    return installed if installed.is_dir() else package.parent.parent


class Packages:
    """Resolves the URIs in one description.

    Args:
        file: The description; the workspace around it is searched first. None for a text without a
            file, which uses the current folder.
        package_path: Additional folders to search first: packages, folders with packages, or
            folders with models.
        environment: For tests; `os.environ` otherwise.
        reach: Files that a description received over the network may read; None for a file from the
            user.
        arguments: Values of the user's arguments, which may be file names.
    """

    def __init__(
        self,
        file: Path | None = None,
        package_path: Sequence[Path] = (),
        environment: Mapping[str, str] | None = None,
        *,
        reach: Reach | None = None,
        arguments: Iterable[str] = (),
    ) -> None:
        self.reach = reach
        self._arguments = tuple(arguments)
        self.file = file.absolute() if file is not None else None
        self.package_path = tuple(Path(path).expanduser().absolute() for path in package_path)
        self._environment = os.environ if environment is None else environment
        self._found: dict[str, Path | None] = {}
        self._lacking: dict[str, Advice] = {}
        """By model: a world may refer to one many times."""
        self._hints: dict[str, Advice] = {}
        """The same for packages."""

    @property
    def folder(self) -> Path:
        """The description's folder, to which relative paths refer."""
        return self.file.parent if self.file is not None else Path.cwd()

    def find(self, name: str, origin: Origin | None = None) -> Path:
        """The folder of a package: its source, or its ``share`` if it is installed.

        Raises:
            DescriptionError: The package was not found; the hint lists the searched folders.
        """
        found = self._known(name)
        if found is None:
            raise _missing(
                "package", name, f'the package "{name}" was not found', origin, self._missing(name)
            )
        return found

    def all_named(self, name: str) -> list[Path]:
        """The folders of all packages with a name, in search order."""
        first = self._known(name)
        if first is None:
            return []
        found = [first]
        for roots in (self.package_path, self._ancestors(), self._environment_roots()):
            for root in roots:
                found += [each for each in (root, *_nested(root)) if _package_name(each) == name]
        return list(dict.fromkeys(found))

    def find_model(self, name: str, origin: Origin | None = None) -> Path:
        """The folder of a Gazebo model, or of a package with this name.

        Raises:
            DescriptionError: Neither was found; the hint lists the searched folders.
        """
        if _is_plain(name):
            for folder in self.model_folders():
                if _is_dir(folder / name):
                    return folder / name
            if (found := self._known(name)) is not None:
                return found
        if name not in self._lacking:
            self._lacking[name] = self._without_model(name)
        raise _missing(
            "model", name, f'the model "{name}" was not found', origin, self._lacking[name]
        )

    def resolve(
        self, uri: str, origin: Origin | None = None, *, what: str = "file", folder: bool = False
    ) -> Path:
        """The existing file or model folder for a URI.

        Args:
            uri: ``package://``, ``model://``, ``file://``, ``$(find pkg)/…``, an absolute path, or
                a path relative to the description.
            origin: Origin of the URI.
            what: What it is, for the error.
            folder: Whether a folder is also accepted, as for an included model.

        Raises:
            DescriptionError: The file was not found; the hint lists the searched folders.
        """
        candidates = list(dict.fromkeys(self._candidates(uri.strip(), origin)))
        for path in candidates:
            for each in dict.fromkeys((path, Path(unquote(str(path))))):
                # Without permission to read a file, its existence is not revealed.
                if self.reach is not None and not self.may_read(each):
                    continue
                if _is_file(each) or (folder and each == path and _is_dir(each)):
                    return each
        if self.reach is not None and not any(map(self.may_read, candidates)):
            self._refuse(f'the {what} "{uri}"', origin)
        allowed = (each for each in candidates if self.reach is None or self.may_read(each))
        if any(map(_is_special, allowed)):
            raise DescriptionError(
                f'the {what} "{uri}" is not a regular file',
                code=codes.FILE_UNREADABLE,
                origin=origin,
                values={"kind": what, "name": uri},
            )
        raise _missing(what, uri, f'the {what} "{uri}" does not exist', origin, _absent(candidates))

    def model_folders(self) -> list[Path]:
        """The folders that are searched for Gazebo models, in order."""
        folders = list(self.package_path)
        for folder in self._ancestors():
            folders += [folder, folder / "models"]
        for variable in _MODELS:
            folders += self._paths(variable)
        folders += [Path("~/.gazebo/models").expanduser(), share() / "models", share() / "robots"]
        return list(dict.fromkeys(folder for folder in folders if _is_dir(folder)))

    def may_read(self, path: Path) -> bool:
        """Whether the description may read a file: one in its workspace or in a package.

        A description received over the network may read files in packages and models, and those in
        `reach`.
        """
        if any(is_inside(path, root) for root in self._trusted()):
            return True
        if any(is_below(path, root) for root in self._own) or self._in_package(path):
            return True
        return self.reach is None and is_named(path, self._arguments, self.folder)

    @cached_property
    def _own(self) -> tuple[Path, ...]:
        """Folders that it may read, except through links to other locations."""
        if self.reach is not None:
            return self.reach.folders
        file = real(self.file) if self.file is not None else None
        folders = [self.folder, *([file.parent] if file is not None else [])]
        return tuple(dict.fromkeys(root for each in folders for root in self._workspace(each)))

    def require(self, path: Path, what: str, origin: Origin | None = None) -> None:
        """Rejects a file that the description may not read.

        Raises:
            DescriptionError: The file may not be read; the hint says which files may.
        """
        if not self.may_read(path):
            self._refuse(f'{what} "{path}"', origin)

    def _refuse(self, what: str, origin: Origin | None) -> NoReturn:
        raise DescriptionError(
            f"{what} is outside the folders that the description may read",
            code=codes.FILE_NOT_ALLOWED,
            values={"name": what},
            origin=origin,
            hint=self.reach.hint if self.reach is not None else NAME_IT,
        )

    def _trusted(self) -> Iterator[Path]:
        """Folders that the user specified in options and variables."""
        yield from self.package_path
        yield from self._environment_roots()
        for variable in _RESOURCES:
            yield from self._paths(variable)
        yield from (Path("~/.gazebo/models").expanduser(), *fuel.caches(self._environment))
        yield from (share() / each for each in ("models", "robots", "worlds"))

    def _workspace(self, folder: Path) -> list[Path]:
        """The folders around a file that it may read."""
        return [
            each
            for each in self._around(folder)
            if each == folder
            or each.parent != Path(each.anchor)
            or any((each / name).exists() for name in ("src", "package.xml"))
        ]

    def _in_package(self, path: Path) -> bool:
        """Whether a file is in a package that is found by its name."""
        file = real(path)
        if file is None:
            return False
        for folder in file.parents:
            name = _package_name(folder)
            if name is not None:
                known = self._known(name)
                return known is not None and real(known) == folder and is_below(path, folder)
        return False

    def _candidates(self, uri: str, origin: Origin | None) -> Iterator[Path]:
        uri = FIND.sub(lambda match: str(self.find(match[1], origin)), uri)
        scheme, separator, rest = uri.partition("://")
        if not separator:
            yield from self._relative(uri, origin)
            return
        if scheme in ("http", "https"):
            downloaded = fuel.cached(uri, self._environment)
            if downloaded is not None:
                yield downloaded
                return
            raise DescriptionError(
                f'"{uri}" is on the network and is not downloaded',
                code=codes.FILE_ON_NETWORK,
                values={"kind": "file", "name": uri},
                origin=origin,
                hint="Download it, and refer to it with model:// or package://.",
            )
        if scheme == "file":
            yield from self._relative(rest, origin)
            return
        name, _, path = rest.partition("/")
        if scheme not in ("package", "model"):
            raise DescriptionError(
                f'"{uri}" has the unknown scheme "{scheme}"',
                code=VALUE_INVALID,
                values={"name": uri},
                origin=origin,
                hint="Use a package://, model:// or file:// URI.",
            )
        if not name:
            raise DescriptionError(
                f'"{uri}" does not contain the name of a {scheme}',
                code=VALUE_INVALID,
                values={"name": uri},
                origin=origin,
            )
        found = self.find(name, origin) if scheme == "package" else self.find_model(name, origin)
        yield found / path
        if path:
            yield source_of(found / path)

    def _relative(self, path: str, origin: Origin | None) -> Iterator[Path]:
        if not path:
            raise DescriptionError("the file name is empty", code=VALUE_INVALID, origin=origin)
        given = Path(path)
        if given.is_absolute():
            yield given
            return
        folders = [self.folder]
        if origin is not None and not origin.file.startswith("<"):
            folders.insert(0, Path(origin.file).absolute().parent)
        # A package with gazebo_media_path exports is itself in GAZEBO_RESOURCE_PATH.
        above = [root for root in map(_package_above, folders) if root is not None]
        for variable in _RESOURCES:
            folders += self._paths(variable)
        folders += above
        yield from dict.fromkeys(folder / given for folder in (*folders, *self.package_path))

    def _search(self, name: str) -> Path | None:
        if not _is_plain(name):
            return None
        searches: tuple[Callable[[], Iterator[Path]], ...] = (
            lambda: iter(self.package_path),
            self._workspaces,
            self._environment_roots,
            lambda: iter((share() / "robots", share() / "models")),
        )
        for roots in searches:
            for root in roots():
                found = _package_in(root, name)
                if found is not None:
                    return found
        for root in self._crawled():
            found = _package_below(root, name)
            if found is not None:
                return found
        # A folder with the right name but without package.xml may be a description copied out of
        # its workspace: second choice, but better than failing.
        for roots in searches:
            for root in roots():
                for bare in (root, root / name):
                    if bare.name == name and _is_dir(bare):
                        return bare
        return None

    def _crawled(self) -> Iterator[Path]:
        """The folders that ROS searches recursively for packages."""
        yield from self.package_path
        for parent in self._ancestors():
            if parent.name == "src" or (parent / ".git").exists():
                yield parent
            elif (parent / "src").is_dir():
                yield parent / "src"
        yield from self._paths(_ROS1)

    def _environment_roots(self) -> Iterator[Path]:
        yield from self._paths(_ROS1)
        for variable in _PREFIXES:
            for prefix in self._paths(variable):
                yield prefix / "share"
        for variable in _MODELS:
            yield from self._paths(variable)

    def _paths(self, variable: str) -> list[Path]:
        value = self._environment.get(variable, "")
        return [Path(part).expanduser() for part in value.split(os.pathsep) if part]

    def _ancestors(self) -> list[Path]:
        """The folders above the file, nearest first, that may be a workspace."""
        return self._around(self.folder)

    @staticmethod
    def _around(folder: Path) -> list[Path]:
        parents = [folder, *folder.parents]
        levels = MAX_LEVELS_UP
        for index, parent in enumerate(parents):
            if (parent / "package.xml").is_file():
                levels = max(levels, index + MAX_LEVELS_UP)
        chosen = []
        for parent in parents[:levels]:
            # Shared folders are slow to read, and folders for temporary files contain anyone's
            # files.
            if is_common(parent):
                break
            chosen.append(parent)
        return chosen or parents[:1]

    def _workspaces(self) -> Iterator[Path]:
        yield from self._ancestors()

    def _missing(self, name: str) -> Advice:
        if name not in self._hints:
            self._hints[name] = self._hint(name)
        return self._hints[name]

    def _hint(self, name: str) -> Advice:
        roots = [*self.package_path, *self._ancestors(), *self._environment_roots()]
        known = {found for root in (*roots, share() / "robots") for found in _names_in(root)}
        near = numbers.likely(name, known, 0.85)
        hint = f'Did you mean "{near}"? ' if near else ""
        others = () if near else also_missing([self.file] if self.file else [], name, self._known)
        text = (
            f"{hint}Searched: {_listed([*roots, share() / 'robots'])}. "
            f"Source its workspace, or add its folder to the package path."
            f" {advice(name, others, self._environment)}"
        )
        return Advice(near or "", text, others)

    def _without_model(self, name: str) -> Advice:
        folders = self.model_folders()
        near = numbers.likely(name, {entry.name for each in folders for entry in _folders(each)})
        hint = f'Did you mean "{near}"? ' if near else ""
        hint += "Searched: " + _listed(folders)
        hint += ". Add its folder to GAZEBO_MODEL_PATH or to the package path."
        return Advice(near or "", hint)

    def _known(self, name: str) -> Path | None:
        if name not in self._found:
            self._found[name] = self._search(name)
        return self._found[name]


def belongs_to(path: Path, home: Path) -> bool:
    """Whether a file is in the folder of a package or model, after resolving links.

    Links in an installed package may lead to its source, which has the same name.
    """
    real, home = path.resolve(), home.resolve()
    if real.is_relative_to(home):
        return True
    source = next((each for each in real.parents if _is_file(each / "package.xml")), None)
    return source is not None and _package_name(source) == _package_name(home)


def _package_above(folder: Path) -> Path | None:
    """The package that contains a folder."""
    near = [folder, *folder.parents][:MAX_LEVELS_UP]
    return next((each for each in near if _is_file(each / "package.xml")), None)


def _package_in(root: Path, name: str) -> Path | None:
    """The package with this name at `root`, or at most one folder below."""
    return next((f for f in (root, *_nested(root)) if _package_name(f) == name), None)


def _package_below(root: Path, name: str) -> Path | None:
    """The package with this name at any depth; packages do not contain other packages."""
    level = [root]
    looked = 0
    while level and looked < MAX_CRAWLED:
        below = []
        for folder in level:
            for each in _folders(folder):
                looked += 1
                declared = _package_name(each)
                if declared == name:
                    return each
                if declared is None:
                    below.append(each)
        level = below
    return None


def _nested(root: Path) -> Iterator[Path]:
    """The folders in which a package of the workspace at `root` may be, nearest first."""
    first = list(_folders(root))
    yield from first
    for folder in first:
        if _package_name(folder) is not None:
            continue
        second = list(_folders(folder))
        yield from second
        if folder.name in ("src", "install", "share"):
            for inner in second:
                if _package_name(inner) is None:
                    yield from _folders(inner)
                    yield from _folders(inner / "share")


def _names_in(root: Path) -> Iterator[str]:
    for folder in (root, *_nested(root)):
        found = _package_name(folder)
        if found is not None:
            yield found


@lru_cache(maxsize=4096)
def _listing(folder: Path, _changed: int) -> tuple[Path, ...]:
    names = []
    try:
        with os.scandir(folder) as entries:
            for count, entry in enumerate(entries):
                if count >= MAX_ENTRIES:
                    break
                if entry.name in IGNORE_MARKERS:
                    return ()
                hidden = entry.name.startswith(".") or entry.name in _SKIPPED
                if not hidden and entry.is_dir():
                    names.append(entry.name)
    except OSError:
        return ()
    return tuple(folder / name for name in sorted(names))


def _folders(folder: Path) -> tuple[Path, ...]:
    """The subfolders, except those that cannot contain packages."""
    try:
        changed = folder.stat().st_mtime_ns
    except (OSError, ValueError):
        return ()
    return _listing(folder, changed)


@lru_cache(maxsize=4096)
def _declared_name(manifest: Path, _changed: int) -> str | None:
    if not _is_file(manifest):
        return None
    try:
        with manifest.open("rb") as file:
            match = _NAME.search(_COMMENT.sub(b"", file.read(16384)))
    except OSError:
        return None
    return match[1].decode("utf-8", "replace") if match else manifest.parent.name


def _package_name(folder: Path) -> str | None:
    """The name in the folder's package.xml; None without one."""
    manifest = folder / "package.xml"
    try:
        changed = manifest.stat().st_mtime_ns
    except (OSError, ValueError):
        return None
    return _declared_name(manifest, changed)


def _is_plain(name: str) -> bool:
    return bool(name) and name not in (".", "..") and "/" not in name and "\0" not in name


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _is_dir(path: Path) -> bool:
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def _is_special(path: Path) -> bool:
    """Whether it is a folder, pipe, socket or device."""
    try:
        return path.exists() and not path.is_file()
    except (OSError, ValueError):
        return False


def _missing(
    kind: str, name: str, message: str, origin: Origin | None, advice: Advice
) -> DescriptionError:
    """The error for a file, package or model that does not exist.

    Args:
        kind: What it is.
        name: The name in the file.
        message: The error's message.
        origin: The element with the name.
        advice: What to do.
    """
    more = {"others": advice.others} if advice.others else {}
    return DescriptionError(
        message,
        code=codes.FILE_MISSING,
        origin=origin,
        hint=advice.hint,
        values={"kind": kind, "name": name, "meant": advice.meant, **more},
    )


def _absent(candidates: Sequence[Path]) -> Advice:
    """The likely file name, and a hint with the searched locations."""
    for path in candidates:
        try:
            names = [
                entry.name for _, entry in zip(range(2000), path.parent.iterdir(), strict=False)
            ]
        except (OSError, ValueError):
            continue
        near = numbers.likely(path.name, names)
        if near:
            return Advice(near, f'Did you mean "{near}"? Searched: {_listed(candidates)}.')
    return Advice("", f"Searched: {_listed(candidates)}.")


def _listed(paths: Iterable[Path]) -> str:
    shown = list(dict.fromkeys(str(path) for path in paths))
    more = f", and {len(shown) - 6} more" if len(shown) > 6 else ""
    return (", ".join(shown[:6]) or "nowhere") + more
