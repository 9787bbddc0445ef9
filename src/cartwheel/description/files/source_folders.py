"""The folders of a project that people write, without those that tools make."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator
from pathlib import Path

_MADE = frozenset({"build", "devel", "install", "log", "node_modules", "__pycache__"})


def source_folders(
    folder: Path, *, markers: Collection[str] = ()
) -> Iterator[tuple[Path, list[str]]]:
    """A folder and its subfolders, each with the sorted names of its files.

    Hidden folders and those of build tools are skipped. Equal folders are visited in equal order.

    Args:
        folder: The folder. It is visited whatever its name is.
        markers: Names of files that exclude the subfolder that contains them.
    """
    for root, folders, names in os.walk(folder):
        folders[:] = sorted(
            name
            for name in folders
            if name not in _MADE
            and not name.startswith(".")
            and not any(Path(root, name, marker).exists() for marker in markers)
        )
        yield Path(root), sorted(names)
