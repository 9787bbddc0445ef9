"""Writing MCAP files."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from cartwheel.bridges.recording.encoding import codec
from cartwheel.bridges.recording.formats import Encoding
from cartwheel.bridges.recording.mcap_format import (
    MAGIC,
    MESSAGE,
    RECORD,
    Op,
    blob,
    mapping,
    record,
    text,
)
from cartwheel.bridges.recording.qos import qos_text
from cartwheel.bridges.recording.sink import Sink

CHUNK = 1 << 20
"""Maximum uncompressed size of a chunk in bytes. A larger message has its own chunk."""
_INDEXES = (Op.ATTACHMENT_INDEX, Op.METADATA_INDEX, Op.CHUNK_INDEX)
_HEAD = struct.Struct(f"{RECORD.format}{MESSAGE.format.removeprefix('<')}")
_head, _MESSAGE, _FIELDS = _HEAD.pack, int(Op.MESSAGE), MESSAGE.size
_NEVER = 1 << 64
_LEVEL = 1
"""Compression level of zstd. Simulated images compress well at any level."""


@dataclass(slots=True)
class _Channel:
    number: int
    schema: bytes
    record: bytes
    count: int = 0
    is_stated: bool = False
    """Whether its record is in the file or in the current chunk."""
    index: list[int] = field(default_factory=list)
    """Time and offset of each message in the current chunk, one after the other."""


@dataclass(frozen=True, slots=True)
class _Written:
    """A chunk in the file, and the state before it."""

    begin: int
    """Offset of the chunk."""
    counts: list[int]
    """Number of messages per channel before the chunk."""
    indexes: int
    """Number of index records before the chunk."""
    span: tuple[int, int] | None
    """Times of the first and last message before the chunk."""


class McapWriter:
    """Writes an MCAP file in compressed chunks. Each chunk on disk is complete.

    Readers that support MCAP streams can read a truncated file up to its last chunk.
    ``mcap recover`` repairs it.

    Args:
        path: File to create.
        encoding: Encoding of the messages.
        notes: Stored as the metadata record ``cartwheel``.

    Raises:
        OSError: The file cannot be written.
    """

    def __init__(self, path: Path, encoding: Encoding, *, notes: Mapping[str, str]) -> None:
        self.kept_ns = 0
        self._codec = codec(encoding)
        self._profile = encoding
        self._channels: list[_Channel] = []
        self._schemas: dict[str, tuple[int, bytes]] = {}
        self._chunk: list[bytes] = []
        """Records of the current chunk, as separate parts, so that images are copied only once."""
        self._size = 0
        """Size of `_chunk` in bytes."""
        self._first, self._last = _NEVER, -1
        """Times of the first and last message in the current chunk, in ns."""
        self.span: tuple[int, int] | None = None
        """Times of the first and last message in the file in ns; None if it has no messages."""
        self._indexes: list[bytes] = []
        """Index records of chunks, attachments and metadata, for the end of the file."""
        self._written: list[_Written] = []
        """Chunks in the file."""
        from cartwheel.bridges.recording.compression import prepare

        # Import it before the simulation starts, instead of at the first flush.
        prepare()
        self._sink = Sink(path)
        self._sink.write(MAGIC + record(Op.HEADER, text(encoding), text("cartwheel")))
        if notes:
            self._note("cartwheel", notes)

    def add(self, topic: str, type_name: str, *, latched: bool) -> int:
        schema = self._codec.schema(type_name)
        known = self._schemas.get(schema.name)
        if known is None:
            number = len(self._schemas) + 1
            parts = (text(schema.name), text(self._codec.schemas), blob(schema.text.encode()))
            known = (number, record(Op.SCHEMA, struct.pack("<H", number), *parts))
            self._schemas[schema.name] = known
        if self._profile == "ros2":
            about = {"offered_qos_profiles": qos_text(latched=latched)}
            if schema.hash:
                about["topic_type_hash"] = schema.hash
        else:
            about = {"md5sum": schema.hash, "latching": str(int(latched)), "topic": topic}
        number = len(self._channels) + 1
        made = record(
            Op.CHANNEL,
            struct.pack("<HH", number, known[0]),
            text(topic),
            text(self._codec.messages),
            mapping(about),
        )
        self._channels.append(_Channel(number, known[1], made))
        return number - 1

    def write(self, channels: Sequence[int], times: Sequence[int], data: Sequence[bytes]) -> None:
        # The loop runs for each message, so it uses local names and avoids calls.
        known, chunk, end, place = self._channels, self._chunk, self._size, _HEAD.size
        for number, time_ns, each in zip(channels, times, data, strict=True):
            into, size = known[number], len(each)
            if end + size > CHUNK and chunk:
                self._size = end
                self.flush()
                chunk, end = self._chunk, 0
            if not into.is_stated:
                into.is_stated = True
                chunk += (into.schema, into.record)
                end += len(into.schema) + len(into.record)
            into.count = count = into.count + 1
            into.index += (time_ns, end)
            head = _head(
                _MESSAGE, _FIELDS + size, into.number, count & 0xFFFFFFFF, time_ns, time_ns
            )
            chunk += (head, each)
            end += place + size
            # Comparisons take a quarter of the time of `min` and `max`.
            if time_ns < self._first:  # noqa: PLR1730
                self._first = time_ns
            if time_ns > self._last:  # noqa: PLR1730
                self._last = time_ns
        self._size = end

    def attach(self, name: str, media_type: str, data: bytes, time_ns: int) -> None:
        times = struct.pack("<QQ", time_ns, time_ns)
        body = times + text(name) + text(media_type) + struct.pack("<Q", len(data)) + data
        made = record(Op.ATTACHMENT, body, struct.pack("<I", zlib.crc32(body)))
        begin = self._sink.position
        self._sink.write(made)
        self._index(
            Op.ATTACHMENT_INDEX,
            struct.pack("<QQ", begin, len(made)),
            times,
            struct.pack("<Q", len(data)),
            text(name),
            text(media_type),
        )

    def flush(self) -> None:
        if not self._chunk:
            return
        from cartwheel.bridges.recording.compression import compress

        first, last = self._first, self._last
        whole = b"".join(self._chunk)
        packed = compress(whole, level=_LEVEL)
        chunk = record(
            Op.CHUNK,
            struct.pack("<QQQI", first, last, len(whole), zlib.crc32(whole)),
            text("zstd"),
            struct.pack("<Q", len(packed)),
            packed,
        )
        begin = self._sink.position
        counts = [each.count - len(each.index) // 2 for each in self._channels]
        before = _Written(begin, counts, len(self._indexes), self.span)
        offsets, indexes = [], bytearray()
        for channel in self._channels:
            if channel.index:
                place = begin + len(chunk) + len(indexes)
                offsets.append(struct.pack("<HQ", channel.number, place))
                entries = struct.pack(f"<{len(channel.index)}Q", *channel.index)
                indexes += record(
                    Op.MESSAGE_INDEX, struct.pack("<H", channel.number), blob(entries)
                )
        self._sink.write(chunk + indexes)
        self._index(
            Op.CHUNK_INDEX,
            struct.pack("<QQQQ", first, last, begin, len(chunk)),
            blob(b"".join(offsets)),
            struct.pack("<Q", len(indexes)),
            text("zstd"),
            struct.pack("<QQ", len(packed), len(whole)),
        )
        begun, ended = self.span or (first, last)
        self.span = (min(begun, first), max(ended, last))
        self.kept_ns = self.span[1]
        self._written.append(before)
        self._forget_chunk()

    def close(self) -> None:
        self.flush()
        self._sink.write(record(Op.DATA_END, struct.pack("<I", 0)))
        begin = self._sink.position
        summary, offsets = bytearray(), bytearray()
        stated = [channel for channel in self._channels if channel.is_stated]
        groups = (
            (Op.SCHEMA, list(dict.fromkeys(channel.schema for channel in stated))),
            (Op.CHANNEL, [channel.record for channel in stated]),
            (Op.STATISTICS, [self._statistics(stated)]),
            *((op, self._indexes_of(op)) for op in _INDEXES),
        )
        for op, records in groups:
            if records:
                place = struct.pack("<BQQ", op, begin + len(summary), sum(map(len, records)))
                offsets += record(Op.SUMMARY_OFFSET, place)
                summary += b"".join(records)
        foot = struct.pack("<QQ", begin, begin + len(summary))
        head = RECORD.pack(Op.FOOTER, len(foot) + 4)
        crc = zlib.crc32(bytes(summary + offsets) + head + foot)
        self._sink.write(summary + offsets + head + foot + struct.pack("<I", crc) + MAGIC)
        self._sink.close()

    @property
    def counts(self) -> list[int]:
        """Number of messages per channel."""
        return [channel.count for channel in self._channels]

    def abandon(self) -> None:
        for channel in self._channels:
            channel.count -= len(channel.index) // 2
        self._forget_chunk()
        self._sink.salvage(self.close, self._give_back)

    def _give_back(self) -> bool:
        """Removes the last chunk, and everything after it, from the file."""
        if not self._written:
            return False
        last = self._written.pop()
        self._sink.cut(last.begin)
        del self._indexes[last.indexes :]
        # Channels that were added later are empty, because their messages are already removed.
        for channel, count in zip(self._channels, last.counts, strict=False):
            channel.count = count
        self.span = last.span
        self.kept_ns = self.span[1] if self.span else 0
        return True

    def _forget_chunk(self) -> None:
        for channel in self._channels:
            channel.index.clear()
        self._chunk = []
        self._size = 0
        self._first, self._last = _NEVER, -1

    def _note(self, name: str, values: Mapping[str, str]) -> None:
        made = record(Op.METADATA, text(name), mapping(values))
        begin = self._sink.position
        self._sink.write(made)
        self._index(Op.METADATA_INDEX, struct.pack("<QQ", begin, len(made)), text(name))

    def _index(self, op: Op, *parts: bytes) -> None:
        self._indexes.append(record(op, *parts))

    def _indexes_of(self, op: Op) -> list[bytes]:
        return [one for one in self._indexes if one[0] == op]

    def _statistics(self, stated: list[_Channel]) -> bytes:
        counts = b"".join(struct.pack("<HQ", one.number, one.count) for one in stated)
        first, last = self.span or (0, 0)
        schemas = len({channel.schema for channel in stated})
        return record(
            Op.STATISTICS,
            struct.pack(
                "<QHIIIIQQ",
                sum(channel.count for channel in stated),
                schemas,
                len(stated),
                *(len(self._indexes_of(op)) for op in _INDEXES),
                first,
                last,
            ),
            blob(counts),
        )
