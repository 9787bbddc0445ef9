"""Reading ROS 1 bags, even without an index. Source: wiki.ros.org/Bags/Format/2.0."""

from __future__ import annotations

import struct
from collections import defaultdict
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
from cartwheel.bridges.recording.formats import path_error
from cartwheel.bridges.recording.reading import (
    Block,
    BlockRecording,
    Bytes,
    Index,
    Recorded,
    RecordedTopic,
)
from cartwheel.codes.recording import RECORDING_VERSION_UNKNOWN
from cartwheel.messages import type_name

_SECOND = 1_000_000_000


class BagRecording(BlockRecording):
    """A ROS 1 bag."""

    def scan(self, file: BinaryIO) -> list[tuple[Block, Index]]:
        found: list[tuple[Block, Index]] = []
        while len(head_size := file.read(4)) == 4:
            begin = file.tell() - 4
            size = int.from_bytes(head_size, "little")
            if begin + 8 + size > self.size:
                break
            head = _Header(file.read(size))
            data_size = int.from_bytes(file.read(4), "little")
            end = file.tell() + data_size
            if end > self.size:
                break
            if head.op == BAG_HEADER:
                self.complete = head.numbers("index_pos", "<Q")[0] > 0
            elif head.op == CHUNK_OP:
                found.append((Block(begin, end), defaultdict(list)))
            elif head.op == INDEX and found:
                times = found[-1][1][head.connection]
                entries = struct.iter_unpack("<III", file.read(data_size))
                times += [seconds * _SECOND + rest for seconds, rest, _ in entries]
            elif head.op == CONNECTION:
                self._learn(head, file.read(data_size))
            file.seek(end)
        return found

    def load(self, data: bytes) -> list[Recorded]:
        source = Bytes(data)
        head = _Header(source.take(source.number(4)))
        records = Bytes(decompress(source.take(source.number(4)), head.text("compression", "none")))
        found = []
        while records:
            head = _Header(records.take(records.number(4)))
            data = records.take(records.number(4))
            if head.op == CONNECTION:
                self._learn(head, data)
            elif head.op == MESSAGE:
                if head.connection not in self.numbers:
                    raise ValueError(
                        f"a message refers to the unknown connection {head.connection}"
                    )
                seconds, rest = head.numbers("time", "<II")
                number = self.numbers[head.connection]
                found.append(Recorded(seconds * _SECOND + rest, number, data))
        return found

    def _learn(self, head: _Header, data: bytes) -> None:
        """Adds a connection. A topic has one connection per publisher."""
        if head.connection in self.numbers:
            return
        about = _Header(data)
        self.numbers[head.connection] = len(self.topics)
        self.topics.append(
            RecordedTopic(
                name=head.text("topic"),
                type=type_name(about.text("type")),
                encoding="ros1",
                schema="ros1msg",
                definition=about.text("message_definition"),
                latched=about.text("latching") == "1",
                md5=about.text("md5sum"),
            )
        )


class _Header(dict[bytes, bytes]):
    """Fields at the start of a record.

    Raises:
        ValueError: The data is not a valid header.
    """

    def __init__(self, data: bytes) -> None:
        at = 0
        while at < len(data):
            begin = at + 4
            at = begin + int.from_bytes(data[at:begin], "little")
            name, mark, value = data[begin:at].partition(b"=")
            if at > len(data):
                raise ValueError("the data is truncated")
            if not mark:
                raise ValueError('a header field of a bag record contains no "="')
            self[name] = value
        self.op = int.from_bytes(self.get(b"op", b"")[:1], "little")

    @property
    def connection(self) -> int:
        """Number of the connection."""
        return int(self.numbers("conn", "<I")[0])

    def numbers(self, name: str, form: str) -> tuple[int, ...]:
        """Numbers in a field, in a format of `struct`."""
        if name.encode() not in self:
            raise ValueError(f'a bag record has no field "{name}"')
        return struct.unpack(form, self[name.encode()])

    def text(self, name: str, default: str = "") -> str:
        """Text of a field."""
        return self.get(name.encode(), default.encode()).decode(errors="replace")


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
            raise path_error(
                RECORDING_VERSION_UNKNOWN,
                path,
                f'"{path}" has the unsupported bag version {version}',
                hint="Convert the bag to version 2.0 with rosbag fix.",
                version=version,
            )
        recording.survey(file)
    return recording
