"""What recordings of all forms have: topics, messages, blocks of them."""

from __future__ import annotations

import heapq
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from cartwheel import yaml_text
from cartwheel.codes.recording import RECORDING_DAMAGED
from cartwheel.errors import RecordingError

_MOST_WAITING = 1 << 30
"""Bytes of messages that wait until those of overlapping chunks are in order."""


class Recorded(NamedTuple):
    """A message in a recording."""

    time_ns: int
    number: int
    """Of its topic, an index of `Recording.topics`."""
    data: bytes


@dataclass(slots=True)
class RecordedTopic:
    """A topic in a recording; one whose type changed is there once for each."""

    name: str
    type: str
    """As ROS 2 names it: ``pkg/msg/Name``."""
    encoding: str
    """``cdr``, ``ros1``, or what is not ROS's."""
    schema: str
    """``ros2msg``, ``ros2idl``, ``ros1msg`` or another language of definitions."""
    definition: str
    latched: bool = False
    md5: str = ""
    """Of ROS 1's types, where the recording has it."""
    count: int = 0
    first_ns: int = 0
    last_ns: int = 0

    @property
    def rate(self) -> float | None:
        """Hz of recorded time; None where there are no two moments."""
        span = self.last_ns - self.first_ns
        return (self.count - 1) * 1e9 / span if span > 0 else None

    def see(self, times: Collection[int]) -> None:
        """Counts messages."""
        if not times:
            return
        first, last = min(times), max(times)
        self.first_ns = min(self.first_ns, first) if self.count else first
        self.last_ns = max(self.last_ns, last) if self.count else last
        self.count += len(times)

    def join(self, other: RecordedTopic) -> None:
        """Counts the same topic in another file."""
        if other.count:
            count = self.count + other.count
            self.see([other.first_ns, other.last_ns])
            self.count = count


class Recording(Protocol):
    """An open recording; for one thread."""

    form: str
    """For people: ``MCAP``, ``bag of ROS 1``, ``bag of ROS 2``."""
    size: int
    """Bytes."""
    topics: list[RecordedTopic]
    complete: bool
    """Whether it was ended as it should be; else what there is can be read all the same."""
    notes: Mapping[str, str]
    attachments: dict[str, int]
    """Sizes by name."""

    def messages(
        self, *, start_ns: int = 0, topics: Collection[int] | None = None
    ) -> Iterator[Recorded]:
        """The messages in the order of their times, from `start_ns` on, those of `topics` alone."""

    def close(self) -> None:
        """Closes its files."""


@dataclass(slots=True)
class Block:
    """Messages that lie together in a file."""

    position: int
    end: int
    first_ns: int
    last_ns: int
    topics: frozenset[int]
    about: Any = None
    """What the form needs to load it."""


@dataclass
class BlockRecording:
    """A recording of blocks that are loaded one after the other."""

    path: Path
    form: str = ""
    size: int = 0
    topics: list[RecordedTopic] = field(default_factory=list)
    complete: bool = False
    notes: Mapping[str, str] = field(default_factory=dict)
    attachments: dict[str, int] = field(default_factory=dict)
    blocks: list[Block] = field(default_factory=list)

    def load(self, block: Block) -> list[Recorded]:
        """The messages of a block, in the order in which they lie there.

        Raises:
            ValueError: It is damaged.
        """
        raise NotImplementedError

    def messages(
        self, *, start_ns: int = 0, topics: Collection[int] | None = None
    ) -> Iterator[Recorded]:
        wanted = None if topics is None else frozenset(topics)
        chosen = [
            block
            for block in sorted(self.blocks, key=lambda block: (block.first_ns, block.position))
            if block.last_ns >= start_ns and (wanted is None or block.topics & wanted)
        ]
        # Blocks may overlap in time: what may still be preceded by the next one waits.
        waiting: list[tuple[int, int, Recorded]] = []
        count = size = 0
        for block in chosen:
            while waiting and waiting[0][0] < block.first_ns:
                message = heapq.heappop(waiting)[2]
                size -= len(message.data)
                yield message
            if size > _MOST_WAITING:
                raise RecordingError(
                    f'"{self.path}" cannot be read: too many of its chunks overlap in time '
                    f"({size >> 20} MiB at byte {block.position})",
                    code=RECORDING_DAMAGED,
                    values={"path": str(self.path), "byte": block.position, "overlap": size},
                )
            try:
                loaded = self.load(block)
            except ValueError as error:
                raise RecordingError(
                    f'"{self.path}" is damaged at byte {block.position}: {error}',
                    code=RECORDING_DAMAGED,
                    values={"path": str(self.path), "byte": block.position},
                ) from error
            for message in loaded:
                if message.time_ns >= start_ns and (wanted is None or message.number in wanted):
                    heapq.heappush(waiting, (message.time_ns, count, message))
                    count += 1
                    size += len(message.data)
        while waiting:
            yield heapq.heappop(waiting)[2]

    def close(self) -> None:
        """Nothing is open between two loads."""


class Bytes:
    """A part of a file that is read from front to back.

    Raises:
        ValueError: Whenever it ends too early.
    """

    __slots__ = ("data", "offset")

    def __init__(self, data: bytes | memoryview, offset: int = 0) -> None:
        self.data = memoryview(data)
        self.offset = offset

    def take(self, size: int) -> bytes:
        """The next bytes."""
        end = self.offset + size
        if size < 0 or end > len(self.data):
            raise ValueError("the data is truncated")
        taken = bytes(self.data[self.offset : end])
        self.offset = end
        return taken

    def number(self, size: int) -> int:
        """An unsigned number of so many bytes."""
        return int.from_bytes(self.take(size), "little")

    def text(self) -> str:
        """A string with its length in four bytes."""
        return self.take(self.number(4)).decode(errors="replace")

    def mapping(self) -> dict[str, str]:
        """Strings by strings."""
        inner = Bytes(self.take(self.number(4)))
        found = {}
        while inner:
            key = inner.text()
            found[key] = inner.text()
        return found

    def __bool__(self) -> bool:
        return self.offset < len(self.data)


def span_of(recording: Recording) -> tuple[int, int] | None:
    """Times of the first and last message in ns."""
    filled = [topic for topic in recording.topics if topic.count]
    if not filled:
        return None
    return min(t.first_ns for t in filled), max(t.last_ns for t in filled)


def is_latched(profiles: str) -> bool:
    """Whether QoS profiles, as rosbag2 writes them, are those of a latched topic."""
    import yaml

    try:
        found = yaml_text.load(profiles) if profiles else None
    except yaml.YAMLError:
        return False
    first = found[0] if isinstance(found, list) and found else None
    # Numbers are those of rmw.
    return isinstance(first, dict) and first.get("durability") in ("transient_local", 1)
