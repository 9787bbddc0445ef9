"""What a recording's name says about its form, and where it may be written."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Literal

from cartwheel.errors import RecordingError

Encoding = Literal["ros1", "ros2"]
"""Of the messages."""
ENCODINGS: tuple[Encoding, ...] = ("ros2", "ros1")

_NAMES = "Names are: x.mcap; x.bag, of ROS 1; x.db3, of ROS 2; x, a folder, of ROS 2."
_BAG2_FILES = {".mcap", ".db3", ".yaml", ".zstd", ".db3-journal"}


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
    if not path.name:
        raise RecordingError("a recording needs a name", hint="Such as drive.mcap.")
    form_of(path)
    folder = path.parent
    if not folder.is_dir():
        raise RecordingError(f'there is no folder "{folder}"', hint=f"mkdir -p {folder}")
    if path.exists() or path.is_symlink():
        if not overwrite:
            raise exists(path)
        if path.is_dir() and not _is_bag2(path):
            raise RecordingError(f'"{path}" is a folder and no recording: it is not replaced')
        if path.is_dir() and form_of(path) != "folder":
            raise RecordingError(f'"{path}" is a folder: it is not replaced by a file')
    if not os.access(folder, os.W_OK | os.X_OK):
        raise RecordingError(f'the folder "{folder}" takes no file: it is not writable')


def exists(path: Path) -> RecordingError:
    """That something is there already, as an error."""
    return RecordingError(f'"{path}" exists', hint="--overwrite replaces it.")


def reason_of(error: OSError) -> str:
    """What the operating system says, without numbers and names."""
    return error.strerror or str(error)


def _is_bag2(folder: Path) -> bool:
    return all(inner.is_file() and inner.suffix in _BAG2_FILES for inner in folder.iterdir())
