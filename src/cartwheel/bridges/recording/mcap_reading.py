"""Reading MCAP files, even truncated ones."""

from __future__ import annotations

import struct
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from cartwheel.bridges.recording.compression import decompress
from cartwheel.bridges.recording.formats import path_error
from cartwheel.bridges.recording.mcap_format import MAGIC, MESSAGE, RECORD, Op
from cartwheel.bridges.recording.reading import (
    Block,
    BlockRecording,
    Bytes,
    Index,
    Recorded,
    RecordedTopic,
    is_latched,
)
from cartwheel.codes.recording import RECORDING_VERSION_UNKNOWN
from cartwheel.messages import type_name

_LOOSE = 1 << 20
"""Size of a block in bytes, for messages outside of chunks."""


@dataclass(frozen=True, slots=True)
class _Schema:
    name: str
    encoding: str
    text: str


@dataclass(kw_only=True)
class McapRecording(BlockRecording):
    """An MCAP file."""

    schemas: dict[int, _Schema] = field(default_factory=dict)

    def scan(self, file: BinaryIO) -> list[tuple[Block, Index]]:
        found: list[tuple[Block, Index]] = []
        loose: Block | None = None
        while len(head := file.read(RECORD.size)) == RECORD.size:
            op, length = RECORD.unpack(head)
            begin = file.tell() - RECORD.size
            end = file.tell() + length
            if end > self.size:
                break
            if op == Op.CHUNK:
                span = struct.unpack("<QQ", file.read(16))
                found.append((Block(begin, end, *span), defaultdict(list)))
            elif op == Op.MESSAGE_INDEX and found:
                body = Bytes(file.read(length))
                times = found[-1][1][body.number(2)]
                entries = body.take(body.number(4) // 16 * 16)
                times += [time_ns for time_ns, _ in struct.iter_unpack("<QQ", entries)]
            elif op == Op.MESSAGE:
                channel, _, time_ns, _ = MESSAGE.unpack(file.read(MESSAGE.size))
                number = self._number(channel)
                self.topics[number].see([time_ns])
                if loose is None or loose.end != begin or end - loose.position > _LOOSE:
                    loose = Block(begin, end, time_ns, time_ns)
                    self.blocks.append(loose)
                loose.end = end
                loose.first_ns = min(loose.first_ns, time_ns)
                loose.last_ns = max(loose.last_ns, time_ns)
                loose.topics |= {number}
            elif op in (Op.SCHEMA, Op.CHANNEL):
                self._learn(op, file.read(length))
            elif op == Op.ATTACHMENT:
                body = Bytes(file.read(min(length, 1 << 16)), 16)
                name, _ = body.text(), body.text()
                self.attachments[name] = body.number(8)
            elif op == Op.METADATA:
                body = Bytes(file.read(length))
                if body.text() == "cartwheel":
                    self.notes = body.mapping()
            elif op == Op.FOOTER:
                file.seek(end)
                self.complete = file.read(len(MAGIC)) == MAGIC
                break
            file.seek(end)
        return found

    def load(self, data: bytes) -> list[Recorded]:
        if data[:1] == bytes([Op.CHUNK]):
            body = Bytes(data, RECORD.size + 28)
            kind = body.text()
            data = decompress(body.take(body.number(8)), kind)
        records = Bytes(data)
        found = []
        while records:
            op, length = RECORD.unpack(records.take(RECORD.size))
            data = records.take(length)
            if op == Op.MESSAGE:
                channel, _, time_ns, _ = MESSAGE.unpack_from(data)
                found.append(Recorded(time_ns, self._number(channel), data[MESSAGE.size :]))
            else:
                self._learn(op, data)
        return found

    def _number(self, channel: int) -> int:
        if channel not in self.numbers:
            raise ValueError(f"a message refers to the unknown channel {channel}")
        return self.numbers[channel]

    def _learn(self, op: int, data: bytes) -> None:
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
    with path.open("rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            why = f'"{path}" has an unsupported MCAP version'
            raise path_error(RECORDING_VERSION_UNKNOWN, path, why)
        recording.survey(file)
    return recording
