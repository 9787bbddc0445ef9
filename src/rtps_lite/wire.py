"""Encoding and decoding of RTPS messages."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

VERSION = b"\x02\x03"
VENDOR = b"\x01\x64"
"""Vendor ID of this implementation, above the assigned ones."""
CYCLONE = b"\x01\x10"

Prefix = bytes
"""12-byte prefix of a participant."""
Guid = bytes
"""16-byte identifier of an endpoint: the participant's prefix and 4 bytes of its own."""

UNKNOWN = b"\0\0\0\0"
"""Entity ID for all matching endpoints."""
LARGEST = 60000
"""Maximum bytes of a sample in one datagram. Larger samples are split into fragments of this
size."""

_ACKNACK, _HEARTBEAT, _GAP, _INFO_TS, _INFO_SRC, _INFO_DST = 0x06, 0x07, 0x08, 0x09, 0x0C, 0x0E
_NACK_FRAG, _DATA, _DATA_FRAG = 0x12, 0x15, 0x16
_LITTLE, _INLINE, _PAYLOAD, _KEY = 0x01, 0x02, 0x04, 0x08
_FINAL = 0x02
_MOST_BITS = 256
"""Maximum number of bits in a sequence number set."""
_MOST_SUBMESSAGES = 256
"""Maximum number of submessages per datagram. Common are some ten, and each may need a
response."""


class MalformedError(ValueError):
    """The bytes are not a valid RTPS message."""


@dataclass(frozen=True, slots=True)
class Data:
    """A sample, or a fragment of one."""

    reader: bytes
    writer: bytes
    number: int
    inline: dict[int, bytes]
    payload: bytes
    keyed: bool
    """Whether the payload is only the key of a disposed participant or endpoint."""
    fragment: int = 0
    """One-based number of the first fragment; 0 for a complete sample."""
    fragment_size: int = 0
    size: int = 0
    """Size of the complete sample, if this is a fragment."""


@dataclass(frozen=True, slots=True)
class Heartbeat:
    """Sample numbers that a writer has."""

    reader: bytes
    writer: bytes
    first: int
    last: int
    count: int
    final: bool
    """Whether a reader without missing samples need not respond."""


@dataclass(frozen=True, slots=True)
class Acknack:
    """Samples that a reader has or lacks: it has all below `base`, and lacks `missing`."""

    reader: bytes
    writer: bytes
    base: int
    missing: tuple[int, ...]
    count: int
    final: bool


@dataclass(frozen=True, slots=True)
class Gap:
    """Samples that a reader must not wait for."""

    reader: bytes
    writer: bytes
    start: int
    base: int
    """The samples from `start` to below this number belong to the gap."""
    more: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class NackFrag:
    """Fragments that a reader lacks."""

    reader: bytes
    writer: bytes
    number: int
    missing: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Received:
    """A submessage with the data from its message header."""

    prefix: Prefix
    """Prefix of the sender."""
    vendor: bytes
    to: Prefix | None
    """Prefix of the receiver; None for all."""
    content: Data | Heartbeat | Acknack | Gap | NackFrag


# -- writing


def message(sender: Prefix, *submessages: bytes, to: Prefix | None = None) -> bytes:
    """Encodes a message header and submessages."""
    parts = [b"RTPS", VERSION, VENDOR, sender]
    if to is not None:
        parts += (struct.pack("<BBH", _INFO_DST, _LITTLE, 12), to)
    return b"".join((*parts, *submessages))


def timestamp(seconds: int, fraction: int) -> bytes:
    """Encodes the write time of the following submessages; `fraction` in 1/2³² s."""
    return struct.pack("<BBHII", _INFO_TS, _LITTLE, 8, seconds & 0xFFFFFFFF, fraction & 0xFFFFFFFF)


def data_head(
    *, reader: bytes, writer: bytes, number: int, inline: bytes, size: int, keyed: bool = False
) -> bytes:
    """Encodes a sample's header for a payload of `size` bytes, a multiple of 4."""
    flags = _LITTLE | (_INLINE if inline else 0)
    if size:
        flags |= _KEY if keyed else _PAYLOAD
    return (
        struct.pack("<BBHHH", _DATA, flags, 20 + len(inline) + size, 0, 16)
        + reader
        + writer
        + _number(number)
        + inline
    )


def fragment_head(
    *,
    reader: bytes,
    writer: bytes,
    number: int,
    inline: bytes,
    fragment: int,
    length: int,
    size: int,
) -> bytes:
    """Encodes a fragment's header for `length` bytes of a sample of `size` bytes."""
    return (
        struct.pack(
            "<BBHHH", _DATA_FRAG, _LITTLE | (_INLINE if inline else 0), 32 + len(inline) + length,
            0, 28,
        )
        + reader
        + writer
        + _number(number)
        + struct.pack("<IHHI", fragment, 1, LARGEST, size)
        + inline
    )  # fmt: skip


def heartbeat(
    *, reader: bytes, writer: bytes, first: int, last: int, count: int, final: bool
) -> bytes:
    """See `Heartbeat`."""
    return (
        struct.pack("<BBH", _HEARTBEAT, _LITTLE | (_FINAL if final else 0), 28)
        + reader
        + writer
        + _number(first)
        + _number(last)
        + struct.pack("<i", count)
    )


def acknack(
    *, reader: bytes, writer: bytes, base: int, missing: Iterable[int], count: int, final: bool
) -> bytes:
    """See `Acknack`."""
    numbers = _number_set(base, missing)
    body = reader + writer + numbers + struct.pack("<i", count)
    return struct.pack("<BBH", _ACKNACK, _LITTLE | (_FINAL if final else 0), len(body)) + body


def gap(*, reader: bytes, writer: bytes, numbers: Sequence[int]) -> bytes:
    """Encodes samples that a reader must not wait for. The numbers must be sorted.

    Numbers beyond `_MOST_BITS` from the end of the first contiguous range are omitted.
    """
    end = numbers[0]
    for number in numbers:
        if number != end:
            break
        end += 1
    body = reader + writer + _number(numbers[0]) + _number_set(end, numbers)
    return struct.pack("<BBH", _GAP, _LITTLE, len(body)) + body


def _number(value: int) -> bytes:
    return struct.pack("<iI", value >> 32, value & 0xFFFFFFFF)


def _number_set(base: int, numbers: Iterable[int]) -> bytes:
    offsets = [number - base for number in numbers if 0 <= number - base < _MOST_BITS]
    bits = max(offsets) + 1 if offsets else 0
    words = [0] * ((bits + 31) // 32)
    for offset in offsets:
        words[offset // 32] |= 1 << (31 - offset % 32)
    return _number(base) + struct.pack(f"<I{len(words)}I", bits, *words)


# -- reading


def read(data: memoryview) -> Iterator[Received]:
    """Decodes the submessages of a datagram.

    Raises:
        MalformedError: The datagram is invalid from this point on.
    """
    try:
        yield from _read(data)
    except (struct.error, IndexError) as error:
        raise MalformedError(str(error)) from None


def _read(data: memoryview) -> Iterator[Received]:
    if len(data) < 20 or bytes(data[:4]) != b"RTPS" or data[4] != 2:
        raise MalformedError("the RTPS header is missing or invalid")
    vendor, prefix = bytes(data[6:8]), bytes(data[8:20])
    to: Prefix | None = None
    at = 20
    count = 0
    while at + 4 <= len(data):
        count += 1
        if count > _MOST_SUBMESSAGES:
            raise MalformedError("too many submessages")
        kind, flags = data[at], data[at + 1]
        order = "<" if flags & _LITTLE else ">"
        (length,) = struct.unpack_from(f"{order}H", data, at + 2)
        at += 4
        # A length of zero in the last submessage means "up to the end".
        if length == 0 and kind not in (_INFO_TS, 0x01):
            length = len(data) - at
        body = data[at : at + length]
        if len(body) < length:
            raise MalformedError("the message is truncated")
        at += length
        if kind == _INFO_DST:
            if len(body) < 12:
                raise MalformedError("the message is truncated")
            to = bytes(body[:12])
            if to == bytes(12):
                to = None
        elif kind == _INFO_SRC:
            if len(body) < 20:
                raise MalformedError("the message is truncated")
            vendor, prefix = bytes(body[6:8]), bytes(body[8:20])
        else:
            content = _content(kind, flags, order, body)
            if content is not None:
                yield Received(prefix, vendor, to, content)


def _content(
    kind: int, flags: int, order: str, body: memoryview
) -> Data | Heartbeat | Acknack | Gap | NackFrag | None:
    if kind in (_DATA, _DATA_FRAG):
        return _read_data(kind, flags, order, body)
    reader, writer = bytes(body[:4]), bytes(body[4:8])
    if kind == _HEARTBEAT:
        first, last = _read_number(order, body, 8), _read_number(order, body, 16)
        (count,) = struct.unpack_from(f"{order}i", body, 24)
        return Heartbeat(reader, writer, first, last, count, bool(flags & _FINAL))
    if kind == _ACKNACK:
        base, missing, at = _read_number_set(order, body, 8)
        (count,) = struct.unpack_from(f"{order}i", body, at)
        return Acknack(reader, writer, base, missing, count, bool(flags & _FINAL))
    if kind == _GAP:
        base, more, _ = _read_number_set(order, body, 16)
        return Gap(reader, writer, _read_number(order, body, 8), base, more)
    if kind == _NACK_FRAG:
        number = _read_number(order, body, 8)
        base, bits = struct.unpack_from(f"{order}II", body, 16)
        return NackFrag(reader, writer, number, _read_bits(order, body, 24, base, bits)[0])
    return None


def _read_data(kind: int, flags: int, order: str, body: memoryview) -> Data:
    (skip,) = struct.unpack_from(f"{order}H", body, 2)
    reader, writer = bytes(body[4:8]), bytes(body[8:12])
    number = _read_number(order, body, 12)
    at = 4 + skip
    inline: dict[int, bytes] = {}
    if flags & _INLINE:
        inline, at = read_parameters(order, body, at)
    payload = bytes(body[at:])
    if kind == _DATA:
        keyed = bool(flags & _KEY)
        if not flags & (_PAYLOAD | _KEY):
            payload = b""
        return Data(reader, writer, number, inline, payload, keyed)
    fragment, _count, fragment_size, size = struct.unpack_from(f"{order}IHHI", body, 20)
    if fragment < 1 or fragment_size < 1:
        raise MalformedError("the number or size of a fragment is 0")
    return Data(
        reader, writer, number, inline, payload, bool(flags & _PAYLOAD),
        fragment, fragment_size, size,
    )  # fmt: skip


def read_parameters(order: str, body: memoryview, at: int) -> tuple[dict[int, bytes], int]:
    """Decodes a parameter list. Returns the first parameter of each kind, and the end offset."""
    found: dict[int, bytes] = {}
    while True:
        name, length = struct.unpack_from(f"{order}HH", body, at)
        at += 4
        if name == 1:
            return found, at
        if at + length > len(body):
            raise MalformedError("the message is truncated in a parameter")
        found.setdefault(name & 0xBFFF, bytes(body[at : at + length]))
        at += length


def _read_number(order: str, body: memoryview, at: int) -> int:
    high, low = struct.unpack_from(f"{order}iI", body, at)
    return int(high) << 32 | int(low)


def _read_number_set(order: str, body: memoryview, at: int) -> tuple[int, tuple[int, ...], int]:
    base = _read_number(order, body, at)
    (bits,) = struct.unpack_from(f"{order}I", body, at + 8)
    numbers, end = _read_bits(order, body, at + 12, base, bits)
    return base, numbers, end


def _read_bits(
    order: str, body: memoryview, at: int, base: int, bits: int
) -> tuple[tuple[int, ...], int]:
    if bits > _MOST_BITS:
        raise MalformedError("a sequence number set is too large")
    count = (bits + 31) // 32
    words = struct.unpack_from(f"{order}{count}I", body, at)
    numbers = tuple(
        base + offset for offset in range(bits) if words[offset // 32] >> (31 - offset % 32) & 1
    )
    return numbers, at + 4 * count
