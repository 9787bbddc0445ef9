"""Meshes and textures for remote programs that display robots."""

from __future__ import annotations

import contextlib
import os
import re
import stat
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from cartwheel.description.files.package_folders import belongs_to
from cartwheel.description.files.packages import Packages
from cartwheel.errors import CartwheelError

if TYPE_CHECKING:
    from cartwheel.description.model import RobotDescription
    from cartwheel.session import Session

SHAPES = frozenset({".stl", ".dae", ".obj", ".mtl", ".ply", ".glb", ".gltf", ".bin"})
PICTURES = frozenset({".png", ".jpg", ".jpeg", ".tif", ".tiff", ".tga", ".bmp", ".webp"})
LARGEST = 200 << 20
"""Maximum size of a file to send, bytes."""
_FILE = re.compile(r'file://[^"\'<>\s]+')


class Assets:
    """Returns files that a simulation's models refer to, by URI.

    Only meshes and images are returned: with ``package://`` and ``model://`` from packages and
    models; with ``file://`` those that a description refers to and files near them, if the
    description itself was read from a file. A description received over the network could contain
    any file name.

    Args:
        session: The session with the models.
        package_path: Folders to search for packages first.
    """

    def __init__(self, session: Session, package_path: Sequence[Path]) -> None:
        self._session = session
        self._package_path = package_path

    def __call__(self, uri: str) -> bytes | None:
        """The contents, or None if the file is not available."""
        plain = unquote(uri)
        # `Packages` expands $(find ...), which no mesh URI contains at this point.
        if ".." in plain.split("/") or any(sign in plain for sign in "\0\\$"):
            return None
        scheme, _, rest = plain.partition("://")
        with contextlib.suppress(OSError, ValueError):
            if scheme in ("package", "model"):
                return self._in_package(uri)
            if scheme == "file":
                return self._named(Path(rest))
        return None

    def _in_package(self, uri: str) -> bytes | None:
        scheme, _, rest = uri.partition("://")
        name = rest.partition("/")[0]
        files = (model.origin.file for model in self._models())
        for file in dict.fromkeys(files):
            packages = Packages(None if file.startswith("<") else Path(file), self._package_path)
            with contextlib.suppress(CartwheelError):
                found = packages.resolve(uri)
                home = packages.find(name) if scheme == "package" else packages.find_model(name)
                return _content(found) if belongs_to(found, home) else None
        return None

    def _named(self, path: Path) -> bytes | None:
        folders = {
            Path(unquote(found).removeprefix("file://")).parent.resolve()
            for model in self._models()
            if not model.origin.file.startswith("<")
            for found in _FILE.findall(model.text)
        }
        return _content(path) if path.resolve().parent in folders else None

    def _models(self) -> Iterator[RobotDescription]:
        return (placed.description for placed in self._session.simulation.scene.models)


def _content(path: Path) -> bytes | None:
    """The contents of a mesh or image.

    Raises:
        OSError: The file cannot be read.
    """
    real = path.resolve()
    if not {path.suffix.lower(), real.suffix.lower()} <= SHAPES | PICTURES:
        return None
    # Rejects links created in the meantime, and pipes that would block.
    with open(os.open(real, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK), "rb") as file:  # noqa: PTH123
        status = os.fstat(file.fileno())
        if not stat.S_ISREG(status.st_mode) or status.st_size > LARGEST:
            return None
        return file.read(LARGEST)
