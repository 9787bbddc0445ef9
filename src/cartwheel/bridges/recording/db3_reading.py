"""Reading ROS 2 bags in SQLite, with all versions of the tables."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Collection, Iterator
from pathlib import Path

from cartwheel.bridges.recording.compression import MOST_BYTES
from cartwheel.bridges.recording.formats import path_error
from cartwheel.bridges.recording.reading import Recorded, RecordedTopic, Recording, is_latched
from cartwheel.codes.recording import NOT_A_RECORDING, RECORDING_DAMAGED
from cartwheel.messages import type_name


class Db3Recording(Recording):
    """An SQLite file.

    Args:
        path: Path of the file.
        unpack: Decompresses a message, for bags with compressed messages.

    Raises:
        RecordingError: The file is not a ROS 2 bag.
    """

    def __init__(self, path: Path, *, unpack: Callable[[bytes], bytes] = lambda data: data) -> None:
        super().__init__(form="ROS 2 bag, SQLite", size=path.stat().st_size)
        self.path = path
        self._unpack = unpack
        self._numbers: dict[int, int] = {}
        try:
            self._base = self._connect()
            self._survey()
        except (sqlite3.Error, ValueError, OverflowError) as error:
            why = str(error).partition("\n")[0]
            message = f'"{path}" is not a ROS 2 bag: {why}'
            raise path_error(NOT_A_RECORDING, path, message) from error

    def messages(
        self, *, start_ns: int = 0, topics: Collection[int] | None = None
    ) -> Iterator[Recorded]:
        wanted = [own for own, n in self._numbers.items() if topics is None or n in topics]
        marks = ", ".join("?" * len(wanted))
        try:
            rows = self._base.execute(
                "SELECT timestamp, topic_id, data FROM messages WHERE timestamp >= ?"  # noqa: S608
                f" AND topic_id IN ({marks}) ORDER BY timestamp, id",
                (start_ns, *wanted),
            )
            for time_ns, own, data in rows:
                if type(time_ns) is not int or type(data) is not bytes:
                    raise ValueError("a row of the messages table has no timestamp or no data")
                yield Recorded(time_ns, self._numbers[own], self._unpack(data))
        except (sqlite3.Error, ValueError, OverflowError) as error:
            message = f'"{self.path}" is damaged: {error}'
            raise path_error(RECORDING_DAMAGED, self.path, message) from error

    def close(self) -> None:
        self._base.close()

    def _connect(self) -> sqlite3.Connection:
        quoted = self.path.resolve().as_uri()
        base = sqlite3.connect(f"{quoted}?mode=ro", uri=True, check_same_thread=False)
        try:
            base.execute("SELECT count(*) FROM topics")
        except sqlite3.OperationalError:
            # The writer was killed: SQLite must first roll back its unfinished transaction.
            base.close()
            base = sqlite3.connect(f"{quoted}?mode=rw", uri=True, check_same_thread=False)
            base.execute("SELECT count(*) FROM topics")
        return base

    def _survey(self) -> None:
        base = self._base
        base.execute("PRAGMA trusted_schema = OFF")
        base.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MOST_BYTES)
        views = base.execute("SELECT name FROM sqlite_master WHERE type = 'view'").fetchone()
        if views:  # a view may be a query that never ends
            raise ValueError(f'it contains the view "{views[0]}", which is not allowed')
        columns = {row[1] for row in base.execute("PRAGMA table_info(topics)")}
        tables = {row[0] for row in base.execute("SELECT name FROM sqlite_master")}
        texts = {}
        if "message_definitions" in tables:
            query = "SELECT topic_type, encoding, encoded_message_definition"
            for kind, schema, text in base.execute(f"{query} FROM message_definitions"):
                texts[kind] = (schema, text)
        profiles = "offered_qos_profiles" if "offered_qos_profiles" in columns else "''"
        query = f"SELECT id, name, type, serialization_format, {profiles} FROM topics ORDER BY id"  # noqa: S608
        for own, name, kind, encoding, profile in base.execute(query):
            schema, text = texts.get(kind, ("", ""))
            if not all(isinstance(text, str) for text in (name, kind, encoding, schema, text)):
                raise ValueError(
                    "a row of the topics table has no name, type or serialization format"
                )
            self._numbers[own] = len(self.topics)
            self.topics.append(
                RecordedTopic(
                    name=name,
                    type=type_name(kind),
                    encoding=encoding,
                    schema=schema,
                    definition=text,
                    latched=isinstance(profile, str) and is_latched(profile),
                )
            )
        query = "SELECT topic_id, count(*), min(timestamp), max(timestamp) FROM messages"
        for own, count, first, last in base.execute(f"{query} GROUP BY topic_id"):
            if own in self._numbers:
                if not (isinstance(first, int) and isinstance(last, int)):
                    raise ValueError("a row of the messages table has no timestamp")
                topic = self.topics[self._numbers[own]]
                topic.count, topic.first_ns, topic.last_ns = count, first, last
        # Since version 4, the metadata is written into the file at the end. Before, it was a
        # separate file.
        self.complete = "metadata" not in tables or bool(
            base.execute("SELECT count(*) FROM metadata").fetchone()[0]
        )
