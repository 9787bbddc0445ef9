"""A file that is written to its end or not at all."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path


class Sink:
    """Bytes to a file without a buffer: what was written is the operating system's.

    Args:
        path: Made anew.

    Raises:
        OSError: It cannot be.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("wb", buffering=0)
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
