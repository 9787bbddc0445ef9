"""Copies of files whose text a launch file changes, as nav2_common's ReplaceString does.

As in ROS, the changed text is written to a temporary file, whose path may be the value of an
argument. Lines keep their numbers, and messages name the original file.
"""

from __future__ import annotations

import atexit
import contextlib
import hashlib
import os
import shutil
import stat
import tempfile
from pathlib import Path

_FOLDER = "cartwheel-launched-"
_SOURCE = ".source"
"""The file with the path of the original, beside a copy."""
_MOST_FILES, _MOST_BYTES = 1000, 1_000_000
"""Maximum number of copies that a process makes, and of bytes of each."""


class _Copies:
    """The copies that a process makes, in a folder that it deletes when it ends."""

    def __init__(self) -> None:
        self.owner = os.getpid()
        self.folder = Path(tempfile.mkdtemp(prefix=_FOLDER))
        self.count = 0
        atexit.register(self._delete)

    def _delete(self) -> None:
        # A forked process inherits the function.
        if os.getpid() == self.owner:
            shutil.rmtree(self.folder, ignore_errors=True)


_made: list[_Copies] = []


def rewritten(source: Path, text: str) -> Path:
    """The path of a copy of a file with another text.

    It is the file itself if the text is the same or too long, or if the copy cannot be written.
    """
    content = text.encode("utf-8", "replace")
    source = original(source).absolute()
    try:
        if len(content) > _MOST_BYTES or content == source.read_bytes():
            return source
        if not _made or _made[-1].owner != os.getpid():
            _made.append(_Copies())
        copies = _made[-1]
        key = hashlib.sha256(b"\0".join((os.fsencode(source), content))).hexdigest()[:16]
        folder = copies.folder / key
        copy = folder / source.name
        if not copy.exists():
            copies.count += 1
            if copies.count > _MOST_FILES:
                return source
            folder.mkdir(exist_ok=True)
            (folder / _SOURCE).write_bytes(os.fsencode(source))
            copy.write_bytes(content)
    except OSError:
        return source
    return copy


def original(path: Path) -> Path:
    """The file of which a path is a copy; the path itself for any other file."""
    parts = path.parts
    if len(parts) > 2 and parts[-3].startswith(_FOLDER) and _is_made(path.parent.parent):
        with contextlib.suppress(OSError):
            return Path(os.fsdecode((path.parent / _SOURCE).read_bytes()))
    return path


def _is_made(folder: Path) -> bool:
    """Whether a process of this user made a folder for copies, and nobody else can write to it.

    A repository can contain a folder with such a name.
    """
    try:
        about = folder.lstat()
    except OSError:
        return False
    private = stat.S_ISDIR(about.st_mode) and not about.st_mode & 0o077
    near = os.path.realpath(folder.parent) == os.path.realpath(tempfile.gettempdir())
    return private and near and about.st_uid == os.getuid()
