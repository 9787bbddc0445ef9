"""Recording formats by file name, and checks of the output path."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Literal

from cartwheel.codes.recording import (
    ENCODING_UNFIT,
    RECORDING_EXISTS,
    RECORDING_NAME_INVALID,
    RECORDING_NOT_WRITABLE,
)
from cartwheel.errors import RecordingError
from cartwheel.options import OVERWRITE

Encoding = Literal["ros1", "ros2"]
"""Encoding of the messages."""
ENCODINGS: tuple[Encoding, ...] = ("ros2", "ros1")

_NAMES = "Valid names: x.mcap, x.bag (ROS 1), x.db3 (ROS 2), or x for a folder (ROS 2)."
_BAG2_FILES = {".mcap", ".db3", ".yaml", ".zstd", ".db3-journal"}


def form_of(path: Path) -> Literal["mcap", "bag", "db3", "folder"]:
    """Format for a file name.

    Raises:
        RecordingError: The name does not match any format.
    """
    suffix = path.suffix.lower()
    if suffix in (".mcap", ".bag", ".db3"):
        return suffix[1:]  # type: ignore[return-value]
    if suffix and not suffix[1:].isdecimal() and not path.is_dir():
        raise RecordingError(
            f'the file extension of "{path.name}" does not match a recording format',
            code=RECORDING_NAME_INVALID,
            hint=_NAMES,
            values={"name": path.name},
        )
    return "folder"


def encoding_for(path: Path, wanted: Encoding | None) -> Encoding:
    """Encoding of a recording: `wanted`, or the default of the format.

    Raises:
        RecordingError: The format does not support this encoding.
    """
    form = form_of(path)
    if wanted is None:
        return "ros1" if form == "bag" else "ros2"
    if (form == "bag") != (wanted == "ros1") and form != "mcap":
        other = "ROS 2" if form == "bag" else "ROS 1"
        raise RecordingError(
            f'the recording format of "{path.name}" does not support {other} messages',
            code=ENCODING_UNFIT,
            hint="Use .mcap, which supports both.",
            values={"name": path.name, "encoding": wanted},
        )
    return wanted


def check_writable(path: Path, *, overwrite: bool) -> None:
    """Checks that a recording can be created at a path.

    Raises:
        RecordingError: The path already exists, or the folder is not writable.
    """
    if not path.name:
        raise RecordingError(
            "the name of the recording is empty",
            code=RECORDING_NAME_INVALID,
            hint="Pass a file name such as drive.mcap.",
            values={"name": ""},
        )
    form_of(path)
    folder = path.parent
    if not folder.is_dir():
        raise RecordingError(
            f'the folder "{folder}" does not exist',
            code=RECORDING_NOT_WRITABLE,
            hint=f"Create it: mkdir -p {folder}",
            values={"path": str(folder)},
        )
    if path.exists() or path.is_symlink():
        if not overwrite:
            raise exists(path)
        if path.is_dir() and not _is_bag2(path):
            raise RecordingError(
                f'"{path}" is a folder but not a recording, so it is not replaced',
                code=RECORDING_NOT_WRITABLE,
                values={"path": str(path)},
            )
        if path.is_dir() and form_of(path) != "folder":
            raise RecordingError(
                f'"{path}" is a folder, so it is not replaced by a file',
                code=RECORDING_NOT_WRITABLE,
                values={"path": str(path)},
            )
    if not os.access(folder, os.W_OK | os.X_OK):
        raise RecordingError(
            f'the folder "{folder}" is not writable',
            code=RECORDING_NOT_WRITABLE,
            values={"path": str(folder)},
        )


def exists(path: Path) -> RecordingError:
    """Error for a path that already exists."""
    return RecordingError(
        f'"{path}" already exists',
        code=RECORDING_EXISTS,
        hint=f"To replace it: {OVERWRITE.given()}",
        values={"path": str(path)},
    )


def reason_of(error: OSError) -> str:
    """Reason in an operating system error, without number and file name."""
    return error.strerror or str(error)


def _is_bag2(folder: Path) -> bool:
    return all(inner.is_file() and inner.suffix in _BAG2_FILES for inner in folder.iterdir())
