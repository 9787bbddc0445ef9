"""The search for packages and Gazebo models: near the description, then in the environment."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path

from cartwheel.description.elements import numbers
from cartwheel.description.files import fuel
from cartwheel.description.files.missing_packages import Advice, how_to_install
from cartwheel.description.files.nameless_packages import nameless_packages
from cartwheel.description.files.package_folders import (
    PackagesByName,
    around,
    folders_in,
    is_dir,
    package_name,
    packages_below,
    packages_in,
    share,
    stand_ins,
)
from cartwheel.description.files.readable_files import with_targets
from cartwheel.description.files.repositories import MARKERS, repository_of, root_of

_ROS1 = "ROS_PACKAGE_PATH"
_PREFIXES = ("AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH", "COLCON_PREFIX_PATH")
RESOURCES = ("GAZEBO_RESOURCE_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH")
_MODELS = ("GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "SDF_PATH")

_FRESH = 1.0
"""Time for which the list of packages in a folder is reused, s. Descriptions are read faster."""


Searched = dict[tuple[Path, bool], tuple[float, PackagesByName]]
"""The packages in folders, by the folder and whether it is searched at any depth, and the times at
which the search began, s."""


class PackageSearch:
    """Finds packages and models by name. Packages that were found are remembered.

    Args:
        file: The description; None uses the current folder.
        package_path: Additional folders to search first.
        environment: Environment variables.
        searched: The folders that other searches have searched, which are also added to.
    """

    def __init__(
        self,
        file: Path | None,
        package_path: Sequence[Path],
        environment: Mapping[str, str],
        searched: Searched | None = None,
    ) -> None:
        self.file = file
        self.package_path = tuple(package_path)
        self.environment = environment
        self._packages: dict[str, Path | None] = {}
        self.neighbours: dict[str, Path] = {}
        """Packages that were found in another repository near the file, by name."""
        self.nameless: dict[str, Path] = {}
        """Folders without a package.xml that were found instead of packages, by the names of these.
        """
        self._searched: Searched = {} if searched is None else searched
        self._package_advice: dict[str, Advice] = {}
        self._model_advice: dict[str, Advice] = {}
        """By model name: a world may refer to a model many times."""

    @property
    def folder(self) -> Path:
        """The description's folder."""
        return self.file.parent if self.file is not None else Path.cwd()

    def package(self, name: str) -> Path | None:
        """The folder of a package; None if it was not found."""
        if name not in self._packages:
            self._packages[name] = self._search(name)
        return self._packages[name]

    def all_named(self, name: str) -> list[Path]:
        """The folders of all packages with a name, in search order."""
        first = self.package(name)
        if first is None:
            return []
        found = [first]
        for roots in (self.package_path, self._ancestors(), self.environment_roots()):
            for root in roots:
                found += self._in(root).all(name)
        return list(dict.fromkeys(found))

    def model(self, name: str) -> Path | None:
        """The folder of a model, or of a package with this name; None if it was not found."""
        return next(self.models(name), None)

    def models(self, name: str) -> Iterator[Path]:
        """All folders of a model, and that of a package with this name, in search order.

        Gazebo searches each of them for a file. The first may be a Python module, which is in the
        package with its name.
        """
        if not _is_plain(name):
            return
        for folder in self.model_folders():
            if is_dir(folder / name):
                yield folder / name
        package = self.package(name)
        if package is not None:
            yield package

    def model_folders(self) -> list[Path]:
        """The folders that are searched for Gazebo models, in order."""
        folders = list(self.package_path)
        for folder in self._ancestors():
            folders += [folder, folder / "models"]
        for variable in _MODELS:
            folders += self.paths(variable)
        folders += [Path("~/.gazebo/models").expanduser(), share() / "models", share() / "robots"]
        return list(dict.fromkeys(folder for folder in folders if is_dir(folder)))

    def environment_roots(self) -> Iterator[Path]:
        """The folders in the environment variables of ROS 1, ROS 2 and Gazebo."""
        yield from self.paths(_ROS1)
        for variable in _PREFIXES:
            for prefix in self.paths(variable):
                yield prefix / "share"
        for variable in _MODELS:
            yield from self.paths(variable)

    @cached_property
    def trusted(self) -> frozenset[Path]:
        """The folders that the user specified in options and variables; see `is_inside`."""
        return with_targets([
            *(*self.package_path, *self.environment_roots()),
            *(folder for variable in RESOURCES for folder in self.paths(variable)),
            *(Path("~/.gazebo/models").expanduser(), *fuel.caches(self.environment)),
            *(share() / each for each in ("models", "robots", "worlds", "standins")),
        ])  # fmt: skip

    def paths(self, variable: str) -> list[Path]:
        """The folders in an environment variable."""
        value = self.environment.get(variable, "")
        return [Path(part).expanduser() for part in value.split(os.pathsep) if part]

    def package_advice(self, name: str) -> Advice:
        """What to do about a package that was not found; the hint lists the searched folders."""
        if name not in self._package_advice:
            self._package_advice[name] = self._advise_on_package(name)
        return self._package_advice[name]

    def model_advice(self, name: str) -> Advice:
        """What to do about a model that was not found; the hint lists the searched folders."""
        if name not in self._model_advice:
            self._model_advice[name] = self._advise_on_model(name)
        return self._model_advice[name]

    def _search(self, name: str) -> Path | None:
        if not _is_plain(name):
            return None
        searches: tuple[Callable[[], Iterator[Path]], ...] = (
            lambda: iter(self.package_path),
            lambda: iter(self._ancestors()),
            self.environment_roots,
            lambda: iter((share() / "robots", share() / "models")),
        )
        for index, roots in enumerate(searches):
            if index == 1 and (own := self._own_folder(name)) is not None:
                if package_name(own) is None:
                    self.nameless[name] = own
                return own
            for root in roots():
                found = self._in(root).first(name)
                if found is not None:
                    return self._own(name, found) if index == 1 else found
        for root in self._crawled():
            found = self._in(root, crawled=True).first(name)
            if found is not None:
                return self._own(name, found)
        # A folder with the right name but without package.xml may be a description copied out of
        # its workspace: second choice, but better than failing.
        for index, roots in enumerate(searches):
            for root in roots():
                for bare in (root, root / name):
                    if bare.name == name and is_dir(bare):
                        if index == 1:
                            self.nameless[name] = bare
                        return bare
        stand_in = self._in(stand_ins()).first(name)
        if stand_in is None and (own := self._own_names.get(name)) is not None:
            self.nameless[name] = own
            return own
        return stand_in

    @cached_property
    def _own_names(self) -> dict[str, Path]:
        """The folders with the file that are meant by the names of packages."""
        return {} if self.file is None else nameless_packages(self.file)

    def _in(self, root: Path, *, crawled: bool = False) -> PackagesByName:
        """The packages of the workspace at `root`, or all below it if it is crawled."""
        now = time.monotonic()
        began, found = self._searched.get((root, crawled), (-_FRESH, None))
        if found is None or now > began + _FRESH:
            found = PackagesByName(packages_below(root) if crawled else packages_in(root))
            self._searched[root, crawled] = (now, found)
        return found

    def _own(self, name: str, found: Path) -> Path:
        """The package with this name in the repository of the file, if `found` is in another one.

        A folder with this name but without a manifest, such as that of a submodule that was not
        fetched, is none: ROS finds the package.
        """
        home = self._home
        given = (*self.package_path, *self.environment_roots())
        if home is None or found.is_relative_to(home) or any(map(found.is_relative_to, given)):
            return found
        own = self._in(home, crawled=True).first(name)
        if own is None:
            self.neighbours[name] = found
        return own or found

    @cached_property
    def _home(self) -> Path | None:
        """The repository of the file, or the folder with its package and those beside it."""
        if self.file is None:
            return None
        return repository_of(self.file) or root_of(self.file)

    def _own_folder(self, name: str) -> Path | None:
        """The folder with this name that contains the file but no manifest, if the file is in no
        package: it is meant rather than a package with the same name in another repository.
        """
        for folder in self._ancestors() if self.file is not None else ():
            if package_name(folder) is not None:
                return None
            if folder.name == name:
                return self._in(folder, crawled=True).first(name) or folder
        return None

    def _crawled(self) -> Iterator[Path]:
        """The folders that ROS searches recursively for packages."""
        yield from self.package_path
        for parent in self._ancestors():
            if parent.name == "src" or any((parent / each).exists() for each in MARKERS):
                yield parent
            elif (parent / "src").is_dir():
                yield parent / "src"
        yield from self.paths(_ROS1)

    def _ancestors(self) -> list[Path]:
        """The folders above the file, nearest first, that may be a workspace."""
        return around(self.folder)

    def _advise_on_package(self, name: str) -> Advice:
        roots = [*self.package_path, *self._ancestors(), *self.environment_roots()]
        known = {found for root in (*roots, share() / "robots") for found, _ in packages_in(root)}
        near = numbers.likely(name, known, 0.85)
        hint = f'Did you mean "{near}"? ' if near else ""
        text = (
            f"{hint}Searched: {listed([*roots, share() / 'robots'])}. "
            "Source the workspace of the package, or add its folder to the package path."
            f" {how_to_install(name, self.environment)}"
        )
        return Advice(near or "", text)

    def _advise_on_model(self, name: str) -> Advice:
        folders = self.model_folders()
        near = numbers.likely(name, {entry.name for each in folders for entry in folders_in(each)})
        hint = f'Did you mean "{near}"? ' if near else ""
        hint += "Searched: " + listed(folders)
        hint += ". Add the folder of the model to GAZEBO_MODEL_PATH or to the package path."
        return Advice(near or "", hint)


def _is_plain(name: str) -> bool:
    return bool(name) and name not in (".", "..") and "/" not in name and "\0" not in name


def listed(paths: Iterable[Path]) -> str:
    """The first six paths and the number of the others, for a hint."""
    shown = list(dict.fromkeys(str(path) for path in paths))
    more = f", and {len(shown) - 6} more" if len(shown) > 6 else ""
    return (", ".join(shown[:6]) or "nowhere") + more
