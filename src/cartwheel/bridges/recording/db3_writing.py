"""Writing ROS 2 bags in SQLite as a single file. Source: rosbag2_storage_sqlite3."""

from __future__ import annotations

import sqlite3
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from cartwheel.bridges.recording.encoding import codec
from cartwheel.bridges.recording.qos import qos_text
from cartwheel.bridges.recording.rosbag2_metadata import TopicCount, as_yaml, metadata

_TABLES = """
CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
CREATE TABLE metadata(
    id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
CREATE TABLE topics(
    id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
    serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL,
    type_description_hash TEXT NOT NULL);
CREATE TABLE message_definitions(
    id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
    encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE messages(
    id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
    data BLOB NOT NULL);
CREATE INDEX timestamp_idx ON messages (timestamp ASC);
INSERT INTO schema(schema_version, ros_distro) VALUES (4, 'jazzy');
"""
_TRANSACTION = 1 << 20
"""Size of a transaction in bytes of messages."""


class Db3Writer:
    """Writes an SQLite file. Flushed messages survive a crash of the process.

    Args:
        path: File to create. It must not exist.
        notes: Stored in the metadata.

    Raises:
        OSError: The file cannot be written.
    """

    def __init__(self, path: Path, *, notes: Mapping[str, str]) -> None:
        self.path = path
        self.kept_ns = 0
        self._notes = notes
        self._codec = codec("ros2")
        self._topics: list[TopicCount] = []
        self._types: set[str] = set()
        self._span: tuple[int, int] | None = None
        self._open_size = 0
        """Bytes of messages that a rollback would remove."""
        # Unlike SQLite, this reports why the file cannot be created.
        path.touch(exist_ok=False)
        path.with_name(f"{path.name}-journal").unlink(missing_ok=True)
        self._base = sqlite3.connect(path, check_same_thread=False, isolation_level=None)
        # The operating system keeps written data. Only a power failure would require more.
        self._run("PRAGMA synchronous=OFF")
        self._run("PRAGMA page_size=65536")
        try:
            self._base.executescript(_TABLES)
        except sqlite3.Error as error:
            raise OSError(None, str(error)) from error
        self._run("BEGIN")

    def add(self, topic: str, type_name: str, *, latched: bool) -> int:
        schema = self._codec.schema(type_name)
        number = len(self._topics) + 1
        if schema.name not in self._types:
            self._types.add(schema.name)
            self._run(
                "INSERT INTO message_definitions(topic_type, encoding,"
                " encoded_message_definition, type_description_hash) VALUES(?, ?, ?, ?)",
                (schema.name, "ros2msg", schema.text, schema.hash),
            )
        self._run(
            "INSERT INTO topics VALUES(?, ?, ?, ?, ?, ?)",
            (number, topic, schema.name, "cdr", qos_text(latched=latched), schema.hash),
        )
        self._topics.append(TopicCount(topic, schema.name, schema.hash, latched))
        return number - 1

    def write(self, channels: Sequence[int], times: Sequence[int], data: Sequence[bytes]) -> None:
        # Messages are inserted together up to the end of a transaction.
        begin, size = 0, self._open_size
        for end, each in enumerate(data, 1):
            size += len(each)
            if size > _TRANSACTION:
                self._insert(channels[begin:end], times[begin:end], data[begin:end])
                self.flush()
                begin, size = end, 0
        self._open_size = size
        self._insert(channels[begin:], times[begin:], data[begin:])

    def _insert(self, channels: Sequence[int], times: Sequence[int], data: Sequence[bytes]) -> None:
        if not times:
            return
        rows = zip((channel + 1 for channel in channels), times, data, strict=True)
        try:
            self._base.executemany(
                "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", rows
            )
        except sqlite3.Error as error:
            raise OSError(None, str(error)) from error
        for channel, count in Counter(channels).items():
            self._topics[channel].count += count
        first, last = self._span or (times[0], times[0])
        self._span = (min(first, *times), max(last, *times))

    def attach(self, name: str, media_type: str, data: bytes, time_ns: int) -> None:
        """Does nothing, because rosbag2 does not support attachments."""

    def flush(self) -> None:
        self._open_size = 0
        self._run("COMMIT")
        self.kept_ns = self._span[1] if self._span else 0
        self._run("BEGIN")

    def close(self) -> None:
        about = metadata(
            self._topics,
            storage="sqlite3",
            file=self.path.name,
            span=self._span,
            notes=self._notes,
        )
        self._run(
            "INSERT INTO metadata(metadata_version, metadata) VALUES(9, ?)", (as_yaml(about),)
        )
        self._run("COMMIT")
        self.kept_ns = self._span[1] if self._span else 0
        self._base.close()

    def abandon(self) -> None:
        with suppress(sqlite3.Error):
            self._base.execute("ROLLBACK")
        with suppress(sqlite3.Error):
            self._base.close()

    def _run(self, statement: str, values: tuple[Any, ...] = ()) -> None:
        try:
            self._base.execute(statement, values)
        except sqlite3.Error as error:
            raise OSError(None, str(error)) from error
