"""Meshes and textures, for programs that show robots elsewhere."""

from __future__ import annotations

import contextlib
import os
import re
import stat
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from cartwheel.description.packages import Packages, belongs_to
from cartwheel.errors import CartwheelError

if TYPE_CHECKING:
    from cartwheel.description.model import RobotDescription
    from cartwheel.session import Session

SHAPES = frozenset({".stl", ".dae", ".obj", ".mtl", ".ply", ".glb", ".gltf", ".bin"})
PICTURES = frozenset({".png", ".jpg", ".jpeg", ".tif", ".tiff", ".tga", ".bmp", ".webp"})
LARGEST = 200 << 20
"""Bytes of a file that is handed out."""
_FILE = re.compile(r'file://[^"\'<>\s]+')


class Assets:
    """The content of files that the models of a simulation refer to, by their URIs.

    Shapes and pictures alone: by ``package://`` and ``model://`` those of packages and models; by
    ``file://`` those that a description names, and what lies beside them, where that description
    was itself read from a file. One that came over a wire could name any file.

    Args:
        session: Whose models.
        package_path: Where packages are looked for first.
    """

    def __init__(self, session: Session, package_path: Sequence[Path]) -> None:
        self._session = session
        self._package_path = package_path

    def __call__(self, uri: str) -> bytes | None:
        """The content; None where there is none to be had."""
        plain = unquote(uri)
        # `Packages` expands $(find ...), which no URI of a mesh needs by now.
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
    """Of a shape or a picture.

    Raises:
        OSError: It cannot be read.
    """
    real = path.resolve()
    if not {path.suffix.lower(), real.suffix.lower()} <= SHAPES | PICTURES:
        return None
    # Neither a link that was put there since, nor a pipe on which a reader waits for ever.
    with open(os.open(real, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK), "rb") as file:  # noqa: PTH123
        status = os.fstat(file.fileno())
        if not stat.S_ISREG(status.st_mode) or status.st_size > LARGEST:
            return None
        return file.read(LARGEST)
