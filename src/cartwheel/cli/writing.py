"""Writes output files of commands."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from cartwheel.codes.command import OUTPUT_NOT_WRITTEN
from cartwheel.errors import CartwheelError


@contextlib.contextmanager
def writing(path: Path) -> Iterator[None]:
    """Converts system errors to an error with the path.

    Raises:
        CartwheelError: The file cannot be written.
    """
    try:
        yield
    except OSError as error:
        raise CartwheelError(
            f"{path} cannot be written: {error.strerror}",
            code=OUTPUT_NOT_WRITTEN,
            values={"path": str(path)},
        ) from error
