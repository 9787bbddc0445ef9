"""What a recording's name says about its form, and where it may be written."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Literal, Protocol

from cartwheel.errors import RecordingError

Encoding = Literal["ros1", "ros2"]
"""Of the messages."""
ENCODINGS: tuple[Encoding, ...] = ("ros2", "ros1")

_NAMES = "Names are: x.mcap; x.bag, of ROS 1; x.db3, of ROS 2; x, a folder, of ROS 2."
_BAG2_FILES = {".mcap", ".db3", ".yaml", ".zstd", ".db3-journal"}


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


def form_of(path: Path) -> Literal["mcap", "bag", "db3", "folder"]:
    """The form that a name asks for.

    Raises:
        RecordingError: No form has such a name.
    """
    suffix = path.suffix.lower()
    if suffix in (".mcap", ".bag", ".db3"):
        return suffix[1:]  # type: ignore[return-value]
    if suffix and not suffix[1:].isdecimal() and not path.is_dir():
        raise RecordingError(f'"{path.name}" names no form of recording', hint=_NAMES)
    return "folder"


def encoding_for(path: Path, wanted: Encoding | None) -> Encoding:
    """The encoding of a recording: `wanted`, or the one usual for its form.

    Raises:
        RecordingError: The form cannot hold it.
    """
    form = form_of(path)
    if wanted is None:
        return "ros1" if form == "bag" else "ros2"
    if (form == "bag") != (wanted == "ros1") and form != "mcap":
        other = "ROS 2" if form == "bag" else "ROS 1"
        raise RecordingError(
            f'"{path.name}" cannot hold messages of {other}', hint="A .mcap holds either."
        )
    return wanted


def check_writable(path: Path, *, overwrite: bool) -> None:
    """Refuses a place where no recording can begin.

    Raises:
        RecordingError: Something is there already, or the folder takes no file.
    """
    form_of(path)
    folder = path.parent
    if not folder.is_dir():
        raise RecordingError(f'there is no folder "{folder}"', hint=f"mkdir -p {folder}")
    if path.exists() or path.is_symlink():
        if not overwrite:
            raise RecordingError(f'"{path}" exists', hint="--overwrite replaces it.")
        if path.is_dir() and not _is_bag2(path):
            raise RecordingError(f'"{path}" is a folder and no recording: it is not replaced')
        if path.is_dir() and form_of(path) != "folder":
            raise RecordingError(f'"{path}" is a folder: it is not replaced by a file')
    if not os.access(folder, os.W_OK | os.X_OK):
        raise RecordingError(f'the folder "{folder}" takes no file: it is not writable')


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
        if path.is_dir():
            shutil.rmtree(path)
        return _opened(path, encoding, notes, pack)
    except OSError as error:
        raise RecordingError(f'"{path}" cannot be written: {reason_of(error)}') from error


def reason_of(error: OSError) -> str:
    """What the operating system says, without numbers and names."""
    return error.strerror or str(error)


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


def _is_bag2(folder: Path) -> bool:
    return all(inner.is_file() and inner.suffix in _BAG2_FILES for inner in folder.iterdir())
