"""Reads files in untrusted repositories: no devices, no blocking pipes, no unlimited files."""

from __future__ import annotations

import errno
from pathlib import Path

MOST_BYTES = 4_000_000
"""Maximum size of a text near a description: material libraries, scripts, install lists."""


def read_regular(path: Path, most: int = MOST_BYTES) -> bytes:
    """A file's contents.

    Raises:
        OSError: The file is missing, not a regular file, or larger than `most` bytes.
    """
    content = read_start(path, most + 1)
    if len(content) > most:
        raise OSError(errno.EFBIG, f"it is larger than {most / 1e6:g} MB")
    return content


def read_start(path: Path, most: int) -> bytes:
    """The first bytes of a file.

    Args:
        path: The file.
        most: Maximum number of bytes.

    Raises:
        OSError: The file is missing, or not a regular file.
    """
    if path.exists() and not path.is_file():
        raise OSError(errno.EINVAL, "it is not a regular file")
    with path.open("rb") as file:
        return file.read(most)


def read_regular_text(path: Path, most: int = MOST_BYTES) -> str:
    """A file's text; invalid UTF-8 is replaced.

    Raises:
        OSError: As `read_regular`.
    """
    return read_regular(path, most).decode("utf-8", "replace")


def text_if_regular(path: Path, most: int = MOST_BYTES) -> str:
    """As `read_regular_text`; empty for a file that cannot be read."""
    try:
        return read_regular_text(path, most)
    except OSError:
        return ""
