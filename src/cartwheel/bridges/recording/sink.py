"""An output file to which each write appends all of its bytes or none."""

from __future__ import annotations

import fcntl
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path


class Sink:
    """Unbuffered file output. Written bytes are passed to the operating system at once.

    The file is locked while it is open, so that other processes can see that it is being written.

    Args:
        path: File to create. It must not exist.

    Raises:
        OSError: The file cannot be created.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("xb", buffering=0)
        # Some network file systems do not support locks.
        with suppress(OSError):
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        self.position = 0
        """Offset of the next write."""

    def write(self, data: bytes | bytearray | memoryview) -> None:
        """Appends all of the bytes, or none.

        Raises:
            OSError: The bytes could not be written.
        """
        begin = self.position
        left = memoryview(data)
        try:
            while left:
                left = left[self._file.write(left) :]
        except OSError:
            self.cut(begin)
            raise
        self.position = begin + len(data)

    def cut(self, position: int) -> None:
        """Truncates the file at an offset."""
        self._file.truncate(position)
        self._file.seek(position)
        self.position = position

    def salvage(self, finish: Callable[[], None], give_back: Callable[[], bool]) -> None:
        """Ends the file after a failed write: with `finish`, or at the last complete part.

        Args:
            finish: Writes the end of the file.
            give_back: Removes the last chunk if there is not enough space for the end. Returns
                whether a chunk was removed.
        """
        while True:
            whole = self.position
            with suppress(OSError):
                finish()
                return
            with suppress(OSError):
                self.cut(whole)
            if not give_back():
                break
        self.close()

    def rewrite(self, position: int, data: bytes) -> None:
        """Overwrites bytes inside the file."""
        self._file.seek(position)
        self._file.write(data)
        self._file.seek(self.position)

    def close(self) -> None:
        """Closes the file."""
        self._file.close()


def is_being_written(path: Path) -> bool:
    """Whether a `Sink` in any process has the file open."""
    try:
        with path.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    return False
