"""Headers of TCPROS connections."""

from __future__ import annotations

import struct
from collections.abc import Mapping

_LENGTH = struct.Struct("<I")

LIMIT = 128 << 10
"""Maximum size in bytes. A definition with all nested types has some ten thousand."""
FIELDS = 100


class HeaderError(ValueError):
    """The bytes are not a valid header."""


def encode_header(fields: Mapping[str, str]) -> bytes:
    """Encodes a header with its length prefix."""
    parts = []
    for name, value in fields.items():
        field = f"{name}={value}".encode()
        parts += [_LENGTH.pack(len(field)), field]
    body = b"".join(parts)
    return _LENGTH.pack(len(body)) + body


def decode_header(body: bytes | memoryview) -> dict[str, str]:
    """Decodes a header without its length prefix.

    Raises:
        HeaderError: The bytes are not a valid header.
    """
    fields: dict[str, str] = {}
    data = bytes(body)
    offset = 0
    while offset < len(data):
        if len(fields) >= FIELDS:
            raise HeaderError(f"the TCPROS header has more than {FIELDS} fields")
        if offset + 4 > len(data):
            raise HeaderError("a field of the TCPROS header is truncated")
        (length,) = _LENGTH.unpack_from(data, offset)
        offset += 4
        if offset + length > len(data):
            raise HeaderError(
                f"a field of the TCPROS header is {length} bytes long, but only "
                f"{len(data) - offset} bytes remain"
            )
        name, sign, value = data[offset : offset + length].partition(b"=")
        if not sign:
            raise HeaderError('a field of the TCPROS header contains no "="')
        fields[name.decode(errors="replace")] = value.decode(errors="replace")
        offset += length
    return fields
