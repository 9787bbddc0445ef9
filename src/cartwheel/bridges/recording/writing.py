"""Interface of recording writers, and their selection by file name."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Protocol

from cartwheel.bridges.recording.formats import (
    Encoding,
    check_writable,
    exists,
    form_of,
    path_error,
    reason_of,
)
from cartwheel.bridges.recording.sink import is_being_written
from cartwheel.codes.recording import RECORDING_EXISTS, RECORDING_NOT_WRITABLE


class Writer(Protocol):
    """Writes messages to a file in the order of time."""

    @property
    def kept_ns(self) -> int:
        """Time of the last message that was passed to the operating system."""

    def add(self, topic: str, type_name: str, *, latched: bool) -> int:
        """Adds a topic. Returns the number of its channel.

        Raises:
            UnknownNameError: The encoding does not support the type.
        """

    def write(self, channels: Sequence[int], times: Sequence[int], data: Sequence[bytes]) -> None:
        """Writes encoded messages.

        Args:
            channels: Channel of each message.
            times: Time of each message, ns.
            data: Bytes of each message.

        Raises:
            OSError: The file cannot be written.
        """

    def attach(self, name: str, media_type: str, data: bytes, time_ns: int) -> None:
        """Stores a text next to the messages, if the format supports it."""

    def flush(self) -> None:
        """Passes all messages to the operating system, so that they survive a crash.

        Raises:
            OSError: The file cannot be written.
        """

    def close(self) -> None:
        """Completes the file.

        Raises:
            OSError: The file cannot be written.
        """

    def abandon(self) -> None:
        """Saves the complete part of the file after an `OSError`."""


def open_writer(
    path: Path,
    encoding: Encoding,
    *,
    overwrite: bool,
    notes: Mapping[str, str],
) -> Writer:
    """Creates a recording.

    Args:
        path: Output path, whose name determines the format.
        encoding: Encoding of the messages.
        overwrite: Whether to replace an existing recording.
        notes: Text to store with the recording, if the format supports it.

    Raises:
        RecordingError: The recording cannot be written at this path.
    """
    check_writable(path, overwrite=overwrite)
    try:
        if overwrite:
            _remove(path)
        return _opened(path, encoding, notes)
    except FileExistsError as error:
        # A different process created the file just now.
        raise exists(path) from error
    except OSError as error:
        reason = reason_of(error)
        message = f'"{path}" cannot be written: {reason}'
        raise path_error(RECORDING_NOT_WRITABLE, path, message, reason=reason) from error


def _remove(path: Path) -> None:
    """Deletes the recording that will be replaced.

    Raises:
        RecordingError: The recording is still being written.
        OSError: The recording cannot be deleted.
    """
    folder = path.is_dir() and not path.is_symlink()
    # SQLite uses its own locks for .db3 files, and does not allow opening them separately.
    written = [one for one in (path.iterdir() if folder else (path,)) if one.suffix != ".db3"]
    if any(one.is_file() and is_being_written(one) for one in written):
        message = f'"{path}" is still being recorded, so it is not replaced'
        raise path_error(RECORDING_EXISTS, path, message, recording=True)
    if folder:
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _opened(path: Path, encoding: Encoding, notes: Mapping[str, str]) -> Writer:
    form = form_of(path)
    if form == "mcap":
        from cartwheel.bridges.recording.mcap_writing import McapWriter

        return McapWriter(path, encoding, notes=notes)
    if form == "bag":
        from cartwheel.bridges.recording.bag_writing import BagWriter

        return BagWriter(path)
    if form == "db3":
        from cartwheel.bridges.recording.db3_writing import Db3Writer

        return Db3Writer(path, notes=notes)
    from cartwheel.bridges.recording.folder_writing import FolderWriter

    return FolderWriter(path, notes=notes)
