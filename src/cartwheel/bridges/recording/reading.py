"""Interface of all recordings: topics, messages, and blocks of messages."""

from __future__ import annotations

import heapq
import struct
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO, NamedTuple

from cartwheel import yaml_text
from cartwheel.bridges.recording.formats import path_error
from cartwheel.codes.recording import RECORDING_DAMAGED
from cartwheel.errors import RecordingError

_MOST_WAITING = 1 << 30
"""Maximum bytes of messages that are buffered to sort overlapping chunks."""


class Recorded(NamedTuple):
    """A recorded message."""

    time_ns: int
    number: int
    """Topic of the message, as an index of `Recording.topics`."""
    data: bytes


@dataclass(slots=True)
class RecordedTopic:
    """A recorded topic. A topic whose type changed has one entry per type."""

    name: str
    type: str
    """ROS 2 name of the type: ``pkg/msg/Name``."""
    encoding: str
    """``cdr``, ``ros1``, or an encoding that ROS does not use."""
    schema: str
    """``ros2msg``, ``ros2idl``, ``ros1msg``, or a different definition language."""
    definition: str
    latched: bool = False
    md5: str = ""
    """md5 sum of a ROS 1 type, if the recording contains it."""
    count: int = 0
    first_ns: int = 0
    last_ns: int = 0

    @property
    def rate(self) -> float | None:
        """Messages per s of recorded time; None if all messages have the same time."""
        span = self.last_ns - self.first_ns
        return (self.count - 1) * 1e9 / span if span > 0 else None

    def see(self, times: Collection[int]) -> None:
        """Counts messages by their times."""
        if not times:
            return
        first, last = min(times), max(times)
        self.first_ns = min(self.first_ns, first) if self.count else first
        self.last_ns = max(self.last_ns, last) if self.count else last
        self.count += len(times)

    def join(self, other: RecordedTopic) -> None:
        """Adds the counts of the same topic in a different file."""
        if other.count:
            count = self.count + other.count
            self.see([other.first_ns, other.last_ns])
            self.count = count


@dataclass(kw_only=True)
class Recording:
    """An open recording, for use on one thread."""

    form: str
    """Format name for users: ``MCAP``, ``bag of ROS 1``, ``bag of ROS 2``."""
    size: int
    """Size in bytes."""
    topics: list[RecordedTopic] = field(default_factory=list)
    complete: bool = False
    """Whether the recording was closed properly. Incomplete recordings are readable as well."""
    notes: Mapping[str, str] = field(default_factory=dict)
    attachments: dict[str, int] = field(default_factory=dict)
    """Sizes of attachments in bytes, by name."""

    def messages(
        self, *, start_ns: int = 0, topics: Collection[int] | None = None
    ) -> Iterator[Recorded]:
        """Messages of `topics`, or all messages, in the order of time from `start_ns`."""
        raise NotImplementedError

    def close(self) -> None:
        """Closes files that are still open."""


@dataclass(slots=True)
class Block:
    """A contiguous group of messages in a file."""

    position: int
    end: int
    first_ns: int = 0
    last_ns: int = 0
    """Zero if the file does not state the times of the block."""
    topics: frozenset[int] = frozenset()


Index = dict[int, list[int]]
"""Times of the messages in a block in ns, by the file's number of their topic."""


@dataclass(kw_only=True)
class BlockRecording(Recording):
    """A recording that consists of blocks, which are loaded one by one."""

    path: Path
    blocks: list[Block] = field(default_factory=list)
    numbers: dict[int, int] = field(default_factory=dict)
    """Index in `topics`, by the file's number of the topic."""

    def scan(self, file: BinaryIO) -> list[tuple[Block, Index]]:
        """Finds blocks and their indexes in a file, which is open behind its signature.

        An index is empty if the file does not contain it.

        Raises:
            ValueError, struct.error: The file is damaged.
        """
        raise NotImplementedError

    def load(self, data: bytes) -> list[Recorded]:
        """Messages of a block, in file order. Adds new topics.

        Raises:
            ValueError, struct.error: The block is damaged.
        """
        raise NotImplementedError

    def survey(self, file: BinaryIO) -> None:
        """Finds the blocks of a file, and the topics and times in each block.

        Raises:
            RecordingError: The file is damaged.
        """
        try:
            found = self.scan(file)
        except (ValueError, struct.error) as error:
            raise self._damaged(f"near byte {file.tell()}", file.tell(), error) from error
        if found and not self.complete:
            found[-1][1].clear()  # It may be truncated.
        for block, index in found:
            self._count(block, index)

    def _count(self, block: Block, index: Index) -> None:
        """Counts the messages in a block. Loads it if it has no index or contains new topics."""
        seen: Index = defaultdict(list)
        if index and index.keys() <= self.numbers.keys():
            seen.update({self.numbers[number]: times for number, times in index.items()})
        else:
            for message in self._loaded(block):
                seen[message.number].append(message.time_ns)
        every = [time_ns for times in seen.values() for time_ns in times]
        if every:
            for number, times in seen.items():
                self.topics[number].see(times)
            block.topics = frozenset(seen)
            if not block.last_ns:
                block.first_ns, block.last_ns = min(every), max(every)
            self.blocks.append(block)

    def _loaded(self, block: Block) -> list[Recorded]:
        with self.path.open("rb") as file:
            file.seek(block.position)
            data = file.read(block.end - block.position)
        try:
            return self.load(data)
        except (ValueError, struct.error) as error:
            raise self._damaged(f"at byte {block.position}", block.position, error) from error

    def _damaged(self, where: str, byte: int, error: Exception) -> RecordingError:
        why = "a record is too short" if isinstance(error, struct.error) else error
        message = f'"{self.path}" is damaged {where}: {why}'
        return path_error(RECORDING_DAMAGED, self.path, message, byte=byte)

    def messages(
        self, *, start_ns: int = 0, topics: Collection[int] | None = None
    ) -> Iterator[Recorded]:
        wanted = None if topics is None else frozenset(topics)
        chosen = [
            block
            for block in sorted(self.blocks, key=lambda block: (block.first_ns, block.position))
            if block.last_ns >= start_ns and (wanted is None or block.topics & wanted)
        ]
        # Blocks may overlap in time. Messages wait until no later block can contain earlier ones.
        waiting: list[tuple[int, int, Recorded]] = []
        count = size = 0
        for block in chosen:
            while waiting and waiting[0][0] < block.first_ns:
                message = heapq.heappop(waiting)[2]
                size -= len(message.data)
                yield message
            if size > _MOST_WAITING:
                raise path_error(
                    RECORDING_DAMAGED,
                    self.path,
                    f'"{self.path}" cannot be read: its chunks contain messages from the same '
                    f"time, and sorting them requires {size >> 20} MiB of memory at byte "
                    f"{block.position} (limit: {_MOST_WAITING >> 20} MiB)",
                    byte=block.position,
                    overlap=size,
                )
            for message in self._loaded(block):
                if message.time_ns >= start_ns and (wanted is None or message.number in wanted):
                    heapq.heappush(waiting, (message.time_ns, count, message))
                    count += 1
                    size += len(message.data)
        while waiting:
            yield heapq.heappop(waiting)[2]


class Bytes:
    """Sequential reader for a part of a file.

    Raises:
        ValueError: The data ends too early.
    """

    __slots__ = ("data", "offset")

    def __init__(self, data: bytes | memoryview, offset: int = 0) -> None:
        self.data = memoryview(data)
        self.offset = offset

    def take(self, size: int) -> bytes:
        """Next `size` bytes."""
        end = self.offset + size
        if size < 0 or end > len(self.data):
            raise ValueError("the data is truncated")
        taken = bytes(self.data[self.offset : end])
        self.offset = end
        return taken

    def number(self, size: int) -> int:
        """Unsigned integer of `size` bytes."""
        return int.from_bytes(self.take(size), "little")

    def text(self) -> str:
        """String with a 32-bit length."""
        return self.take(self.number(4)).decode(errors="replace")

    def mapping(self) -> dict[str, str]:
        """Map of strings."""
        inner = Bytes(self.take(self.number(4)))
        found = {}
        while inner:
            key = inner.text()
            found[key] = inner.text()
        return found

    def __bool__(self) -> bool:
        return self.offset < len(self.data)


def span_of(recording: Recording) -> tuple[int, int] | None:
    """Times of the first and last message in ns, or None without messages."""
    filled = [topic for topic in recording.topics if topic.count]
    if not filled:
        return None
    return min(t.first_ns for t in filled), max(t.last_ns for t in filled)


def is_latched(profiles: str) -> bool:
    """Whether rosbag2's QoS profiles are those of a latched topic."""
    import yaml

    try:
        found = yaml_text.load(profiles) if profiles else None
    except yaml.YAMLError:
        return False
    first = found[0] if isinstance(found, list) and found else None
    # rmw defines the numbers.
    return isinstance(first, dict) and first.get("durability") in ("transient_local", 1)
