"""Two seconds of the shipped cart in each recording format, read by others' readers."""

from __future__ import annotations

import contextlib
import hashlib
import sqlite3
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .adapter import World, load_robot
from .subjects import CART

FORMATS: tuple[tuple[str, str | None], ...] = (
    ("ros2.mcap", "ros2"),
    ("ros1.mcap", "ros1"),
    ("cart.bag", None),
    ("cart.db3", None),
    ("folder", None),
)
Entry = tuple[str, str, int, bytes]
"""Topic, type, time in ns and bytes of a message."""


def measure() -> dict[str, Any]:
    """Topics, types, counts and hashes of the messages in each format."""
    with tempfile.TemporaryDirectory(prefix="golden") as folder:
        files = [(Path(folder, name), encoding) for name, encoding in FORMATS]
        with World(lenient=True) as world, contextlib.ExitStack() as recorders:
            world.spawn(load_robot(CART))
            for file, encoding in files:
                recorders.enter_context(world.record(file, encoding=encoding))
            world.publish("/part2_cmr/cmd_vel", {"linear": {"x": 0.3}, "angular": {"z": 0.2}})
            world.run(2.0)
        return {file.name: {"topics": _summed(_entries(file))} for file, _ in files}


def _summed(entries: Iterator[Entry]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for topic, kind, time, data in entries:
        entry = found.setdefault(topic, {"type": kind, "count": 0, "sum": hashlib.sha256()})
        entry["count"] += 1
        entry["sum"].update(time.to_bytes(8, "little") + len(data).to_bytes(8, "little"))
        entry["sum"].update(data)
    for entry in found.values():
        entry["sha256"] = entry.pop("sum").hexdigest()
    return dict(sorted(found.items()))


def _entries(file: Path) -> Iterator[Entry]:
    if file.suffix == ".mcap":
        yield from _of_mcap(file)
    elif file.suffix == ".db3":
        yield from _of_db3(file)
    elif file.suffix == ".bag":
        from rosbags.rosbag1 import Reader

        with Reader(file) as bag:
            for connection, time, data in bag.messages():
                yield connection.topic, connection.msgtype, time, bytes(data)
    else:
        from rosbags.rosbag2 import Reader as FolderReader

        with FolderReader(file) as folder:
            for connection, time, data in folder.messages():
                yield connection.topic, connection.msgtype, time, bytes(data)


def _of_mcap(file: Path) -> Iterator[Entry]:
    from mcap.reader import make_reader

    with file.open("rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages():
            kind = schema.name if schema is not None else ""
            yield channel.topic, kind, message.log_time, message.data


def _of_db3(file: Path) -> Iterator[Entry]:
    with contextlib.closing(sqlite3.connect(file)) as base:
        yield from base.execute(
            "SELECT topics.name, topics.type, messages.timestamp, messages.data FROM messages "
            "JOIN topics ON messages.topic_id = topics.id ORDER BY messages.timestamp, messages.id"
        )
