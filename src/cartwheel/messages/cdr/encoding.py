"""Messages as CDR bytes. Each message is serialised once for all wires."""

from __future__ import annotations

import threading
from typing import Any

from cartwheel.codes.graph import MESSAGE_NOT_DECODABLE
from cartwheel.errors import GraphError
from cartwheel.messages.cdr.reading import has_wide_text, read_cdr
from cartwheel.messages.cdr.writing import encode_cdr
from cartwheel.messages.store import loaded, message_class


def decode_cdr(data: bytes | memoryview, type_name: str, *, padded: bool = False) -> Any:
    """Decodes CDR bytes. The message's arrays are views of the bytes.

    Args:
        data: Encoded message.
        type_name: Type of the message.
        padded: Whether any number of zero bytes may follow the message.

    Raises:
        UnknownNameError: The type does not exist.
        GraphError: The bytes are not a message of that type.
    """
    full = message_class(type_name).__msgtype__
    try:
        if has_wide_text(full):
            return read_cdr(data, full, padded=padded)
        if padded:
            data = memoryview(data)[: _size(data, full)]
        return loaded().deserialize_cdr(data, full)
    except Exception as error:  # rosbags does not catch the errors of its generated code
        raise GraphError(
            f"{len(data)} bytes cannot be decoded as {full}: {error}",
            code=MESSAGE_NOT_DECODABLE,
            values={"type": full, "bytes": len(data)},
        ) from error


def _size(data: bytes | memoryview, full: str) -> int:
    """Size of a message if only zero bytes follow it; otherwise the size of all bytes."""
    definition = loaded().get_msgdef(full)
    little = bool(data[1])
    read = definition.deserialize_cdr_le if little else definition.deserialize_cdr_be
    end = 4 + int(read(data[4:], 0, definition.cls, loaded())[1])
    return len(data) if any(data[end:]) else end


class CdrCache:
    """Cache of the bytes of recent messages. Thread-safe.

    All subscribers receive the same message object. Its identity is the key of its bytes, on all
    wires.

    Args:
        count: Maximum number of messages; more than 1, because subscribers lag behind each other.
        room: Maximum size in bytes.
    """

    def __init__(self, *, count: int = 64, room: int = 32 << 20) -> None:
        self._count = count
        self._room = room
        self._lock = threading.Lock()
        self._kept: dict[int, tuple[Any, bytes]] = {}
        self._size = 0

    def encode(self, message: Any) -> bytes:
        """CDR bytes of a message; see `encode_cdr`."""
        with self._lock:
            known = self._kept.get(id(message))
            if known is not None:
                return known[1]
            data = encode_cdr(message)
            # A reference to the message prevents reuse of its identity.
            self._kept[id(message)] = (message, data)
            self._size += len(data)
            while len(self._kept) > self._count or (self._size > self._room and self._kept):
                _, oldest = self._kept.pop(next(iter(self._kept)))
                self._size -= len(oldest)
            return data
