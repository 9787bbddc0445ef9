"""Reading ROS 1 bags, even without an index. Source: wiki.ros.org/Bags/Format/2.0."""

from __future__ import annotations

import struct
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from cartwheel.bridges.recording.bag_writing import (
    BAG_HEADER,
    CHUNK_OP,
    CONNECTION,
    INDEX,
    MAGIC,
    MESSAGE,
)
from cartwheel.bridges.recording.compression import decompress
from cartwheel.bridges.recording.reading import (
    Block,
    BlockRecording,
    Bytes,
    Recorded,
    RecordedTopic,
)
from cartwheel.codes.recording import RECORDING_DAMAGED, RECORDING_VERSION_UNKNOWN
from cartwheel.errors import RecordingError
from cartwheel.messages import type_name

Fields = dict[str, bytes]


@dataclass
class BagRecording(BlockRecording):
    """A ROS 1 bag."""

    numbers: dict[int, int] = field(default_factory=dict)
    """Index in `topics`, by connection."""

    def load(self, block: Block) -> list[Recorded]:
        try:
            return self._load(block)
        except (KeyError, struct.error) as error:
            raise ValueError(f"a record of the bag file is incomplete: {error}") from error

    def _load(self, block: Block) -> list[Recorded]:
        with self.path.open("rb") as file:
            file.seek(block.position)
            source = Bytes(file.read(block.end - block.position))
        head = fields(source.take(source.number(4)))
        kind = head.get("compression", b"none").decode(errors="replace")
        records = Bytes(decompress(source.take(source.number(4)), kind))
        found = []
        while records:
            head = fields(records.take(records.number(4)))
            data = records.take(records.number(4))
            op = op_of(head)
            if op == CONNECTION:
                self.learn(head, data)
            elif op == MESSAGE:
                connection = _u32(head, "conn")
                if connection not in self.numbers:
                    raise ValueError(f"a message refers to the unknown connection {connection}")
                found.append(Recorded(_time(head["time"]), self.numbers[connection], data))
        return found

    def learn(self, head: Fields, data: bytes) -> None:
        """Adds a connection."""
        connection = _u32(head, "conn")
        if connection in self.numbers:
            return
        about = {key: value.decode(errors="replace") for key, value in fields(data).items()}
        self.numbers[connection] = len(self.topics)
        self.topics.append(
            RecordedTopic(
                name=head.get("topic", b"").decode(errors="replace"),
                type=type_name(about.get("type", "")),
                encoding="ros1",
                schema="ros1msg",
                definition=about.get("message_definition", ""),
                latched=about.get("latching") == "1",
                md5=about.get("md5sum", ""),
            )
        )


def open_bag(path: Path) -> BagRecording:
    """Finds the chunks of a bag and the topics and times in each chunk.

    Raises:
        RecordingError: The bag is damaged, or its version is older than 2.0.
    """
    recording = BagRecording(path=path, form="ROS 1 bag", size=path.stat().st_size)
    with path.open("rb") as file:
        magic = file.readline(32)
        if magic != MAGIC:
            version = magic.decode(errors="replace").strip()
            raise RecordingError(
                f'"{path}" has the unsupported bag version {version}',
                code=RECORDING_VERSION_UNKNOWN,
                hint="Convert the bag to version 2.0 with rosbag fix.",
                values={"path": str(path), "version": version},
            )
        try:
            unclear = _scan(file, recording)
            if unclear and not recording.complete:
                # Its index may be truncated.
                unclear[-1] = (unclear[-1][0], {})
            for block, times in unclear:
                _clear_up(recording, block, times)
        except (ValueError, KeyError, struct.error) as error:
            raise RecordingError(
                f'"{path}" is damaged near byte {file.tell()}: {error}',
                code=RECORDING_DAMAGED,
                values={"path": str(path), "byte": file.tell()},
            ) from error
    # A bag has one connection per publisher of a topic.
    return recording


def _clear_up(recording: BagRecording, block: Block, times: dict[int, list[int]]) -> None:
    """Counts the messages in a chunk. Loads the chunk if it has no index or new connections."""
    if not times or not set(times) <= set(recording.numbers):
        messages = recording.load(block)
        seen = defaultdict(list)
        for message in messages:
            seen[message.number].append(message.time_ns)
    else:
        seen = defaultdict(list, {recording.numbers[c]: found for c, found in times.items()})
    for number, found in seen.items():
        recording.topics[number].see(found)
    every = [time_ns for found in seen.values() for time_ns in found]
    if every:
        block.topics = frozenset(seen)
        block.first_ns, block.last_ns = min(every), max(every)
        recording.blocks.append(block)


def _scan(file: BinaryIO, recording: BagRecording) -> list[tuple[Block, dict[int, list[int]]]]:
    found: list[tuple[Block, dict[int, list[int]]]] = []
    while True:
        begin = file.tell()
        head_size = file.read(4)
        if len(head_size) < 4:
            return found
        size = struct.unpack("<I", head_size)[0]
        if begin + 8 + size > recording.size:
            return found
        head = fields(file.read(size))
        data_size = struct.unpack("<I", file.read(4))[0]
        end = file.tell() + data_size
        if end > recording.size:
            return found
        op = op_of(head)
        if op == BAG_HEADER:
            recording.complete = struct.unpack("<Q", head["index_pos"])[0] > 0
        elif op == CHUNK_OP:
            found.append((Block(begin, end, 0, 0, frozenset()), defaultdict(list)))
        elif op == INDEX and found:
            entries = file.read(data_size)
            times = found[-1][1][_u32(head, "conn")]
            times += [_time(entries[i : i + 8]) for i in range(0, len(entries), 12)]
        elif op == CONNECTION:
            recording.learn(head, file.read(data_size))
        file.seek(end)


def fields(data: bytes) -> Fields:
    """Header fields at the start of a record.

    Raises:
        ValueError: The data is not a valid header.
    """
    source = Bytes(data)
    found = {}
    while source:
        name, mark, value = source.take(source.number(4)).partition(b"=")
        if not mark:
            raise ValueError('a header field of a bag record contains no "="')
        found[name.decode(errors="replace")] = value
    return found


def op_of(head: Fields) -> int:
    """Type of a record."""
    return head.get("op", b"\0")[0]


def _u32(head: Fields, name: str) -> int:
    return int(struct.unpack("<I", head[name])[0])


def _time(data: bytes) -> int:
    seconds, nanoseconds = struct.unpack("<II", data)
    return int(seconds) * 1_000_000_000 + int(nanoseconds)
