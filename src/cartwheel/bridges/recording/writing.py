"""A recording that is written, in the form that its name asks for."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Protocol

from cartwheel.bridges.recording.formats import (
    Encoding,
    check_writable,
    exists,
    form_of,
    reason_of,
)
from cartwheel.bridges.recording.sink import is_being_written
from cartwheel.codes.recording import RECORDING_EXISTS, RECORDING_NOT_WRITABLE
from cartwheel.errors import RecordingError


class Writer(Protocol):
    """A file that takes messages, in the order of their times."""

    path: Path

    @property
    def kept_ns(self) -> int:
        """Time of the last message that the operating system has."""

    def add(self, topic: str, type_name: str, *, latched: bool) -> int:
        """A channel for a topic.

        Raises:
            UnknownNameError: The encoding has no such type.
        """

    def write(self, channel: int, time_ns: int, message: Any) -> int:
        """Takes a message of the graph; returns the size of its bytes.

        Raises:
            GraphError: It cannot be encoded; nothing was written.
            OSError: The file takes no more.
        """

    def attach(self, name: str, media_type: str, data: bytes, time_ns: int) -> None:
        """Keeps a text beside the messages, where the form can."""

    def flush(self) -> None:
        """Hands all that was taken to the operating system: from now on a crash cannot take it.

        Raises:
            OSError: The file takes no more.
        """

    def close(self) -> None:
        """Makes the file complete.

        Raises:
            OSError: The file takes no more.
        """

    def abandon(self) -> None:
        """After an `OSError`: saves what was whole before it."""


def open_writer(
    path: Path,
    encoding: Encoding,
    *,
    overwrite: bool,
    notes: Mapping[str, str],
    pack: Callable[[Any], bytes],
) -> Writer:
    """Begins a recording.

    Args:
        path: Its name says its form.
        encoding: Of its messages.
        overwrite: Whether to replace what is there.
        notes: To be kept with it, where the form can.
        pack: Makes ROS 2's bytes of a message.

    Raises:
        RecordingError: It cannot be written there.
    """
    check_writable(path, overwrite=overwrite)
    try:
        if overwrite:
            _remove(path)
        return _opened(path, encoding, notes, pack)
    except FileExistsError as error:
        # Somebody else began to write it just now.
        raise exists(path) from error
    except OSError as error:
        raise RecordingError(
            f'"{path}" cannot be written: {reason_of(error)}',
            code=RECORDING_NOT_WRITABLE,
            values={"path": str(path), "reason": reason_of(error)},
        ) from error


def _remove(path: Path) -> None:
    """Takes away what is to be replaced.

    Raises:
        RecordingError: It is still being recorded.
        OSError: It stays.
    """
    folder = path.is_dir() and not path.is_symlink()
    # A .db3 is SQLite's, which has locks of its own and forbids us to open it.
    written = [one for one in (path.iterdir() if folder else (path,)) if one.suffix != ".db3"]
    if any(one.is_file() and is_being_written(one) for one in written):
        raise RecordingError(
            f'"{path}" is still being recorded, so it is not replaced',
            code=RECORDING_EXISTS,
            values={"path": str(path), "recording": True},
        )
    if folder:
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _opened(
    path: Path, encoding: Encoding, notes: Mapping[str, str], pack: Callable[[Any], bytes]
) -> Writer:
    form = form_of(path)
    if form == "mcap":
        from cartwheel.bridges.recording.mcap_writing import McapWriter

        return McapWriter(path, encoding, notes=notes, pack=pack)
    if form == "bag":
        from cartwheel.bridges.recording.bag_writing import BagWriter

        return BagWriter(path)
    if form == "db3":
        from cartwheel.bridges.recording.db3_writing import Db3Writer

        return Db3Writer(path, notes=notes, pack=pack)
    from cartwheel.bridges.recording.folder_writing import FolderWriter

    return FolderWriter(path, notes=notes, pack=pack)
