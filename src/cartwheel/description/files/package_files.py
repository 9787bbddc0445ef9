"""The packages that a simulation's files can refer to, for message types."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from cartwheel.description.files.package_folders import belongs_to
from cartwheel.description.files.packages import Packages


class SimulationPackages:
    """The packages near the files of a simulation, and those in the environment.

    Nothing is searched until `folders` is called.

    Args:
        package_path: Folders to search first.
    """

    def __init__(self, package_path: Sequence[Path] = ()) -> None:
        self._package_path = tuple(package_path)
        self._near: dict[Path, Packages] = {}
        # Without a file, the workspace around the current folder is searched.
        self._elsewhere = Packages(None, self._package_path)

    def add(self, file: str | Path, package_path: Sequence[Path] = ()) -> bool:
        """Adds the workspace of a file, unless the file was received over the network.

        Returns:
            Whether more packages can be found now.
        """
        if str(file).startswith("<"):
            return False
        path = Path(file).absolute()
        if path in self._near and not package_path:
            return False
        self._near[path] = Packages(path, (*self._package_path, *package_path))
        return True

    def folders(self, package: str) -> list[Path]:
        """The folders of the packages with a name, in search order."""
        found: dict[Path, Path] = {}
        for packages in (*self._near.values(), self._elsewhere):
            for folder in packages.all_named(package):
                found.setdefault(folder.resolve(), folder)
        return list(found.values())

    def may_read(self, path: Path, folder: Path) -> bool:
        """Whether a file belongs to the package in a folder, after resolving links."""
        return belongs_to(path, folder)
