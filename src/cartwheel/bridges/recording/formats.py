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
from cartwheel.errors import Code, RecordingError, Value
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
        why, hint = f'the folder "{folder}" does not exist', f"Create it: mkdir -p {folder}"
        raise path_error(RECORDING_NOT_WRITABLE, folder, why, hint=hint)
    if path.exists() or path.is_symlink():
        if not overwrite:
            raise exists(path)
        if path.is_dir() and not _is_bag2(path):
            why = f'"{path}" is a folder but not a recording, so it is not replaced'
            raise path_error(RECORDING_NOT_WRITABLE, path, why)
        if path.is_dir() and form_of(path) != "folder":
            why = f'"{path}" is a folder, so it is not replaced by a file'
            raise path_error(RECORDING_NOT_WRITABLE, path, why)
    if not os.access(folder, os.W_OK | os.X_OK):
        raise path_error(RECORDING_NOT_WRITABLE, folder, f'the folder "{folder}" is not writable')


def exists(path: Path) -> RecordingError:
    """Error for a path that already exists."""
    hint = f"To replace it: {OVERWRITE.given()}"
    return path_error(RECORDING_EXISTS, path, f'"{path}" already exists', hint=hint)


def path_error(
    code: Code, path: Path, message: str, *, hint: str | None = None, **values: Value
) -> RecordingError:
    """Error about a file or folder, which is one of its values."""
    return RecordingError(message, code=code, hint=hint, values={"path": str(path), **values})


def reason_of(error: OSError) -> str:
    """Reason in an operating system error, without number and file name."""
    return error.strerror or str(error)


def _is_bag2(folder: Path) -> bool:
    return all(inner.is_file() and inner.suffix in _BAG2_FILES for inner in folder.iterdir())
