"""The launch files of a description's author, which are in the same repository."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

from cartwheel.description.files.package_folders import (
    PackagesByName,
    package_above,
    package_name,
    packages_below,
)
from cartwheel.description.files.repositories import repository_of, root_of
from cartwheel.description.launches.launch_use import LaunchUse
from cartwheel.description.launches.search import launches_near


@dataclass(frozen=True, kw_only=True, slots=True)
class OwnLaunches:
    """The launch files of a description's author."""

    folder: Path
    """The folder with the author's files, in which unnamed files may be meant.

    It is the repository. If this is unknown, it is the folder of `root_of`, or the subfolder of the
    folder that the user gave, in which the repositories may be side by side.
    """
    launches: Sequence[LaunchUse]
    """Those in the repository. If it is unknown, they are in none, and if the user gave a folder,
    those that name no description are in `folder`.

    If none of them simulates the description, those of other repositories that do are among them,
    in the folder that the user gave. The package of the description must be the only one with its
    name in this folder."""


class LaunchSearch:
    """Reads the launch files of descriptions' authors; those of each folder are read once.

    They are searched in the repository of a description, in the folder that the user gave, and near
    the description, in the folder of `root_of`.

    Args:
        package_path: Folders to search for packages first.
        given: The folder that the user gave; None for a file.
    """

    def __init__(self, package_path: Sequence[Path] = (), given: Path | None = None) -> None:
        self._given = None if given is None else given.absolute()
        self._read = cache(partial(launches_near, package_path=package_path))
        self._known: dict[Path, OwnLaunches] = {}

    def of(self, description: Path) -> OwnLaunches:
        """The launch files of a description's author."""
        known = self._known.get(description)
        if known is None:
            known = self._known[description] = self._find(description)
        return known

    def _find(self, description: Path) -> OwnLaunches:
        repository = repository_of(description)
        # The number of launch files that are read is limited, so the nearest come first.
        folders = (root_of(description), repository, self._given)
        uses: list[LaunchUse] = []
        read: list[Path] = []
        for folder in folders:
            if folder is not None and folder not in read:
                new = self._read(folder)
                uses += [each for each in new if not _is_below(each.file, read)]
                read.append(folder)
        return _own(description, uses, repository, self._given)


def own_launches(
    description: Path, uses: Iterable[LaunchUse], within: Path | None = None
) -> OwnLaunches:
    """Those of some launch files that are from a description's author.

    Args:
        description: The description.
        uses: Contents of launch files.
        within: The folder that the user gave. If it contains the package of the description, only
            files in it count.
    """
    return _own(description, uses, repository_of(description, within), within)


def _own(
    description: Path, uses: Iterable[LaunchUse], repository: Path | None, within: Path | None
) -> OwnLaunches:
    """As `own_launches`, for the repository of the description."""
    own = _folder(description.absolute(), repository, within)
    near = [(each, each.file.absolute().is_relative_to(own)) for each in uses]
    if repository is not None:
        found = [each for each, inside in near if inside]
        others = [each for each, inside in near if not inside]
        return OwnLaunches(folder=own, launches=_with_others(description, found, others, within))

    @cache
    def is_loose(folder: Path) -> bool:
        """Whether the files in a folder are in no repository; many launch files are in one."""
        return repository_of(folder / description.name, within) is None

    loose = [(each, is_loose(each.file.absolute().parent)) for each, _ in near]
    found = [
        each
        for (each, inside), (_, is_own) in zip(near, loose, strict=True)
        if is_own and (within is None or each.description is not None or inside)
    ]
    others = [each for each, is_own in loose if not is_own]
    return OwnLaunches(folder=own, launches=_with_others(description, found, others, within))


def _is_below(file: Path, folders: Sequence[Path]) -> bool:
    return any(file.is_relative_to(folder) for folder in folders)


def _with_others(
    description: Path, own: list[LaunchUse], others: Iterable[LaunchUse], within: Path | None
) -> list[LaunchUse]:
    """The launch files of a description's author, and those of other repositories.

    See `OwnLaunches.launches`. The description of a robot and its simulation are often in two
    repositories, which are side by side in a workspace.
    """
    path = description.resolve()

    def simulates(use: LaunchUse) -> bool:
        if use.description is None or use.guessed or not use.simulated:
            return False
        return use.description.resolve() == path

    if within is None or any(map(simulates, own)):
        return own
    found = [each for each in others if simulates(each)]
    return [*own, *found] if found and _is_only(description, within) else own


def _is_only(description: Path, within: Path) -> bool:
    """Whether the package of a description is the only one with its name in a folder."""
    package = package_above(description.absolute().parent)
    name = None if package is None else package_name(package)
    return name is not None and len(PackagesByName(packages_below(within)).all(name)) == 1


def _folder(file: Path, repository: Path | None, within: Path | None) -> Path:
    """See `OwnLaunches.folder`."""
    near = root_of(file) or file.parent
    home = package_above(file.parent) or file.parent
    if within is None or not home.is_relative_to(given := within.absolute()):
        return repository or near
    if repository is not None or not near.is_relative_to(given):
        return repository or given
    return near if near == given else given / near.relative_to(given).parts[0]
