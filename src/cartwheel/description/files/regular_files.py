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
    if path.exists() and not path.is_file():
        raise OSError(errno.EINVAL, "it is not a regular file")
    with path.open("rb") as file:
        content = file.read(most + 1)
    if len(content) > most:
        raise OSError(errno.EFBIG, f"it is larger than {most / 1e6:g} MB")
    return content


def read_regular_text(path: Path, most: int = MOST_BYTES) -> str:
    """A file's text; invalid UTF-8 is replaced.

    Raises:
        OSError: As `read_regular`.
    """
    return read_regular(path, most).decode("utf-8", "replace")
