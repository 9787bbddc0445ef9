"""MCAP records for reading and writing. Source: the MCAP specification."""

from __future__ import annotations

import enum
import struct
from collections.abc import Mapping

MAGIC = b"\x89MCAP0\r\n"


class Op(enum.IntEnum):
    """Type of a record."""

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
"""Header of a record: type and length."""
MESSAGE = struct.Struct("<HIQQ")
"""Header of a message: channel, sequence number, log time, publish time."""


def text(value: str) -> bytes:
    """Encodes a string."""
    return blob(value.encode(errors="surrogateescape"))


def blob(data: bytes) -> bytes:
    """Encodes bytes with a 32-bit length."""
    return struct.pack("<I", len(data)) + data


def mapping(values: Mapping[str, str]) -> bytes:
    """Encodes a map of strings."""
    return blob(b"".join(text(key) + text(value) for key, value in values.items()))


def record(op: Op, *parts: bytes) -> bytes:
    """Encodes a complete record."""
    body = b"".join(parts)
    return RECORD.pack(op, len(body)) + body
