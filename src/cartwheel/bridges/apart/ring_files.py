"""Files in memory, counters and sockets, through which two processes share a ring of messages.

None of them has a name, so a killed process leaves nothing behind.
"""

from __future__ import annotations

import mmap
import os
import socket
from dataclasses import dataclass

SIZE = 32 << 20
"""Size of a ring in bytes. Only the used part occupies memory."""
_LEAST = 1 << 18
"""Size in bytes at which a ring is not reduced further."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RingFiles:
    """File descriptors of one end, which owns them."""

    memory: int
    published: int
    """eventfd: number of bytes that may be read."""
    freed: int
    """eventfd: number of bytes that may be overwritten."""
    sock: int
    """One end of a socket pair. It hangs up when the other process has exited, and carries
    files."""

    @classmethod
    def pair(cls, size: int = SIZE) -> tuple[RingFiles, RingFiles]:
        """Creates a ring. Returns the files of its writer and of its reader.

        Args:
            size: Size in bytes; reduced if the size of files is limited.
        """
        sockets = socket.socketpair()
        ours = cls(
            memory=_memory(size), published=_count(), freed=_count(), sock=sockets[0].detach()
        )
        theirs = cls(
            memory=os.dup(ours.memory),
            published=os.dup(ours.published),
            freed=os.dup(ours.freed),
            sock=sockets[1].detach(),
        )
        return ours, theirs

    @classmethod
    def of(cls, text: str) -> RingFiles:
        """Parses the result of `str`."""
        memory, published, freed, sock = map(int, text.split(","))
        return cls(memory=memory, published=published, freed=freed, sock=sock)

    def __str__(self) -> str:
        return ",".join(map(str, self.numbers))

    @property
    def numbers(self) -> tuple[int, int, int, int]:
        """All file descriptors."""
        return self.memory, self.published, self.freed, self.sock

    def close(self) -> None:
        """Closes the files. Use it for an end that has no writer or reader."""
        for number in self.numbers:
            os.close(number)


def _count() -> int:
    return os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)


def _memory(size: int) -> int:
    """Creates an unnamed file in memory, outside /dev/shm. It ends with its processes."""
    file = os.memfd_create("cartwheel")
    while True:
        try:
            os.ftruncate(file, size)
        except OSError:
            # A limit on file size (ulimit -f) applies here as well.
            if size <= _LEAST:
                raise
            size //= 4
        else:
            return file


def message_file(data: bytes) -> int:
    """Creates an unnamed file in memory with a message's bytes. Returns its descriptor.

    Raises:
        OSError: The system refuses the file, for example because of a limit on file size.
    """
    file = os.memfd_create("cartwheel message")
    try:
        left = memoryview(data)
        while left:
            left = left[os.write(file, left) :]
    except OSError:
        os.close(file)
        raise
    return file


def file_content(file: int) -> bytes:
    """Bytes of such a file."""
    with mmap.mmap(file, 0, prot=mmap.PROT_READ) as mapped:
        return mapped[:]
