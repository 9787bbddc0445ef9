"""Messages as CDR bytes, each serialised once however many want it."""

from __future__ import annotations

import threading
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
    """The bytes of the last message of each topic; for any thread.

    A message goes to all readers of its wire as the same object: its identity tells that
    it is the one whose bytes are there already.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._last: dict[str, tuple[Any, bytes]] = {}

    def encode(self, topic: str, message: Any) -> bytes:
        """The message's CDR bytes."""
        with self._lock:
            last = self._last.get(topic)
            if last is not None and last[0] is message:
                return last[1]
            data = encode_cdr(message)
            # Holding the message keeps its identity from being given to another.
            self._last[topic] = (message, data)
            return data

    def forget(self, topic: str) -> None:
        """Drops what is kept of a topic that nobody reads any more."""
        with self._lock:
            self._last.pop(topic, None)
