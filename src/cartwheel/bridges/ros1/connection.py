"""A TCP connection that carries blocks with their length in front, as TCPROS does."""

from __future__ import annotations

import contextlib
import resource
import socket
import struct
import time
from collections import deque
from collections.abc import Callable

from cartwheel.bridges.loop import READ, WRITE, Loop, taken
from cartwheel.bridges.ros1 import header

_LENGTH = struct.Struct("<I")
HANDSHAKE = 10.0
"""s within which a connection must have told what it is for."""
LARGEST = 64 << 20
"""Bytes of a message or request that is taken from others."""
QUEUE_COUNT = 100
QUEUE_BYTES = 8 << 20
"""What waits at most for a peer that reads too slowly, whichever comes first."""
_LEAST = 2
"""Messages that wait at most in any case, however large they are."""
BLOCK = 60.0
"""s within which a block that was begun, or the last one of a connection, must be through."""
_TURN = 500
"""Blocks that are taken before everybody else has a turn."""
_MOST = 2000
"""Connections, where the system allows as many files."""
_FILES = 400
"""Of the process for other things: callers of the XML-RPC interface above all."""


class Traffic:
    """What all connections of a node hold together; on the loop's thread."""

    received_most = 128 << 20
    queued_most = 256 << 20
    """Bytes. Beyond, a connection that wants more is ended, or keeps the least."""

    def __init__(self) -> None:
        files, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
        self.most = _MOST if files < 0 else max(100, min(_MOST, files - _FILES))
        """Connections."""
        self.connections: dict[Connection, None] = {}
        self.received = 0
        """Bytes of blocks that are not complete."""
        self.queued = 0
        """Bytes that wait for peers; those of a message count for each that it waits for."""

    @property
    def full(self) -> bool:
        """Whether there can be no further connection."""
        return len(self.connections) >= self.most

    def sweep(self) -> None:
        """Ends connections whose peers take too long."""
        now = time.monotonic()
        for connection in list(self.connections):
            if connection.overdue(now):
                connection.close()


class Connection:
    """One peer; on the loop's thread.

    Args:
        loop: Watches it.
        sock: Connected.
        traffic: That it is a part of.
        on_block: Called with each block but the first.
        on_header: Called with the fields of the first block.
        on_close: Called once, when the connection is over.
    """

    def __init__(
        self,
        loop: Loop,
        sock: socket.socket,
        traffic: Traffic,
        *,
        on_header: Callable[[Connection, dict[str, str]], None],
    ) -> None:
        self._loop = loop
        self._sock = sock
        self._traffic = traffic
        self._on_header: Callable[[Connection, dict[str, str]], None] | None = on_header
        self.on_block: Callable[[bytes], None] = lambda _: None
        self.on_close: Callable[[], None] = lambda: None
        self.on_drop: Callable[[], None] = lambda: None
        self.peer = ""
        """The name of the node at the other end."""
        self.sent = 0
        """Bytes."""
        self.dropped = 0
        """Messages that the peer was too slow for."""
        self.closed = False
        self._received = bytearray()
        self._queue: deque[memoryview] = deque()
        self._queued = 0
        self._begun = False
        """Whether a part of the first message in the queue is sent."""
        self._closing = False
        self._held = False
        """Whether nothing is to be read for now."""
        self._counted = 0
        """Bytes of `_received` that `Traffic` knows."""
        self._since: float | None = time.monotonic()
        """When the header, the present block or the end was begun."""
        sock.setblocking(False)
        with contextlib.suppress(OSError):
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        traffic.connections[self] = None
        self._watch()

    def send(self, data: bytes) -> None:
        """Sends a block, its length in front; drops the oldest that waits if need be."""
        if self.closed:
            return
        view = memoryview(data)
        if not self._queue:
            view = self._write(view)
            if not view or self.closed:
                return
            self._begun = len(view) < len(data)
            self._queue.append(view)
            self._count_queued(len(view))
            self._watch()
            return
        self._queue.append(view)
        self._count_queued(len(view))
        self._shed()

    def hold(self) -> None:
        """Takes no further block until `go_on`."""
        self._held = True

    def go_on(self) -> None:
        """Takes blocks again, soon."""
        if self._held and not self.closed:
            self._held = False
            self._loop.post(self._take_blocks)

    def refuse(self, reason: str) -> None:
        """Tells the peer why it gets nothing, and ends the connection."""
        self.send(header.encode_header({"error": reason}))
        self.finish()

    def finish(self) -> None:
        """Ends the connection when all is sent."""
        if self._queue:
            self._closing = True
            self._since = time.monotonic()
            self._watch()
        else:
            self.close()

    def overdue(self, now: float) -> bool:
        """Whether the peer takes too long with its header, with a block, or with the end."""
        if self._since is None:
            return False
        return now - self._since > (HANDSHAKE if self._on_header else BLOCK)

    def close(self) -> None:
        """Ends the connection now."""
        if self.closed:
            return
        self.closed = True
        self._loop.forget(self._sock)
        self._sock.close()
        self._queue.clear()
        self._count_queued(-self._queued)
        self._received.clear()
        self._count_received()
        self._traffic.connections.pop(self, None)
        self.on_close()

    def _shed(self) -> None:
        while len(self._queue) > _LEAST and (
            len(self._queue) > QUEUE_COUNT
            or self._queued > QUEUE_BYTES
            or self._traffic.queued > self._traffic.queued_most
        ):
            oldest = 1 if self._begun else 0
            self._count_queued(-len(self._queue[oldest]))
            del self._queue[oldest]
            self.dropped += 1
            if self.dropped == 1:
                self.on_drop()

    def _ready(self, events: int) -> None:
        if events & WRITE and not self.closed:
            self._flush()
        if events & READ and not self.closed:
            self._read()

    def _write(self, view: memoryview) -> memoryview:
        """Sends what the system takes; returns the rest."""
        while view:
            try:
                count = self._sock.send(view)
            except BlockingIOError:
                break
            except OSError:
                self.close()
                break
            self.sent += count
            view = view[count:]
        return view

    def _flush(self) -> None:
        while self._queue:
            first = self._queue[0]
            rest = self._write(first)
            if self.closed:
                return
            self._count_queued(len(rest) - len(first))
            if rest:
                self._begun = self._begun or len(rest) < len(first)
                self._queue[0] = rest
                return
            self._queue.popleft()
            self._begun = False
        if self._closing:
            self.close()
        else:
            self._watch()

    def _watch(self) -> None:
        events = (0 if self._held else READ) | (WRITE if self._queue else 0)
        if events:
            self._loop.watch(self._sock, events, self._ready)
        else:
            self._loop.forget(self._sock)

    def _count_queued(self, count: int) -> None:
        self._queued += count
        self._traffic.queued += count

    def _count_received(self) -> None:
        self._traffic.received += len(self._received) - self._counted
        self._counted = len(self._received)

    def _read(self) -> None:
        data = taken(self._sock)
        if data is None:
            return
        if not data:
            self.close()
            return
        if self._closing:
            return
        self._received += data
        self._take_blocks()

    def _take_blocks(self) -> None:
        """Takes what is complete, but not for too long, and nothing while it is held."""
        received = self._received
        start = count = 0
        while not (self.closed or self._closing or self._held) and len(received) - start >= 4:
            (length,) = _LENGTH.unpack_from(received, start)
            if length > (header.LIMIT if self._on_header else LARGEST):
                self.close()
                return
            end = start + 4 + length
            if len(received) < end:
                break
            if count == _TURN:
                self.hold()
                self._loop.post(self.go_on)
                break
            block = bytes(memoryview(received)[start + 4 : end])
            start = end
            count += 1
            self._block(block)
        if self.closed:
            return
        if start:
            del received[:start]
        self._count_received()
        if self._traffic.received > self._traffic.received_most and received:
            self.close()
            return
        if not (self._closing or self._on_header):
            if not received or self._held:
                self._since = None
            elif start or self._since is None:
                self._since = time.monotonic()
        self._watch()

    def _block(self, block: bytes) -> None:
        if self._on_header is None:
            self.on_block(block)
            return
        begin, self._on_header = self._on_header, None
        try:
            fields = header.decode_header(block)
        except header.HeaderError:
            self.close()
            return
        self.peer = fields.get("callerid", "")
        begin(self, fields)


class Listener:
    """Takes connections on a port of its own; on the loop's thread.

    Args:
        loop: Watches it.
        address: To listen on; all of this computer's where empty.
        on_socket: Gets each connection.
    """

    def __init__(
        self, loop: Loop, address: str, on_socket: Callable[[socket.socket], None]
    ) -> None:
        self._loop = loop
        self._on_socket = on_socket
        self._sock = socket.create_server((address, 0), backlog=128)
        self._sock.setblocking(False)
        self.port: int = self._sock.getsockname()[1]
        loop.post(lambda: loop.watch(self._sock, READ, self._accept))

    def _accept(self, _: int) -> None:
        try:
            sock, _address = self._sock.accept()
        except BlockingIOError:
            return
        except OSError:
            # Out of file descriptors, say: look again later, not at once and for ever.
            self._loop.forget(self._sock)
            self._loop.after(0.5, lambda: self._loop.watch(self._sock, READ, self._accept))
            return
        self._on_socket(sock)
