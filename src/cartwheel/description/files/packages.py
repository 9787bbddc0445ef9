"""Resolves references in descriptions: packages, models, meshes and built-in files.

Packages are first searched near the file that refers to them, so that no workspace must be sourced.
Then the environment variables of ROS 1, ROS 2 and Gazebo are used.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import NoReturn
from urllib.parse import unquote

from cartwheel.codes import files as codes
from cartwheel.codes.tags import VALUE_INVALID
from cartwheel.description.files import fuel
from cartwheel.description.files.install_rules import source_of
from cartwheel.description.files.missing_files import advice_about, missing
from cartwheel.description.files.missing_packages import how_to_install
from cartwheel.description.files.nameless_packages import about_packages
from cartwheel.description.files.other_places import FIND, Moved, Use, lacks, other_places, report
from cartwheel.description.files.package_folders import (
    around,
    is_dir,
    is_file,
    package_above,
    package_name,
    stand_in_name,
)
from cartwheel.description.files.package_search import RESOURCES, PackageSearch, Searched
from cartwheel.description.files.readable_files import (
    NAME_IT,
    Reach,
    is_below,
    is_inside,
    is_named,
    real,
)
from cartwheel.errors import DescriptionError, Diagnostic, Origin


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
        searched: Folders that others have searched for packages a moment ago.
    """

    def __init__(
        self,
        file: Path | None = None,
        package_path: Sequence[Path] = (),
        environment: Mapping[str, str] | None = None,
        *,
        reach: Reach | None = None,
        arguments: Iterable[str] = (),
        searched: Searched | None = None,
    ) -> None:
        self.reach = reach
        self._arguments = tuple(arguments)
        self.file = file.absolute() if file is not None else None
        self.package_path = tuple(Path(path).expanduser().absolute() for path in package_path)
        self._environment = os.environ if environment is None else environment
        self._search = PackageSearch(self.file, self.package_path, self._environment, searched)
        # A world may refer to a file thousands of times.
        self._searched_after: dict[tuple[Path, ...], tuple[Path, ...]] = {}
        """The answers of `_further`."""
        self._resolved: dict[tuple[str, str, bool], Path] = {}
        """The answers of `resolve`, by the URI, the file that contains it, and `folder`."""
        self.stand_ins: dict[str, Origin | None] = {}
        """The packages whose stand-ins were read, with the first element that refers to each."""
        self._needed: dict[str, Origin | None] = {}
        """The first elements that refer to packages, by the names of these."""
        self.found_elsewhere: dict[str, Moved] = {}
        """Files that are not where the description says, by the statement."""

    @property
    def folder(self) -> Path:
        """The description's folder, to which relative paths refer."""
        return self._search.folder

    def find(self, name: str, origin: Origin | None = None) -> Path:
        """The folder of a package: its source, or its ``share`` if it is installed.

        Raises:
            DescriptionError: The package was not found; the hint lists the searched folders.
        """
        if (found := self.found(name, origin)) is None:
            text, advice = f'the package "{name}" was not found', self._search.package_advice(name)
            raise missing("package", name, text, origin, advice)
        return found

    def found(self, name: str, origin: Origin | None = None) -> Path | None:
        """As `find`, without an error."""
        if self._needed.get(name) is None:
            self._needed[name] = origin
        return self._search.package(name)

    def how_to_install(self, name: str) -> str:
        """A hint on how to install a package."""
        return how_to_install(name, self._environment)

    def all_named(self, name: str) -> list[Path]:
        """The folders of all packages with a name, in search order."""
        return self._search.all_named(name)

    def find_model(self, name: str, origin: Origin | None = None) -> Path:
        """The folder of a Gazebo model, or of a package with this name.

        Raises:
            DescriptionError: Neither was found; the hint lists the searched folders.
        """
        found = self._search.model(name)
        if found is None:
            message = f'the model "{name}" was not found'
            raise missing("model", name, message, origin, self._search.model_advice(name))
        return found

    def resolve(
        self,
        uri: str,
        origin: Origin | None = None,
        *,
        what: str = "file",
        folder: bool = False,
        without: Collection[str] = (),
        use: Use = "",
    ) -> Path:
        """The existing file or model folder for a URI.

        Args:
            uri: ``package://``, ``model://``, ``file://``, ``$(find pkg)/…``, an absolute path, or
                a path relative to the description.
            origin: Origin of the URI.
            what: What it is, for the error.
            folder: Whether a folder is also accepted, as for an included model.
            without: Files that cannot be meant; see `elsewhere`.
            use: What Gazebo leaves out without the file, if this matters.

        Raises:
            DescriptionError: The file was not found; the hint lists the searched folders.
        """
        question = (uri, origin.file if origin is not None else "", folder)
        before = self._resolved.get(question)
        if before is not None and (is_file(before) or (folder and is_dir(before))):
            return before
        # Keys in their order. Most files are at the first place: the others are not looked up.
        candidates: dict[Path, None] = {}
        try:
            for path in self._candidates(uri.strip(), origin):
                if path in candidates:
                    continue
                candidates[path] = None
                for each in _unquoted(path):
                    # Without permission to read a file, its existence is not revealed.
                    if self.reach is not None and not self.may_read(each):
                        continue
                    if is_file(each) or (folder and each == path and is_dir(each)):
                        self._resolved[question] = each
                        return each
        except DescriptionError as error:
            if error.code is not codes.FILE_MISSING:
                raise
            other = self.elsewhere(uri.strip(), origin, without=without, use=use)
            if other is None:
                raise
            return other
        other = self.elsewhere(uri, origin, without=without, use=use)
        if other is not None:
            return other
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
        for path in candidates:
            package = stand_in_name(path)
            if package is not None:
                message = (
                    f'the package "{package}" was not found, and its stand-in does not contain '
                    f"the {what}"
                )
                known = self._search.package_advice(package)
                raise missing("package", package, message, origin, known)
        near = advice_about([*candidates])
        raise missing(what, uri, f'the {what} "{uri}" does not exist', origin, near)

    def elsewhere(
        self,
        uri: str,
        origin: Origin | None,
        *,
        without: Collection[str] = (),
        use: Use = "",
    ) -> Path | None:
        """The file that is meant by a path of another computer, such as its author's.

        Args:
            uri: The statement in the description.
            origin: Origin of the statement.
            without: Files that cannot be meant, such as those that contain the statement.
            use: What Gazebo leaves out without the file, if this matters.

        Returns:
            The file, which is noted in `found_elsewhere`; None if there is none.
        """
        near = (
            [self.folder] if origin is None else [Path(origin.file).absolute().parent, self.folder]
        )
        above = dict.fromkeys(each for start in near for each in (start, *start.parents))
        candidates = other_places(uri, filter(self._is_ours, above), self._search.package)
        excluded = {real(Path(each)) for each in without}
        for path in candidates:
            if is_file(path) and self.may_read(path) and real(path) not in excluded:
                moved = self.found_elsewhere.get(uri)
                if moved is None or (use and not moved.use):
                    lost = lacks(uri, self._search.package)
                    self.found_elsewhere[uri] = Moved(path, origin, use, lacking=lost)
                return path
        return None

    def _is_ours(self, folder: Path) -> bool:
        return any(folder == root or root in folder.parents for root in self._own)

    def moves(self) -> Iterator[Diagnostic]:
        """Reports the files that are not where the description says, and the packages that are in
        another repository or have no package.xml.
        """
        yield from about_packages(self._search.neighbours, self._search.nameless, self._needed)
        yield from (report(uri, moved) for uri, moved in self.found_elsewhere.items())

    def model_folders(self) -> list[Path]:
        """The folders that are searched for Gazebo models, in order."""
        return self._search.model_folders()

    def may_read(self, path: Path) -> bool:
        """Whether the description may read a file: one in its workspace or in a package.

        A description received over the network may read files in packages and models, and those in
        `reach`.
        """
        if is_inside(path, self._search.trusted):
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
        """Rejects a file that the description may not read, and notes the use of a stand-in.

        Raises:
            DescriptionError: The file may not be read; the hint says which files may.
        """
        if not self.may_read(path):
            self._refuse(f'{what} "{path}"', origin)
        stand_in = stand_in_name(path)
        inside = origin is not None and stand_in_name(Path(origin.file).absolute()) is not None
        if stand_in is not None and not inside:
            self.stand_ins.setdefault(stand_in, origin)

    def _refuse(self, what: str, origin: Origin | None) -> NoReturn:
        raise DescriptionError(
            f"{what} is outside the folders that the description may read",
            code=codes.FILE_NOT_ALLOWED,
            values={"name": what},
            origin=origin,
            hint=self.reach.hint if self.reach is not None else NAME_IT,
        )

    def _workspace(self, folder: Path) -> list[Path]:
        """The folders around a file that it may read."""
        return [
            each
            for each in around(folder)
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
            name = package_name(folder)
            if name is not None:
                known = self._search.package(name)
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
                f'"{uri}" is on the network, and Cartwheel does not download files',
                code=codes.FILE_ON_NETWORK,
                values={"kind": "file", "name": uri},
                origin=origin,
                hint="Download the file, and refer to it with model:// or package://.",
            )
        if scheme == "file":
            yield from self._relative(rest, origin)
            return
        name, _, path = rest.partition("/")
        if scheme not in ("package", "model"):
            # gz-sim finds it in folders of models, whatever the scheme is.
            with contextlib.suppress(DescriptionError):
                for found in filter(is_file, self._candidates(f"model://{rest}", origin)):
                    self.found_elsewhere.setdefault(uri, Moved(path=found, origin=origin, use=""))
                    yield found
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
        if path and scheme == "model":
            yield from (each / path for each in self._search.models(name))

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
        yield from dict.fromkeys(folder / given for folder in folders)
        yield from (folder / given for folder in self._further(tuple(folders)))

    def _further(self, folders: tuple[Path, ...]) -> tuple[Path, ...]:
        """The folders in which a relative path is searched after some folders."""
        if folders not in self._searched_after:
            # A package with gazebo_media_path exports is itself in GAZEBO_RESOURCE_PATH.
            above = [root for root in map(package_above, folders) if root is not None]
            found = [path for variable in RESOURCES for path in self._search.paths(variable)]
            self._searched_after[folders] = (*found, *above, *self.package_path)
        return self._searched_after[folders]


def _unquoted(path: Path) -> tuple[Path, ...]:
    """A path, and the one that is meant if it is part of a URI with characters such as ``%20``."""
    text = str(path)
    return (path, Path(unquote(text))) if "%" in text else (path,)


def _is_special(path: Path) -> bool:
    """Whether it is a folder, pipe, socket or device."""
    try:
        return path.exists() and not path.is_file()
    except (OSError, ValueError):
        return False
