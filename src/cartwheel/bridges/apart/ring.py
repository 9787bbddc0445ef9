"""Messages between two processes, through shared memory.

There is one writer and one reader. The bytes of messages are in shared memory. Two kernel counters
(eventfd) contain the number of bytes that may be read, and the number that may be overwritten.
Data written before a counter was raised is visible to the process that has read the counter, on
every processor. A counter that is not zero wakes the process that waits for it. No wake-up can
therefore be lost, and neither process reads a number that the other process writes.

A message larger than a quarter of the ring is sent over a socket, as a separate file in memory.
Neither the ring nor these files have names, so a killed process leaves nothing behind and a small
``/dev/shm`` does not matter. ``benchmarks/README.md`` compares the ring with pyzmq and iceoryx2.
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

from cartwheel.bridges.apart.ring_files import RingFiles, file_content, message_file
from cartwheel.forks import keep_object

LARGEST = 256 << 20
"""Maximum bytes of messages in separate files that the reader has not received yet."""
LINGER = 1.0
"""Interval in s at which a reader checks the ring without being woken."""
_LARGE_COUNT = 16
"""Maximum number of messages in separate files that the reader has not received yet."""
_HEAD = struct.Struct("<IIq")
"""Header of each message: size in bytes, number of the receiver, time in ns."""
_SKIP = 0xFFFF_FFFF
"""Value of the size field: continue at the start of the ring."""
_APART = 0xFFFF_FFFE
"""Value of the size field: the message is the next file on the socket."""
_SHARE = 16
"""The reader releases space after this fraction of the ring, and when the ring is empty."""
_PATIENT = 0.02
"""Polling interval in s of a patient reader, which is not woken for each message."""
_RETRY_MS = 50
"""Interval in ms at which a patient writer retries if no space was released."""


class Put(enum.Enum):
    """Result of adding a message."""

    TAKEN = enum.auto()
    FULL = enum.auto()
    """The ring currently has no space."""
    TOO_LARGE = enum.auto()
    """The message does not fit into the ring at any time."""
    CLOSED = enum.auto()
    """The ring is closed."""


class _End:
    def __init__(self, files: RingFiles) -> None:
        self._data = memoryview(mmap.mmap(files.memory, 0))
        os.close(files.memory)
        self._size = len(self._data)
        self._published = files.published
        self._freed = files.freed
        self._sock = socket.socket(fileno=files.sock)


class RingWriter(_End):
    """Writing end. Thread-safe.

    Args:
        files: First result of `RingFiles.pair`.
    """

    def __init__(self, files: RingFiles) -> None:
        super().__init__(files)
        self._lock = threading.Lock()
        self._room_comes = select.poll()
        self._room_comes.register(self._freed, select.POLLIN)
        self._read = 0
        self._large: deque[tuple[int, int]] = deque()
        """Messages in separate files that the reader has not received: `written` after each, and
        size."""
        self._closed = False
        self.written = 0
        """Bytes written so far, for `RingReader.read_to`."""
        self.largest = LARGEST
        """Maximum size of a message in bytes."""
        keep_object(self)

    def leave_to_parent(self) -> None:
        """Closes this process's copy. The memory is shared, so a second writer would destroy it."""
        self._lock = threading.Lock()
        self.close()

    def put(self, number: int, time_ns: int, data: bytes) -> Put:
        """Adds a message without waiting.

        Args:
            number: Number of the receiver.
            time_ns: Simulation time.
            data: Message bytes.
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
        """Adds a message as soon as there is space.

        Returns:
            The result, which is never `FULL`, and the waiting time in s.
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
        """Number of bytes that the reader has released so far."""
        with self._lock:
            if not self._closed:
                self._look()
            return self._read

    def close(self) -> None:
        """Closes the writer. The reader stops after it has read everything."""
        with self._lock:
            if not self._closed:
                self._closed = True
                self._sock.close()
                os.close(self._published)
                os.close(self._freed)

    def _room(self, length: int) -> tuple[int, int] | None:
        """Offset of a message's header, and the message's size in the ring. None without space."""
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
        """Updates the number of bytes that the reader has released."""
        with contextlib.suppress(BlockingIOError):
            self._read += os.eventfd_read(self._freed)
        while self._large and self._large[0][0] <= self._read:
            self._large.popleft()

    def _publish(self, count: int) -> None:
        # From here on the reader can read the message, even if this process exits now.
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
            file = message_file(data)
        except OSError as error:
            if error.errno != errno.EFBIG:
                return Put.FULL
            # A limit on file size (ulimit -f) applies here as well.
            self.largest = self._size // 4
            return Put.TOO_LARGE
        try:
            # The kernel refuses if too many files are in transit.
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
    """Reading end, on a separate thread.

    Args:
        files: Second result of `RingFiles.pair`.
        patient: Whether messages may be delayed, so that the reader is not woken for each.
        take: Called with each message: number, time in ns, and bytes.
        on_fault: Called with the exceptions of `take`.
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
        """Starts the thread."""
        self._thread.start()

    def read_to(self, written: int) -> None:
        """Waits until everything up to `written` was read, or the thread has ended."""
        with self._progress:
            while self._read < written and self._thread.is_alive():
                self._progress.wait(LINGER)

    def read_all(self) -> None:
        """Reads the remaining messages and stops, after the writer's process has exited."""
        with contextlib.suppress(OSError):
            self._sock.shutdown(socket.SHUT_RDWR)
        self.join()

    def join(self) -> None:
        """Waits until the writer has closed and all messages were read."""
        if self._thread.is_alive():
            self._thread.join()

    def _run(self) -> None:
        poll = select.poll()
        # Watch only for a hang-up, because a file may arrive before its message.
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
        """Reads all available messages."""
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
            return file_content(file)
        finally:
            os.close(file)

    def _hand_on(self, number: int, time_ns: int, data: bytes) -> None:
        try:
            self._take(number, time_ns, data)
        except Exception as error:  # noqa: BLE001 - one error must not stop the others
            self._on_fault(error)


def _padded(length: int) -> int:
    return -(-length // _HEAD.size) * _HEAD.size
