"""Messages from one process to another, through memory that both see.

One writer and one reader. The bytes of messages lie in shared memory. How many of them may be
read, and how many may be written over, are counts of the kernel (eventfd): what was written before
a count was raised is seen by whoever has taken that count, on every processor, and a count that is
not zero wakes whoever waits for it. So no wake-up can be lost, and neither end looks at a number
that the other one writes.

A message that is larger than a quarter of the ring has a file in memory of its own, which goes
over a socket.
"""

from __future__ import annotations

import contextlib
import enum
import errno
import mmap
import os
import select
import socket
import struct
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

SIZE = 32 << 20
"""Bytes of a ring; only what is used of them is memory."""
LARGEST = 256 << 20
"""Bytes of the messages with a file of their own that may be on their way at a time."""
LINGER = 1.0
"""s after which a reader looks by itself."""
_LARGE_COUNT = 16
"""Messages with a file of their own that may be on their way."""
_LEAST = 1 << 18
_HEAD = struct.Struct("<IIq")
"""Before each message: its bytes, the reader's number, the time in ns."""
_SKIP = 0xFFFF_FFFF
"""In place of a size: on at the ring's beginning."""
_APART = 0xFFFF_FFFE
"""In place of a size: the message is the next file on the socket."""
_SHARE = 16
"""A reader gives room back when it has read this part of the ring, and when it has read all."""
_PATIENT = 0.02
"""s between two looks of a patient reader, which is not woken for each message."""
_RETRY_MS = 50
"""ms after which a patient writer tries again, if nothing was freed before."""


class Put(enum.Enum):
    """What became of a message."""

    TAKEN = enum.auto()
    FULL = enum.auto()
    """There is no room now."""
    TOO_LARGE = enum.auto()
    """There will be no room."""
    CLOSED = enum.auto()
    """The ring was closed."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RingFiles:
    """The file numbers of one end, which owns them."""

    memory: int
    published: int
    """An eventfd: bytes that may be read."""
    freed: int
    """An eventfd: bytes that may be written over."""
    sock: int
    """This end of a pair: hangs up where the other has gone, and carries files."""

    @classmethod
    def pair(cls, size: int = SIZE) -> tuple[RingFiles, RingFiles]:
        """A new ring: the files of its writer and of its reader.

        Args:
            size: Bytes; fewer where files are limited.
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
        """From `str`."""
        memory, published, freed, sock = map(int, text.split(","))
        return cls(memory=memory, published=published, freed=freed, sock=sock)

    def __str__(self) -> str:
        return ",".join(map(str, self.numbers))

    @property
    def numbers(self) -> tuple[int, int, int, int]:
        """All of them."""
        return self.memory, self.published, self.freed, self.sock

    def close(self) -> None:
        """Closes them; for an end that nobody made a writer or a reader of."""
        for number in self.numbers:
            os.close(number)


def _count() -> int:
    return os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)


def _memory(size: int) -> int:
    """A file without a name, which is no part of /dev/shm and ends with its processes."""
    file = os.memfd_create("cartwheel")
    while True:
        try:
            os.ftruncate(file, size)
        except OSError:
            # A limit for files (ulimit -f) is one for this as well.
            if size <= _LEAST:
                raise
            size //= 4
        else:
            return file


class _End:
    def __init__(self, files: RingFiles) -> None:
        self._data = memoryview(mmap.mmap(files.memory, 0))
        os.close(files.memory)
        self._size = len(self._data)
        self._published = files.published
        self._freed = files.freed
        self._sock = socket.socket(fileno=files.sock)


class RingWriter(_End):
    """The end that writes; for any thread.

    Args:
        files: The first of `RingFiles.pair`.
    """

    def __init__(self, files: RingFiles) -> None:
        super().__init__(files)
        self._lock = threading.Lock()
        self._room_comes = select.poll()
        self._room_comes.register(self._freed, select.POLLIN)
        self._read = 0
        self._large: deque[tuple[int, int]] = deque()
        """Those on their way: `written` after each, and its bytes."""
        self._closed = False
        self.written = 0
        """Bytes so far, as `RingReader.read_to` takes them."""
        self.largest = LARGEST
        """Bytes of the largest message that can be taken."""

    def put(self, number: int, time_ns: int, data: bytes) -> Put:
        """Adds a message; waits for nothing.

        Args:
            number: Of whom it is for.
            time_ns: Simulation time.
            data: Its bytes.
        """
        length = len(data)
        with self._lock:
            if self._closed:
                return Put.CLOSED
            if length > self._size // 4:
                return self._put_apart(number, time_ns, data)
            room = self._room(length)
            if room is None:
                return Put.FULL
            at, count = room
            _HEAD.pack_into(self._data, at, length, number, time_ns)
            at += _HEAD.size
            self._data[at : at + length] = data
            self._publish(count)
            return Put.TAKEN

    def put_patiently(self, number: int, time_ns: int, data: bytes) -> tuple[Put, float]:
        """Adds a message as soon as there is room.

        Returns:
            What became of it, never `FULL`, and the s that it took to wait.
        """
        waited = 0.0
        while True:
            found = self.put(number, time_ns, data)
            if found is not Put.FULL:
                return found, waited
            before = time.perf_counter()
            self._room_comes.poll(_RETRY_MS)
            waited += time.perf_counter() - before

    def look(self) -> int:
        """Bytes that the reader has given back so far."""
        with self._lock:
            if not self._closed:
                self._look()
            return self._read

    def close(self) -> None:
        """Takes no more; the reader ends when it has read all."""
        with self._lock:
            if not self._closed:
                self._closed = True
                self._sock.close()
                os.close(self._published)
                os.close(self._freed)

    def _room(self, length: int) -> tuple[int, int] | None:
        """Where the head of a message goes, and how many bytes it takes; None without room."""
        at = self.written % self._size
        count = _HEAD.size + _padded(length)
        skipped = self._size - at if at + count > self._size else 0
        if self._size - (self.written - self._read) < skipped + count:
            self._look()
            if self._size - (self.written - self._read) < skipped + count:
                return None
        if skipped:
            _HEAD.pack_into(self._data, at, _SKIP, 0, 0)
            at = 0
        return at, skipped + count

    def _look(self) -> None:
        """Learns what the reader has freed."""
        with contextlib.suppress(BlockingIOError):
            self._read += os.eventfd_read(self._freed)
        while self._large and self._large[0][0] <= self._read:
            self._large.popleft()

    def _publish(self, count: int) -> None:
        # From now on the reader may read it, also where this process ends here.
        os.eventfd_write(self._published, count)
        self.written += count

    def _put_apart(self, number: int, time_ns: int, data: bytes) -> Put:
        length = len(data)
        if length > self.largest:
            return Put.TOO_LARGE
        self._look()
        on_its_way = sum(each for _, each in self._large)
        room = self._room(0)
        if room is None or len(self._large) >= _LARGE_COUNT or on_its_way + length > LARGEST:
            return Put.FULL
        try:
            file = _file_of(data)
        except OSError as error:
            if error.errno != errno.EFBIG:
                return Put.FULL
            # A limit for files (ulimit -f) is one for this as well.
            self.largest = self._size // 4
            return Put.TOO_LARGE
        try:
            # The kernel refuses where as many files as it allows are on their way.
            socket.send_fds(self._sock, [b"\0"], [file], socket.MSG_DONTWAIT)
        except OSError:
            return Put.FULL
        finally:
            os.close(file)
        at, count = room
        _HEAD.pack_into(self._data, at, _APART, number, time_ns)
        self._publish(count)
        self._large.append((self.written, length))
        return Put.TAKEN


class RingReader(_End):
    """The end that reads, on a thread of its own.

    Args:
        files: The second of `RingFiles.pair`.
        patient: Whether it need not hear of each message at once.
        take: Given each message: number, time in ns and bytes.
        on_fault: Given what `take` raised.
    """

    def __init__(
        self,
        files: RingFiles,
        *,
        patient: bool,
        take: Callable[[int, int, bytes], None],
        on_fault: Callable[[Exception], None],
    ) -> None:
        super().__init__(files)
        self._patient = patient
        self._take = take
        self._on_fault = on_fault
        self._read = 0
        self._unfreed = 0
        self._progress = threading.Condition()
        self._thread = threading.Thread(target=self._run, name="messages", daemon=True)

    def start(self) -> None:
        """Begins to read."""
        self._thread.start()

    def read_to(self, written: int) -> None:
        """Waits until all was taken that had been written, or the thread has ended."""
        with self._progress:
            while self._read < written and self._thread.is_alive():
                self._progress.wait(LINGER)

    def read_all(self) -> None:
        """Takes what was written, and ends; for when the writer has gone."""
        with contextlib.suppress(OSError):
            self._sock.shutdown(socket.SHUT_RDWR)
        self.join()

    def join(self) -> None:
        """Waits for the writer's end, and for what it had written to be taken."""
        if self._thread.is_alive():
            self._thread.join()

    def _run(self) -> None:
        poll = select.poll()
        # Only whether it hangs up: a file may come on it before the message that has it.
        poll.register(self._sock, 0)
        if not self._patient:
            poll.register(self._published, select.POLLIN)
        patience = int(1000 * (_PATIENT if self._patient else LINGER))
        try:
            while not any(file == self._sock.fileno() for file, _ in poll.poll(patience)):
                self._drain()
            self._drain()
        finally:
            with self._progress:
                self._progress.notify_all()

    def _drain(self) -> None:
        """Takes what there is."""
        try:
            end = self._read + os.eventfd_read(self._published)
        except BlockingIOError:
            return
        while self._read < end:
            at = self._read % self._size
            length, number, time_ns = _HEAD.unpack_from(self._data, at)
            count = _HEAD.size
            if length == _SKIP:
                count = self._size - at
            elif length == _APART:
                self._hand_on(number, time_ns, self._file())
            else:
                start = at + _HEAD.size
                count += _padded(length)
                self._hand_on(number, time_ns, bytes(self._data[start : start + length]))
            self._read += count
            self._unfreed += count
            if self._read == end or self._unfreed >= self._size // _SHARE:
                os.eventfd_write(self._freed, self._unfreed)
                self._unfreed = 0
        with self._progress:
            self._progress.notify_all()

    def _file(self) -> bytes:
        _, (file,), _, _ = socket.recv_fds(self._sock, 1, 1)
        try:
            return _content(file)
        finally:
            os.close(file)

    def _hand_on(self, number: int, time_ns: int, data: bytes) -> None:
        try:
            self._take(number, time_ns, data)
        except Exception as error:  # noqa: BLE001 - one message must not end the others
            self._on_fault(error)


def _padded(length: int) -> int:
    return -(-length // _HEAD.size) * _HEAD.size


def _file_of(data: bytes) -> int:
    file = os.memfd_create("cartwheel message")
    try:
        left = memoryview(data)
        while left:
            left = left[os.write(file, left) :]
    except OSError:
        os.close(file)
        raise
    return file


def _content(file: int) -> bytes:
    with mmap.mmap(file, 0, prot=mmap.PROT_READ) as mapped:
        return mapped[:]
