"""Writing ROS 1 bags, version 2.0. Source: wiki.ros.org/Bags/Format/2.0."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from cartwheel.bridges.recording.encoding import Schema, codec
from cartwheel.bridges.recording.sink import Sink

MAGIC = b"#ROSBAG V2.0\n"
CHUNK = 768 << 10
"""Maximum size of a chunk in bytes. A larger message has its own chunk."""
_HEADER_SIZE = 4096
"""Size in bytes of the first record without its two lengths, as written by ROS tools."""
_NEVER = 1 << 64
_EARLIEST = 1
"""Earliest timestamp in ns, because rosbag does not play messages before ROS 1's first time."""

BAG_HEADER, CHUNK_OP, CONNECTION, MESSAGE, INDEX, CHUNK_INFO = 3, 5, 7, 2, 4, 6


@dataclass(slots=True)
class _Connection:
    number: int
    topic: str
    latched: bool
    schema: Schema
    count: int = 0
    index: list[tuple[bytes, int]] = field(default_factory=list)
    """Time and offset of each message in the current chunk."""
    head: bytes = field(init=False)
    """The beginning of the record of each message, up to its time."""

    def __post_init__(self) -> None:
        fields = {"op": bytes([MESSAGE]), "conn": _u32(self.number), "time": bytes(8)}
        whole = header(fields)
        self.head = _u32(len(whole)) + whole[:-8]

    @property
    def record(self) -> bytes:
        about = {
            "topic": self.topic,
            "type": self.schema.name,
            "md5sum": self.schema.hash,
            "message_definition": self.schema.text,
            "callerid": "/cartwheel",
            "latching": str(int(self.latched)),
        }
        data = header({key: value.encode() for key, value in about.items()})
        head = {"op": bytes([CONNECTION]), "conn": _u32(self.number), "topic": self.topic.encode()}
        return record(head, data)


class BagWriter:
    """Writes a bag in uncompressed chunks, which all ROS 1 releases can read.

    A truncated bag has no index. ``rosbag reindex`` restores it.

    Args:
        path: File to create.

    Raises:
        OSError: The file cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self.kept_ns = 0
        self._codec = codec("ros1")
        self._connections: list[_Connection] = []
        self._stated: set[int] = set()
        self._chunk = bytearray()
        self._span: tuple[int, int] | None = None
        self._infos: list[bytes] = []
        self._written: list[tuple[int, int]] = []
        """Start of each chunk in the file, and `kept_ns` before it."""
        self._sink = Sink(path)
        self._sink.write(MAGIC + self._bag_header(0))

    def add(self, topic: str, type_name: str, *, latched: bool) -> int:
        schema = self._codec.schema(type_name)
        number = len(self._connections)
        self._connections.append(_Connection(number, topic, latched, schema))
        return number

    def write(self, channels: Sequence[int], times: Sequence[int], data: Sequence[bytes]) -> None:
        # The loop runs for each message, so it uses local names and avoids calls.
        known, stated, chunk = self._connections, self._stated, self._chunk
        first, last = self._span or (_NEVER, -1)
        for number, given_ns, each in zip(channels, times, data, strict=True):
            into, size = known[number], len(each)
            if chunk and len(chunk) + size > CHUNK:
                self._span = (first, last)
                self.flush()
                chunk, first, last = self._chunk, _NEVER, -1
            if number not in stated:
                stated.add(number)
                chunk += into.record
            time_ns = max(given_ns, _EARLIEST)
            time = _pack_time(*divmod(time_ns, 1_000_000_000))
            into.count += 1
            into.index.append((time, len(chunk)))
            chunk += b"%b%b%b%b" % (into.head, time, _pack_size(size), each)
            # Comparisons take a quarter of the time of `min` and `max`.
            if time_ns < first:  # noqa: PLR1730
                first = time_ns
            if time_ns > last:  # noqa: PLR1730
                last = time_ns
        if last >= 0:
            self._span = (first, last)

    def attach(self, name: str, media_type: str, data: bytes, time_ns: int) -> None:
        """Does nothing, because bags cannot contain attachments."""

    def flush(self) -> None:
        if self._span is None:
            return
        begin = self._sink.position
        size = _u32(len(self._chunk))
        head = {"op": bytes([CHUNK_OP]), "compression": b"none", "size": size}
        made = bytearray(record(head, bytes(self._chunk)))
        counts = bytearray()
        filled = [each for each in self._connections if each.index]
        for each in filled:
            entries = b"".join(time + _u32(place) for time, place in each.index)
            head = {
                "op": bytes([INDEX]),
                "ver": _u32(1),
                "conn": _u32(each.number),
                "count": _u32(len(each.index)),
            }
            made += record(head, entries)
            counts += _u32(each.number) + _u32(len(each.index))
        self._sink.write(made)
        first, last = self._span
        head = {
            "op": bytes([CHUNK_INFO]),
            "ver": _u32(1),
            "chunk_pos": struct.pack("<Q", begin),
            "start_time": _time(first),
            "end_time": _time(last),
            "count": _u32(len(filled)),
        }
        self._infos.append(record(head, bytes(counts)))
        self._written.append((begin, self.kept_ns))
        self.kept_ns = last
        self._forget_chunk()

    def close(self) -> None:
        self.flush()
        begin = self._sink.position
        stated = [each.record for each in self._connections if each.number in self._stated]
        self._sink.write(b"".join([*stated, *self._infos]))
        self._sink.rewrite(len(MAGIC), self._bag_header(begin))
        self._sink.close()

    def abandon(self) -> None:
        self._forget_chunk()
        self._sink.salvage(self.close, self._give_back)

    def _give_back(self) -> bool:
        """Removes the last chunk from the file."""
        if not self._written:
            return False
        begin, self.kept_ns = self._written.pop()
        self._sink.cut(begin)
        self._infos.pop()
        return True

    def _forget_chunk(self) -> None:
        for each in self._connections:
            each.index.clear()
        self._chunk = bytearray()
        self._span = None

    def _bag_header(self, index: int) -> bytes:
        head = header(
            {
                "op": bytes([BAG_HEADER]),
                "index_pos": struct.pack("<Q", index),
                "conn_count": _u32(len(self._stated)),
                "chunk_count": _u32(len(self._infos)),
            }
        )
        padding = b" " * (_HEADER_SIZE - len(head))
        return _u32(len(head)) + head + _u32(len(padding)) + padding


def header(fields: dict[str, bytes]) -> bytes:
    """Encodes the header fields of a record."""
    return b"".join(
        _u32(len(name) + 1 + len(value)) + name.encode() + b"=" + value
        for name, value in fields.items()
    )


def record(fields: dict[str, bytes], data: bytes) -> bytes:
    """Encodes a complete record."""
    head = header(fields)
    return b"".join((_u32(len(head)), head, _u32(len(data)), data))


_pack_size, _pack_time = struct.Struct("<I").pack, struct.Struct("<II").pack


def _u32(value: int) -> bytes:
    return _pack_size(value)


def _time(time_ns: int) -> bytes:
    return _pack_time(*divmod(time_ns, 1_000_000_000))
