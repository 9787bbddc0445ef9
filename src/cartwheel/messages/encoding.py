"""Messages as CDR bytes, each serialised once however many want it."""

from __future__ import annotations

import threading
from collections import deque
from typing import Any

from cartwheel.errors import GraphError
from cartwheel.messages.store import message_class, store


def encode_cdr(message: Any) -> bytes:
    """A message as CDR with its four bytes of encapsulation, as ROS 2 and MCAP carry it."""
    return bytes(store().serialize_cdr(message, message.__msgtype__))


def decode_cdr(data: bytes | memoryview, type_name: str) -> Any:
    """The message of CDR bytes; its arrays are views of them.

    Raises:
        UnknownNameError: There is no such type.
        GraphError: The bytes are none of that type.
    """
    full = message_class(type_name).__msgtype__
    try:
        return store().deserialize_cdr(data, full)
    except Exception as error:  # rosbags lets whatever its generated code meets through
        raise GraphError(f"{len(data)} bytes are no {full}: {error}") from error


class CdrCache:
    """The bytes of the last messages of each topic; for any thread.

    A message goes to all readers of its wire as the same object: its identity tells that
    it is the one whose bytes are there already.

    Args:
        depth: How many messages of a topic to keep; more than 1 where readers may lag
            behind each other.
    """

    def __init__(self, *, depth: int = 1) -> None:
        self._depth = depth
        self._lock = threading.Lock()
        self._kept: dict[str, deque[tuple[Any, bytes]]] = {}

    def encode(self, topic: str, message: Any) -> bytes:
        """The message's CDR bytes."""
        with self._lock:
            kept = self._kept.setdefault(topic, deque(maxlen=self._depth))
            for known, data in kept:
                if known is message:
                    return data
            data = encode_cdr(message)
            # Holding the message keeps its identity from being given to another.
            kept.append((message, data))
            return data

    def forget(self, topic: str) -> None:
        """Drops what is kept of a topic that nobody reads any more."""
        with self._lock:
            self._kept.pop(topic, None)
