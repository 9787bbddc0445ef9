"""Filter for the websocket messages of a client on their way to the server."""

from __future__ import annotations

from collections.abc import Callable

_LARGEST_TEXT = 1 << 20
_LARGEST = 16 << 20
"""Maximum size in bytes of a binary message: a request with a complete robot description."""
_ALL = 64 << 20
"""Maximum bytes of incomplete messages of all clients, which the server behind buffers."""
_FULL = (
    f"the incomplete messages of all clients together exceed {_ALL >> 20} MiB, and this client's "
    "is the oldest"
)
_TEXT, _CONTROL = 1, 8
_LARGEST_CONTROL = 125
"""Source: RFC 6455, 5.5."""

Passes = Callable[[bytes], bool]


class Room:
    """Byte budget for incomplete messages, shared by all clients of a server.

    When the budget is used up, the client whose message began first is disconnected.
    Otherwise a few idle clients with incomplete messages would block all others.
    """

    def __init__(self, most: int = _ALL) -> None:
        self._left = most
        self._held: dict[Frames, int] = {}
        """Bytes of each incomplete message, in the order in which the messages began."""

    def take(self, holder: Frames, size: int) -> None:
        """Reserves bytes for a holder's incomplete message.

        Raises:
            FrameError: The budget is used up, and the holder's own message is the oldest.
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
        """Releases the bytes of a holder whose message is complete, or whose client is gone."""
        self._left += self._held.pop(holder, 0)


class FrameError(Exception):
    """A client sent a malformed frame, or a message that is too large."""


class Frames:
    """Holds each text message until it is complete and checked. All else passes at once.

    The server behind validates the frames. This class only finds where frames end.

    Args:
        passes: Whether to forward a text message to the server behind.
        room: Byte budget for incomplete messages.
        disconnect: Called if other clients need the budget.

    Attributes:
        fault: Why the client must be disconnected; empty if there is no reason.
    """

    def __init__(self, passes: Passes, room: Room, disconnect: Callable[[], object]) -> None:
        self.fault = ""
        self._passes = passes
        self._room = room
        self._disconnect = disconnect
        self._head = bytearray()
        self._left = 0
        """Remaining bytes of the current frame."""
        self._is_open = False
        """Whether a message has begun but not ended."""
        self._is_text = False
        """Whether the current message is text."""
        self._is_held = False
        """Whether the current frame belongs to a text message."""
        self._is_last = False
        self._is_control = False
        self._mask = b""
        self._turn = 0
        """Offset into the mask."""
        self._held = bytearray()
        """Received frames of the current text message."""
        self._text = bytearray()
        self._size = 0
        """Size of the current message in bytes."""

    def close(self) -> None:
        """Releases the byte budget of the client."""
        self._room.give_back(self)

    def evict(self) -> None:
        """Disconnects the client, because other clients need its share of the budget."""
        self.fault = _FULL
        self._disconnect()

    def feed(self, data: memoryview) -> bytes:
        """Processes received bytes, and returns the bytes to forward to the server.

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
        """Reads the header of a frame once it is complete. Returns the remaining data."""
        head = self._head
        missing = _head_size(head) - len(head)
        head += data[:missing]
        data = data[missing:]
        if len(head) < _head_size(head):
            return data
        kind, length = head[0] & 15, head[1] & 127
        if not head[1] & 128:
            raise FrameError("a WebSocket frame is not masked")
        if length == 126:
            length = int.from_bytes(head[2:4])
        elif length == 127:
            length = int.from_bytes(head[2:10])
        self._is_control = kind >= _CONTROL
        if self._is_control:
            if length > _LARGEST_CONTROL:
                raise FrameError(
                    f"a WebSocket control frame is larger than {_LARGEST_CONTROL} bytes"
                )
        elif self._is_open == bool(kind):
            raise FrameError("a WebSocket frame starts or continues a message out of sequence")
        elif kind:
            self._is_open, self._is_text, self._size = True, kind == _TEXT, 0
        # Headers count as well, because a message may consist of any number of empty frames.
        self._size += length + len(head)
        most = _LARGEST_TEXT if self._is_text else _LARGEST
        if self._size > most:
            raise FrameError(f"a WebSocket message is larger than {most} bytes")
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
        """Handles the end of the current frame."""
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
    """Size of a frame's header in bytes, as far as it is known."""
    if len(head) < 2:
        return 2
    return 2 + {126: 2, 127: 8}.get(head[1] & 127, 0) + (4 if head[1] & 128 else 0)
