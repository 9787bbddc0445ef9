"""What a client sends through a websocket, seen on its way to the server."""

from __future__ import annotations

from collections.abc import Callable

_LARGEST_TEXT = 1 << 20
_LARGEST = 16 << 20
"""Bytes of a message that is not text: a request with a whole description."""
_ALL = 64 << 20
"""Bytes of incomplete messages of all clients: the server behind holds them."""
_FULL = f"incomplete messages of all clients exceed {_ALL >> 20} MiB, and this one is the oldest"
_TEXT, _CONTROL = 1, 8
_LARGEST_CONTROL = 125
"""Source: RFC 6455, 5.5."""

Passes = Callable[[bytes], bool]


class Room:
    """Bytes of incomplete messages, of all clients of a server together.

    If they are full, the client whose message began first is disconnected: otherwise a few idle
    clients with incomplete messages would keep all others from sending.
    """

    def __init__(self, most: int = _ALL) -> None:
        self._left = most
        self._held: dict[Frames, int] = {}
        """Bytes of each incomplete message, in the order in which the messages began."""

    def take(self, holder: Frames, size: int) -> None:
        """Raises:
        FrameError: The holder's own message is the first that has to go.
        """
        while size > self._left:
            oldest = next(iter(self._held), holder)
            if oldest is holder:
                raise FrameError(_FULL)
            self.give_back(oldest)
            oldest.evict()
        self._left -= size
        self._held[holder] = self._held.get(holder, 0) + size

    def give_back(self, holder: Frames) -> None:
        """The message of a holder is complete, or its client is disconnected."""
        self._left += self._held.pop(holder, 0)


class FrameError(Exception):
    """What a client sent is no frame, or part of a message that is too large."""


class Frames:
    """Holds each text of a client until it is complete and judged; the rest passes at once.

    The server behind checks the frames themselves; what counts here is only where they end.

    Args:
        passes: Whether the server behind gets a text.
        room: For incomplete messages.
        disconnect: Called if the room is needed for the messages of other clients.

    Attributes:
        fault: Why the client has to be disconnected; empty as long as it may stay.
    """

    def __init__(self, passes: Passes, room: Room, disconnect: Callable[[], object]) -> None:
        self.fault = ""
        self._passes = passes
        self._room = room
        self._disconnect = disconnect
        self._head = bytearray()
        self._left = 0
        """Bytes of the current frame that are still to come."""
        self._is_open = False
        """Whether a message has begun and not ended."""
        self._is_text = False
        """Whether the current message is text."""
        self._is_held = False
        """Whether the current frame is part of a text."""
        self._is_last = False
        self._is_control = False
        self._mask = b""
        self._turn = 0
        """Place in the mask."""
        self._held = bytearray()
        """Frames of the current text as they came."""
        self._text = bytearray()
        self._size = 0
        """Bytes of the current message."""

    def close(self) -> None:
        """The client has gone."""
        self._room.give_back(self)

    def evict(self) -> None:
        """Disconnects the client: others need the room of its incomplete message."""
        self.fault = _FULL
        self._disconnect()

    def feed(self, data: memoryview) -> bytes:
        """What the server behind gets now.

        Raises:
            FrameError: A message is too large, or its frames are malformed.
        """
        try:
            return self._fed(data)
        except FrameError as error:
            self.fault = str(error)
            raise

    def _fed(self, data: memoryview) -> bytes:
        out = bytearray()
        while data:
            if not self._left:
                data = self._begin(data, out)
                continue
            part, data = data[: self._left], data[self._left :]
            self._left -= len(part)
            self._take(len(part))
            if self._is_held:
                self._held += part
                self._text += self._unmasked(part)
            else:
                out += part
            if not self._left:
                self._end(out)
        return bytes(out)

    def _begin(self, data: memoryview, out: bytearray) -> memoryview:
        """Takes the head of a frame, once all of it is there."""
        head = self._head
        missing = _head_size(head) - len(head)
        head += data[:missing]
        data = data[missing:]
        if len(head) < _head_size(head):
            return data
        kind, length = head[0] & 15, head[1] & 127
        if not head[1] & 128:
            raise FrameError("a frame has no mask")
        if length == 126:
            length = int.from_bytes(head[2:4])
        elif length == 127:
            length = int.from_bytes(head[2:10])
        self._is_control = kind >= _CONTROL
        if self._is_control:
            if length > _LARGEST_CONTROL:
                raise FrameError(f"a control frame has more than {_LARGEST_CONTROL} bytes")
        elif self._is_open == bool(kind):
            raise FrameError("a frame starts or continues a message out of sequence")
        elif kind:
            self._is_open, self._is_text, self._size = True, kind == _TEXT, 0
        # The heads count as well: there may be any number of frames without content.
        self._size += length + len(head)
        most = _LARGEST_TEXT if self._is_text else _LARGEST
        if self._size > most:
            raise FrameError(f"a message has more than {most} bytes")
        self._left = length
        self._is_held = self._is_text and not self._is_control
        self._is_last = bool(head[0] & 128)
        self._mask, self._turn = bytes(head[-4:]), 0
        (self._held if self._is_held else out).extend(head)
        self._take(len(head))
        head.clear()
        if not length:
            self._end(out)
        return data

    def _end(self, out: bytearray) -> None:
        """The current frame is complete."""
        if self._is_control or not self._is_last:
            return
        self.close()
        self._is_open = False
        if self._is_held:
            if self._passes(bytes(self._text)):
                out += self._held
            self._held.clear()
            self._text.clear()
            self._is_text = False

    def _take(self, size: int) -> None:
        if not self._is_control:
            self._room.take(self, size)

    def _unmasked(self, part: memoryview) -> bytes:
        turn, size = self._turn % 4, len(part)
        self._turn += size
        mask = (self._mask * (size // 4 + 2))[turn : turn + size]
        return (int.from_bytes(part) ^ int.from_bytes(mask)).to_bytes(size)


def _head_size(head: bytearray) -> int:
    """Bytes of a frame's head, as far as is known."""
    if len(head) < 2:
        return 2
    return 2 + {126: 2, 127: 8}.get(head[1] & 127, 0) + (4 if head[1] & 128 else 0)
