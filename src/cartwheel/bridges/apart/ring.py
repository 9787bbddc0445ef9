"""Messages from one process to another, through memory that both see.

One writer and one reader. Who writes copies a message into the ring and rings a bell, a byte on
a socket; nobody waits for anybody, unless the writer chooses to because the ring is full.
"""

from __future__ import annotations

import contextlib
import errno
import mmap
import os
import select
import socket
import struct
import tempfile
import threading
import time
from collections.abc import Callable, Iterator

SIZE = 32 << 20
"""Bytes of a ring; only what is used of them is memory."""
_LEAST = 1 << 18
_COUNTS = 64
"""Bytes before the ring: how many were written, and how many were read."""
_HEAD = struct.Struct("<IIq")
"""Before each part of a message: its bytes, the reader's number with `_MORE`, the time in ns."""
_SKIP = 0xFFFF_FFFF
"""In place of a size: on at the ring's beginning."""
_MORE = 1 << 31
"""Another part of the same message follows."""
_BATCH = 1 << 16
"""Bytes for which a patient reader is woken at once."""
_LINGER = 0.02
"""s after which a reader looks by itself: a patient one always, another once after a message."""
_PAUSE = 0.0005
"""s between two looks at a full ring."""


def memory(size: int = SIZE) -> int:
    """The file of a new ring, without a name; a smaller one where files may not be so large."""
    if hasattr(os, "memfd_create"):
        file = os.memfd_create("cartwheel")
    else:
        with tempfile.TemporaryFile() as made:
            file = os.dup(made.fileno())
    while True:
        try:
            os.ftruncate(file, _COUNTS + size)
        except OSError as error:
            # A limit for files (ulimit -f) is one for this as well.
            if error.errno != errno.EFBIG or size <= _LEAST:
                raise
            size //= 4
        else:
            return file


class _Ring:
    def __init__(self, file: int, bell: socket.socket) -> None:
        self._memory = mmap.mmap(file, 0)
        view = memoryview(self._memory)
        # Whole words at their places: written and read in one go.
        self._counts = view[:16].cast("Q")
        self._data = view[_COUNTS:]
        self._size = len(self._data)
        self._part = self._size // 4
        self._bell = bell


class RingWriter(_Ring):
    """The end that writes; for any thread.

    Args:
        file: Of `memory`.
        bell: One end of a pair of sockets.
        patient: Whether the reader need not hear of each message at once.
    """

    def __init__(self, file: int, bell: socket.socket, *, patient: bool) -> None:
        super().__init__(file, bell)
        self._patient = patient
        self._lock = threading.Lock()
        self._untold = 0
        self._closed = False

    @property
    def written(self) -> int:
        """Bytes so far, as `RingReader.read_to` takes them."""
        return self._counts[0]

    def put(self, number: int, time_ns: int, data: bytes) -> bool:
        """Adds a message; False where there is no room now, or nobody to read it.

        Args:
            number: Of whom it is for.
            time_ns: Simulation time.
            data: Its bytes; fewer than three quarters of the ring's.
        """
        with self._lock:
            if self._closed or not self._fits(len(data)):
                return False
            if len(data) <= self._part:
                self._write(number, time_ns, data)
                return True
            for piece, more in self._parts_of(data):
                self._write(number | more, time_ns, piece)
        return True

    def put_patiently(self, number: int, time_ns: int, data: bytes) -> float:
        """Adds a message of any size as soon as there is room.

        Returns:
            s that it took to wait.
        """
        waited = 0.0
        for piece, more in self._parts_of(data):
            while not self.put(number | more, time_ns, piece) and not self._closed:
                self._ring_bell()
                before = time.perf_counter()
                time.sleep(_PAUSE)
                waited += time.perf_counter() - before
        return waited

    def close(self) -> None:
        """Takes no more, and tells the reader."""
        with self._lock:
            self._closed = True
            self._bell.close()

    def _parts_of(self, data: bytes) -> Iterator[tuple[bytes, int]]:
        for start in range(0, max(1, len(data)), self._part):
            end = start + self._part
            yield data[start:end], _MORE if end < len(data) else 0

    def _fits(self, length: int) -> bool:
        written, read = self._counts[0], self._counts[1]
        parts = 1 + length // self._part
        # One of them may have to begin at the beginning.
        largest = _HEAD.size + _padded(min(length, self._part))
        needed = length + parts * 2 * _HEAD.size + largest
        return self._size - (written - read) >= needed

    def _write(self, number: int, time_ns: int, data: bytes) -> None:
        written = self._counts[0]
        # Where not all was taken yet the reader is awake, or about to be.
        awake = self._counts[1] != written
        at = written % self._size
        length = len(data)
        whole = _HEAD.size + _padded(length)
        if at + whole > self._size:
            _HEAD.pack_into(self._data, at, _SKIP, 0, 0)
            written += self._size - at
            at = 0
        _HEAD.pack_into(self._data, at, length, number, time_ns)
        start = at + _HEAD.size
        self._data[start : start + length] = data
        # From now on the reader may read it.
        self._counts[0] = written + whole
        self._untold += whole
        if self._untold >= _BATCH if self._patient else not awake:
            self._ring_bell()

    def _ring_bell(self) -> None:
        self._untold = 0
        with contextlib.suppress(OSError):
            # In vain where many such bytes lie there: the reader will look.
            self._bell.send(b"\0", socket.MSG_DONTWAIT)


class RingReader(_Ring):
    """The end that reads, on a thread of its own.

    Args:
        file: Of `memory`.
        bell: The other end of the writer's.
        patient: As for the writer.
        take: Given each message: number, time in ns and bytes.
        on_fault: Told of what `take` raised.
    """

    def __init__(
        self,
        file: int,
        bell: socket.socket,
        *,
        patient: bool,
        take: Callable[[int, int, bytes], None],
        on_fault: Callable[[Exception], None],
    ) -> None:
        super().__init__(file, bell)
        self._patience = _LINGER if patient else None
        self._take = take
        self._on_fault = on_fault
        self._parts: list[bytes] = []
        self._read = threading.Condition()
        self._ended = False
        self._thread = threading.Thread(target=self._run, name="messages", daemon=True)

    def start(self) -> None:
        """Begins to read."""
        self._thread.start()

    def read_to(self, written: int) -> None:
        """Waits until all was taken that had been written."""
        with self._read:
            self._read.wait_for(lambda: self._counts[1] >= written or self._ended)

    def read_all(self) -> None:
        """Waits until all was taken; for when the writer has gone."""
        if self._thread.is_alive():
            self.read_to(self._counts[0])

    def _run(self) -> None:
        self._bell.setblocking(False)
        patience = self._patience
        while not self._wait(patience):
            # What came as the last one was taken may have been held for seen: one look more.
            patience = _LINGER if self._drain() else self._patience
        self._drain()
        with self._read:
            self._ended = True
            self._read.notify_all()

    def _wait(self, patience: float | None) -> bool:
        """Waits for the bell; whether the writer has gone."""
        ready, _, _ = select.select([self._bell], [], [], patience)
        if ready:
            try:
                while self._bell.recv(_COUNTS):
                    pass
            except BlockingIOError:
                return False
            except OSError:
                pass
            return True
        return False

    def _drain(self) -> bool:
        """Takes what there is; whether that was anything."""
        began = read = self._counts[1]
        while read != self._counts[0]:
            at = read % self._size
            length, number, time_ns = _HEAD.unpack_from(self._data, at)
            if length == _SKIP:
                read += self._size - at
            else:
                start = at + _HEAD.size
                self._parts.append(bytes(self._data[start : start + length]))
                read += _HEAD.size + _padded(length)
                if not number & _MORE:
                    self._hand_on(number, time_ns)
            self._counts[1] = read
        with self._read:
            self._read.notify_all()
        return read != began

    def _hand_on(self, number: int, time_ns: int) -> None:
        parts, self._parts = self._parts, []
        try:
            self._take(number, time_ns, parts[0] if len(parts) == 1 else b"".join(parts))
        except Exception as error:  # noqa: BLE001 - one message must not end the others
            self._on_fault(error)


def _padded(length: int) -> int:
    return -(-length // _HEAD.size) * _HEAD.size
