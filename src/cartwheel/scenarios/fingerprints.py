"""Fingerprints of the files that a case depends on."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from cartwheel.description.files.packages import Packages
from cartwheel.description.loading import open_description
from cartwheel.errors import CartwheelError

_NAMED = re.compile(
    r"(?:package|model|file)://[^\s\"'<>]+"
    r"|[^\s\"'<>]+\.(?:stl|dae|obj|glb|gltf|png|jpe?g|tga|tiff?|ya?ml|sdf|world|csv|mtl|material)\b",
    re.IGNORECASE,
)
_READ = (".sdf", ".world", ".urdf", ".dae", ".obj", ".material", ".mtl", ".gltf")
"""Files that name others."""
_MOST_FILES = 5000


class Fingerprints:
    """Fingerprints of descriptions and other files. Each file is read once.

    Args:
        package_path: Folders that are searched for packages.
    """

    def __init__(self, package_path: Sequence[Path] = ()) -> None:
        self._package_path = package_path
        self._contents: dict[Path, str] = {}

    def of_description(self, file: Path | str, arguments: Mapping[str, str]) -> list[str]:
        """The expanded text of a description, and the fingerprints of the files that it names.

        Raises:
            DescriptionError: The file cannot be used.
        """
        opened = open_description(file, arguments, self._package_path)
        found: dict[Path, None] = {}
        self._add_named(opened.text, opened.packages, found)
        return [opened.text, *(self.of_file(each) for each in found)]

    def of_file(self, file: Path) -> str:
        """The fingerprint of a file's contents, or an empty text if it cannot be read."""
        if file not in self._contents:
            try:
                with file.open("rb") as stream:
                    self._contents[file] = hashlib.file_digest(stream, "sha256").hexdigest()
            except OSError:
                self._contents[file] = ""
        return self._contents[file]

    def _add_named(self, text: str, packages: Packages, found: dict[Path, None]) -> None:
        """Adds the existing files that a text names, and those that these name."""
        for uri in dict.fromkeys(_NAMED.findall(text)):
            try:
                path = packages.resolve(uri, folder=uri.startswith("model://"))
            except CartwheelError:
                continue  # the load reports it if it is needed
            inside = sorted(each for each in path.rglob("*") if each.is_file())
            for each in inside if path.is_dir() else [path]:
                if each in found or len(found) >= _MOST_FILES:
                    continue
                found[each] = None
                if each.suffix.lower() in _READ:
                    try:
                        more = each.read_text("utf-8", "replace")
                    except OSError:
                        continue
                    self._add_named(more, packages, found)
