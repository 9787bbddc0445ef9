"""Reading MCAP files, even truncated ones."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from cartwheel.bridges.recording.compression import decompress
from cartwheel.bridges.recording.mcap_format import MAGIC, MESSAGE, RECORD, Op
from cartwheel.bridges.recording.reading import (
    Block,
    BlockRecording,
    Bytes,
    Recorded,
    RecordedTopic,
    is_latched,
)
from cartwheel.codes.recording import RECORDING_DAMAGED, RECORDING_VERSION_UNKNOWN
from cartwheel.errors import RecordingError
from cartwheel.messages import type_name

_LOOSE = 1 << 20
"""Size of a block in bytes, for messages outside of chunks."""


@dataclass(frozen=True, slots=True)
class _Schema:
    name: str
    encoding: str
    text: str


@dataclass
class _Scan:
    """State of a scan of the file."""

    recording: McapRecording
    times: dict[int, list[int]] = field(default_factory=lambda: defaultdict(list))
    """Message times in the current chunk, by channel."""
    unclear: list[tuple[Block, set[int]]] = field(default_factory=list)
    """Chunks that must be loaded, and the channels in their indexes."""


@dataclass
class McapRecording(BlockRecording):
    """An MCAP file."""

    schemas: dict[int, _Schema] = field(default_factory=dict)
    numbers: dict[int, int] = field(default_factory=dict)
    """Index in `topics`, by channel."""

    def load(self, block: Block) -> list[Recorded]:
        with self.path.open("rb") as file:
            file.seek(block.position)
            data = file.read(block.end - block.position)
        if block.about == "loose":
            return self.read(Bytes(data))
        body = Bytes(data, RECORD.size)
        body.take(28)
        kind = body.text()
        return self.read(Bytes(decompress(body.take(body.number(8)), kind)))

    def read(self, records: Bytes) -> list[Recorded]:
        """Returns the messages in records, and stores their schemas and channels."""
        found = []
        while records:
            op, length = RECORD.unpack(records.take(RECORD.size))
            data = records.take(length)
            if op == Op.MESSAGE:
                if length < MESSAGE.size:
                    raise ValueError("an MCAP message record is shorter than its header")
                channel, _, time_ns, _ = MESSAGE.unpack_from(data)
                if channel not in self.numbers:
                    raise ValueError(f"a message refers to the unknown channel {channel}")
                found.append(Recorded(time_ns, self.numbers[channel], data[MESSAGE.size :]))
            else:
                self.learn(op, data)
        return found

    def learn(self, op: int, data: bytes) -> None:
        """Stores a schema or channel."""
        body = Bytes(data)
        if op == Op.SCHEMA:
            number, name, encoding = body.number(2), body.text(), body.text()
            self.schemas[number] = _Schema(name, encoding, body.text())
        elif op == Op.CHANNEL:
            channel, schema = body.number(2), self.schemas.get(body.number(2))
            topic, encoding, about = body.text(), body.text(), body.mapping()
            if channel in self.numbers:
                return
            self.numbers[channel] = len(self.topics)
            known = schema or _Schema("", "", "")
            ros = encoding in ("cdr", "ros1")
            self.topics.append(
                RecordedTopic(
                    name=topic,
                    type=type_name(known.name) if ros and known.name else known.name,
                    encoding=encoding,
                    schema=known.encoding,
                    definition=known.text,
                    latched=about.get("latching") == "1"
                    or is_latched(about.get("offered_qos_profiles", "")),
                    md5=about.get("md5sum", ""),
                )
            )


def open_mcap(path: Path) -> McapRecording:
    """Finds the chunks of a file and the topics and times in each chunk.

    Raises:
        RecordingError: The file is damaged.
    """
    recording = McapRecording(path=path, form="MCAP", size=path.stat().st_size)
    scan = _Scan(recording)
    with path.open("rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            raise RecordingError(
                f'"{path}" has an unsupported MCAP version',
                code=RECORDING_VERSION_UNKNOWN,
                values={"path": str(path)},
            )
        try:
            _scan(file, scan)
        except ValueError as error:
            raise RecordingError(
                f'"{path}" is damaged near byte {file.tell()}: {error}',
                code=RECORDING_DAMAGED,
                values={"path": str(path), "byte": file.tell()},
            ) from error
    if scan.unclear and not recording.complete:
        # Its index may be truncated.
        block, _ = scan.unclear[-1]
        scan.unclear[-1] = (block, set())
    for block, channels in scan.unclear:
        _clear_up(recording, block, channels)
    return recording


def _clear_up(recording: McapRecording, block: Block, channels: set[int]) -> None:
    """Loads a chunk that has no index, or that alone contains the records of its channels."""
    messages = [] if channels and channels <= set(recording.numbers) else recording.loaded(block)
    if channels:
        block.topics = frozenset(recording.numbers[c] for c in channels if c in recording.numbers)
        for channel, times in block.about.items():
            if channel in recording.numbers:
                recording.topics[recording.numbers[channel]].see(times)
    else:
        block.topics = frozenset(message.number for message in messages)
        by_topic = defaultdict(list)
        for message in messages:
            by_topic[message.number].append(message.time_ns)
        for number, seen in by_topic.items():
            recording.topics[number].see(seen)
    block.about = None


def _scan(file: BinaryIO, scan: _Scan) -> None:
    recording = scan.recording
    chunk: Block | None = None
    loose: Block | None = None
    while True:
        begin = file.tell()
        head = file.read(RECORD.size)
        if len(head) < RECORD.size:
            break
        op, length = RECORD.unpack(head)
        end = begin + RECORD.size + length
        if end > recording.size:
            break
        if op != Op.MESSAGE_INDEX and chunk is not None:
            _finish(scan, chunk)
            chunk = None
        if op == Op.CHUNK:
            body = Bytes(file.read(28))
            first, last = body.number(8), body.number(8)
            chunk = Block(begin, end, first, last, frozenset())
            file.seek(end)
        elif op == Op.MESSAGE_INDEX and chunk is not None:
            body = Bytes(file.read(length))
            channel, size = body.number(2), body.number(4)
            for _ in range(size // 16):
                scan.times[channel].append(body.number(8))
                body.number(8)
        elif op == Op.MESSAGE:
            channel, _, time_ns, _ = MESSAGE.unpack(file.read(MESSAGE.size))
            number = recording.numbers.get(channel)
            if number is None:
                raise ValueError(f"a message refers to the unknown channel {channel}")
            recording.topics[number].see([time_ns])
            if loose is None or loose.end != begin or end - loose.position > _LOOSE:
                loose = Block(begin, end, time_ns, time_ns, frozenset([number]), "loose")
                recording.blocks.append(loose)
            loose.end = end
            loose.first_ns = min(loose.first_ns, time_ns)
            loose.last_ns = max(loose.last_ns, time_ns)
            loose.topics |= {number}
            file.seek(end)
        elif op in (Op.SCHEMA, Op.CHANNEL):
            recording.learn(op, file.read(length))
        elif op == Op.ATTACHMENT:
            body = Bytes(file.read(min(length, 1 << 16)), 16)
            name, _ = body.text(), body.text()
            recording.attachments[name] = body.number(8)
            file.seek(end)
        elif op == Op.METADATA:
            body = Bytes(file.read(length))
            if body.text() == "cartwheel":
                recording.notes = body.mapping()
        elif op == Op.FOOTER:
            file.seek(end)
            recording.complete = file.read(len(MAGIC)) == MAGIC
            return
        else:
            file.seek(end)
    if chunk is not None:
        _finish(scan, chunk)


def _finish(scan: _Scan, chunk: Block) -> None:
    chunk.about = dict(scan.times)
    scan.times.clear()
    scan.recording.blocks.append(chunk)
    scan.unclear.append((chunk, set(chunk.about)))
