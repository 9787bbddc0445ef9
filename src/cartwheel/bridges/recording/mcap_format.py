"""The records of MCAP, as far as both ways need them. Source: the MCAP specification."""

from __future__ import annotations

import enum
import struct
from collections.abc import Mapping

MAGIC = b"\x89MCAP0\r\n"


class Op(enum.IntEnum):
    """What a record is."""

    HEADER = 0x01
    FOOTER = 0x02
    SCHEMA = 0x03
    CHANNEL = 0x04
    MESSAGE = 0x05
    CHUNK = 0x06
    MESSAGE_INDEX = 0x07
    CHUNK_INDEX = 0x08
    ATTACHMENT = 0x09
    ATTACHMENT_INDEX = 0x0A
    STATISTICS = 0x0B
    METADATA = 0x0C
    METADATA_INDEX = 0x0D
    SUMMARY_OFFSET = 0x0E
    DATA_END = 0x0F


RECORD = struct.Struct("<BQ")
"""Op and length before each record."""
MESSAGE = struct.Struct("<HIQQ")
"""Channel, number, log time and publish time before a message's bytes."""


def text(value: str) -> bytes:
    """A string."""
    data = value.encode(errors="surrogateescape")
    return struct.pack("<I", len(data)) + data


def blob(data: bytes) -> bytes:
    """Bytes with a 32-bit length."""
    return struct.pack("<I", len(data)) + data


def mapping(values: Mapping[str, str]) -> bytes:
    """Strings by strings."""
    return blob(b"".join(text(key) + text(value) for key, value in values.items()))


def record(op: Op, *parts: bytes) -> bytes:
    """A whole record."""
    body = b"".join(parts)
    return RECORD.pack(op, len(body)) + body
