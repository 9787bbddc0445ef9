"""A file that is written to its end or not at all."""

from __future__ import annotations

import fcntl
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path


class Sink:
    """Bytes to a file without a buffer: what was written is the operating system's.

    The file is locked as long as it is open, so that others can see that it is being written.

    Args:
        path: Made anew; nothing may be there.

    Raises:
        OSError: It cannot be.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("xb", buffering=0)
        # Not on every network's file system: then nobody sees it.
        with suppress(OSError):
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        self.position = 0
        """Where the next bytes go."""

    def write(self, data: bytes | bytearray | memoryview) -> None:
        """Appends all of the bytes, or none.

        Raises:
            OSError: They do not fit.
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
        """Lets the file end there."""
        self._file.truncate(position)
        self._file.seek(position)
        self.position = position

    def salvage(self, finish: Callable[[], None], give_back: Callable[[], bool]) -> None:
        """After a write that failed: ends the file by `finish`, or where it is whole.

        Args:
            finish: Writes the end.
            give_back: Makes room for it where there is too little: cuts off the last chunk.
                Says whether there was one.
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
        """Replaces bytes; the end stays where it is."""
        self._file.seek(position)
        self._file.write(data)
        self._file.seek(self.position)

    def close(self) -> None:
        """Closes the file."""
        self._file.close()


def is_being_written(path: Path) -> bool:
    """Whether a `Sink` has that file open, in whichever process."""
    try:
        with path.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    return False
