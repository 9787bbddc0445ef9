"""Messages as CDR bytes, each serialised once however many want it."""

from __future__ import annotations

import threading
from typing import Any

from cartwheel.codes.graph import MESSAGE_NOT_DECODABLE
from cartwheel.errors import GraphError
from cartwheel.messages.cdr_writing import encode_cdr
from cartwheel.messages.store import loaded, message_class


def decode_cdr(data: bytes | memoryview, type_name: str, *, padded: bool = False) -> Any:
    """The message of CDR bytes; its arrays are views of them.

    Args:
        data: The bytes.
        type_name: Of the message.
        padded: Whether any number of zero bytes may follow it.

    Raises:
        UnknownNameError: There is no such type.
        GraphError: The bytes are none of that type.
    """
    full = message_class(type_name).__msgtype__
    try:
        if padded:
            data = memoryview(data)[: _size(data, full)]
        return loaded().deserialize_cdr(data, full)
    except Exception as error:  # rosbags lets whatever its generated code meets through
        raise GraphError(
            f"{len(data)} bytes cannot be decoded as {full}: {error}",
            code=MESSAGE_NOT_DECODABLE,
            values={"type": full, "bytes": len(data)},
        ) from error


def _size(data: bytes | memoryview, full: str) -> int:
    """Of a message that zero bytes follow; of all bytes where others do."""
    definition = loaded().get_msgdef(full)
    little = bool(data[1])
    read = definition.deserialize_cdr_le if little else definition.deserialize_cdr_be
    end = 4 + int(read(data[4:], 0, definition.cls, loaded())[1])
    return len(data) if any(data[end:]) else end


class CdrCache:
    """The bytes of the last messages; for any thread.

    A message goes to all readers as the same object: its identity tells that it is the one whose
    bytes are there already, on whichever wire they go out.

    Args:
        count: How many messages to keep: more than 1, as readers lag behind each other.
        room: Bytes to keep at most.
    """

    def __init__(self, *, count: int = 64, room: int = 32 << 20) -> None:
        self._count = count
        self._room = room
        self._lock = threading.Lock()
        self._kept: dict[int, tuple[Any, bytes]] = {}
        self._size = 0

    def encode(self, message: Any) -> bytes:
        """The message's CDR bytes, as of `encode_cdr`."""
        with self._lock:
            known = self._kept.get(id(message))
            if known is not None:
                return known[1]
            data = encode_cdr(message)
            # Holding the message keeps its identity from being given to another.
            self._kept[id(message)] = (message, data)
            self._size += len(data)
            while len(self._kept) > self._count or (self._size > self._room and self._kept):
                _, oldest = self._kept.pop(next(iter(self._kept)))
                self._size -= len(oldest)
            return data
