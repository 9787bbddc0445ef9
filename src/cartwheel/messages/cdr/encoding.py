"""Messages as CDR bytes. Each message is serialised once for all wires."""

from __future__ import annotations

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
    """Cache of the bytes of the last message. Thread-safe.

    All subscribers of a topic receive the same message object, one after the other. Its identity is
    the key of its bytes, on all wires.
    """

    def __init__(self) -> None:
        self._last: tuple[Any, bytes] = (None, b"")

    def encode(self, message: Any) -> bytes:
        """CDR bytes of a message; see `encode_cdr`."""
        known, data = self._last
        if known is not message:
            data = encode_cdr(message)
            # The reference to the message prevents reuse of its identity.
            self._last = (message, data)
        return data

    def forget(self) -> None:
        """Forgets the last message, which may be published again with other values."""
        self._last = (None, b"")
