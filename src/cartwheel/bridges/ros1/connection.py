"""A TCP connection for blocks with a length prefix, as in TCPROS."""

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
"""Timeout in s for the header of a connection."""
LARGEST = 64 << 20
"""Maximum size in bytes of a received message or request."""
QUEUE_COUNT = 100
QUEUE_BYTES = 8 << 20
"""Maximum size of the queue for a slow peer. Either limit may apply first."""
_LEAST = 2
"""Number of queued messages that are always allowed, regardless of their size."""
BLOCK = 60.0
"""Timeout in s for receiving a block once it has begun, and for sending the last block."""
_TURN = 500
"""Number of blocks to process before other connections have a turn."""
_MOST = 2000
"""Maximum number of connections, unless the limit on open files is lower."""
_FILES = 400
"""File descriptors reserved for other uses, mainly for clients of the XML-RPC interface."""


class Traffic:
    """Limits for all connections of a node. Used on the loop's thread."""

    received_most = 128 << 20
    queued_most = 256 << 20
    """Maximum bytes. Above them, a receiving connection is closed, and a sending one drops
    messages."""

    def __init__(self) -> None:
        files, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
        self.most = _MOST if files < 0 else max(100, min(_MOST, files - _FILES))
        """Maximum number of connections."""
        self.connections: dict[Connection, None] = {}
        self.received = 0
        """Bytes of incomplete blocks."""
        self.queued = 0
        """Bytes queued for peers. A message counts once for each peer."""

    @property
    def full(self) -> bool:
        """Whether the limit on connections is reached."""
        return len(self.connections) >= self.most

    def sweep(self) -> None:
        """Closes connections whose peers exceed a timeout."""
        now = time.monotonic()
        for connection in list(self.connections):
            if connection.overdue(now):
                connection.close()


class Connection:
    """A connection to a peer. Used on the loop's thread.

    Args:
        loop: Event loop of the connection.
        sock: Connected socket.
        traffic: Limits that the connection shares.
        on_block: Called with each block except the first.
        on_header: Called with the fields of the first block.
        on_close: Called once, when the connection is closed.
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
        """Name of the connected node."""
        self.sent = 0
        """Number of bytes sent."""
        self.dropped = 0
        """Number of messages dropped because the peer was too slow."""
        self.closed = False
        self._received = bytearray()
        self._queue: deque[memoryview] = deque()
        self._queued = 0
        self._begun = False
        """Whether the first queued message is partly sent."""
        self._closing = False
        self._held = False
        """Whether reading is paused."""
        self._counted = 0
        """Bytes of `_received` that `Traffic` already counts."""
        self._since: float | None = time.monotonic()
        """Start time of the header, of the current block, or of the last send."""
        sock.setblocking(False)
        with contextlib.suppress(OSError):
            sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        traffic.connections[self] = None
        self._watch()

    def send(self, data: bytes) -> None:
        """Sends a block with its length prefix. Drops the oldest queued block if necessary."""
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
        """Pauses reading until `go_on`."""
        self._held = True

    def go_on(self) -> None:
        """Resumes reading soon."""
        if self._held and not self.closed:
            self._held = False
            self._loop.post(self._take_blocks)

    def refuse(self, reason: str) -> None:
        """Sends an error to the peer, and closes the connection."""
        self.send(header.encode_header({"error": reason}))
        self.finish()

    def finish(self) -> None:
        """Closes the connection after all data is sent."""
        if self._queue:
            self._closing = True
            self._since = time.monotonic()
            self._watch()
        else:
            self.close()

    def overdue(self, now: float) -> bool:
        """Whether the peer exceeds the timeout of its header, of a block, or of the last send."""
        if self._since is None:
            return False
        return now - self._since > (HANDSHAKE if self._on_header else BLOCK)

    def close(self) -> None:
        """Closes the connection now."""
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
        """Sends what the system accepts. Returns the rest."""
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
        """Processes complete blocks, up to a limit and unless reading is paused."""
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
    """Accepts connections on its own port. Used on the loop's thread.

    Args:
        loop: Event loop of the socket.
        address: Address to listen on; empty for all addresses.
        on_socket: Called with each accepted socket.
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
            # For example, no file descriptor is free. Retry later instead of in a busy loop.
            self._loop.forget(self._sock)
            self._loop.after(0.5, lambda: self._loop.watch(self._sock, READ, self._accept))
            return
        self._on_socket(sock)
