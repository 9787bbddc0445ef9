"""Recordings of every form: what ``info`` lists, and all that a player reads."""

from __future__ import annotations

import contextlib
import io
import itertools
import shutil
import sqlite3
import tempfile
import zipfile
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

from tests.campaign import mutating
from tests.campaign.target import Target

from cartwheel.errors import CartwheelError

_numbers = itertools.count()
_MOST_MESSAGES = 200
_RULE = b"=" * 80 + b"\n"


@lru_cache
def _recorded(name: str) -> bytes:
    """A short drive, as Cartwheel records it."""
    import cartwheel as cw

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        with cw.World() as world:
            world.spawn("rosbots.xacro")
            with world.record(path, topics=["/clock", "/joint_states", "/tf", "/robot_desc*"]):
                world.run(0.05)
        return path.read_bytes() if path.is_file() else _packed(path)


def _packed(folder: Path) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for file in sorted(folder.iterdir()):
            archive.write(file, file.name)
    return buffer.getvalue()


@lru_cache
def _by_others() -> dict[str, list[bytes]]:
    """Small recordings by other programs' writers, in all compressions."""
    import mcap.writer
    from rosbags.rosbag1 import Writer as Bag
    from rosbags.typesys import Stores, get_typestore

    found: dict[str, list[bytes]] = {"bag": [], "mcap": []}
    store = get_typestore(Stores.ROS1_NOETIC)
    point = store.types["geometry_msgs/msg/Point"](1.0, 2.0, 3.0)
    with tempfile.TemporaryDirectory() as folder:
        for kind in (None, Bag.CompressionFormat.BZ2, Bag.CompressionFormat.LZ4):
            path = Path(folder) / f"{kind}.bag"
            bag = Bag(path)
            if kind is not None:
                bag.set_compression(kind)
            with bag:
                topic = bag.add_connection("/p", "geometry_msgs/msg/Point", typestore=store)
                for i in range(5):
                    data = store.serialize_ros1(point, "geometry_msgs/msg/Point")
                    bag.write(topic, 10**9 + i, data)
            found["bag"].append(path.read_bytes())
    kinds = mcap.writer.CompressionType
    for options in (
        {"compression": kinds.NONE},
        {"compression": kinds.LZ4},
        {"compression": kinds.ZSTD},
        {"use_chunking": False},
        {"index_types": mcap.writer.IndexType.NONE, "compression": kinds.NONE},
    ):
        buffer = io.BytesIO()
        writer = mcap.writer.Writer(buffer, **options)
        writer.start(profile="ros2", library="a test")
        schema = writer.register_schema(
            "shop_msgs/msg/Gauge",
            "ros2msg",
            b"float64 level\nuint8[] data\nPart[<=3] parts\n"
            + _RULE
            + b"MSG: shop_msgs/Part\nstring name 'a'\nint32[2] sizes\n",
        )
        channel = writer.register_channel("/gauge", "cdr", schema)
        other = writer.register_channel("/json", "json", 0)
        cdr = b"\0\1\0\0" + bytes(8) + b"\2\0\0\0ab\0\0" + bytes(4)
        for i in range(5):
            writer.add_message(channel, i, cdr, i)
            writer.add_message(other, i, b"{}", i)
        writer.add_metadata("cartwheel", {"version": "1"})
        writer.add_attachment(1, 1, "a", "b", b"c")
        writer.finish()
        found["mcap"].append(buffer.getvalue())
    return found


def _read(path: Path) -> None:
    from cartwheel.bridges.recording.decoding import decoder
    from cartwheel.bridges.recording.opening import open_recording
    from cartwheel.cli.commands.info import info

    info(path, as_json=False)
    info(path, as_json=True)
    recording = open_recording(path)
    try:
        decoders = {}
        for number, topic in enumerate(recording.topics):
            try:
                decoders[number] = decoder(topic)
            except CartwheelError:
                continue
        for message in itertools.islice(recording.messages(), _MOST_MESSAGES):
            if message.number in decoders:
                try:
                    decoders[message.number](message.data)
                except CartwheelError:
                    continue
    finally:
        recording.close()


def _reader(name: str) -> Callable[[bytes], None]:
    def run_one(data: bytes) -> None:
        path = Path(f"{next(_numbers)}{name}").resolve()
        path.write_bytes(data)
        try:
            _read(path)
        finally:
            path.unlink()

    return run_one


def _folder(data: bytes) -> None:
    """A folder: metadata.yaml is mutated, beside a whole recording."""
    path = Path(f"folder{next(_numbers)}").resolve()
    path.mkdir()
    (path / "metadata.yaml").write_bytes(data)
    (path / "a_0.mcap").write_bytes(_by_others()["mcap"][0])
    try:
        _read(path)
    finally:
        shutil.rmtree(path)


_METADATA = b"""rosbag2_bagfile_information:
  version: 9
  storage_identifier: mcap
  relative_file_paths:
    - a_0.mcap
  duration: {nanoseconds: 4}
  starting_time: {nanoseconds_since_epoch: 0}
  message_count: 5
  topics_with_message_count: []
  compression_format: "zstd"
  compression_mode: MESSAGE
  files: [{path: a_0.mcap, message_count: 5}]
"""


def _sql(data: bytes) -> None:
    """A database whose tables are made by the input: what a stranger's tables may be."""
    path = Path(f"{next(_numbers)}.db3").resolve()
    base = sqlite3.connect(path)
    base.execute("PRAGMA synchronous = OFF")
    try:
        for statement in data.decode(errors="replace").split(";"):
            if statement.strip().upper().startswith(("CREATE", "INSERT")):
                try:
                    base.execute(statement)
                except (sqlite3.Error, sqlite3.Warning, ValueError):
                    continue
        base.commit()
        base.close()
        _read(path)
    finally:
        path.unlink(missing_ok=True)


_TABLES = b"""CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
 serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,
 timestamp INTEGER NOT NULL, data BLOB NOT NULL);
INSERT INTO topics VALUES(1, '/p', 'geometry_msgs/msg/Point', 'cdr', '- history: 3');
INSERT INTO topics VALUES(2, '/s', 'std_msgs/msg/String', 'cdr', '');
INSERT INTO messages VALUES(1, 1, 1000, x'00010000000000000000000000000000');
INSERT INTO messages VALUES(2, 2, 2000, x'00010000020000006100');
INSERT INTO messages VALUES(3, 'a', 'b', NULL);
INSERT INTO messages VALUES(4, 2, -5, 'text')
"""
_VIEW = b"""CREATE TABLE topics(id, name, type, serialization_format);
INSERT INTO topics VALUES(1, '/p', 'geometry_msgs/msg/Point', 'cdr');
CREATE TABLE metadata(id, metadata_version, metadata);
CREATE TABLE message_definitions(id, topic_type, encoding, encoded_message_definition);
INSERT INTO message_definitions VALUES(1, 'geometry_msgs/msg/Point', 'ros2msg', 'float64 x');
CREATE VIEW messages AS WITH RECURSIVE c(x) AS (VALUES(1) UNION ALL SELECT x + 1 FROM c LIMIT 9)
 SELECT x AS id, 1 AS topic_id, x AS timestamp, zeroblob(8) AS data FROM c
"""


def _definition(data: bytes) -> None:
    """A message definition of a recording, and two messages: all zeros, and as we write it."""
    from cartwheel.bridges.recording.decoding import decoder
    from cartwheel.bridges.recording.encoding import codec
    from cartwheel.bridges.recording.reading import RecordedTopic
    from cartwheel.errors import GraphError
    from cartwheel.messages import from_dict

    number = next(_numbers)
    kind, _, text = data.decode(errors="replace").partition("\n")
    is_idl = kind == "ros2idl"
    topic = RecordedTopic(
        name="/a",
        type=f"shop{number}/msg/Gauge" if is_idl else f"shop{number}_msgs/msg/Gauge",
        encoding="ros1" if kind == "ros1msg" else "cdr",
        schema=kind,
        definition=text.replace("shop", f"shop{number}"),
    )
    decode = decoder(topic)
    with contextlib.suppress(GraphError):
        decode(b"\0\1\0\0" + bytes(64))
    ours = codec("ros1" if kind == "ros1msg" else "ros2")
    try:
        written = ours.encode(from_dict(topic.type, {}), 0)
    except MemoryError:
        return  # arrays of numbers may be longer than what is allowed here
    decode(written)


_DEFINITIONS = [
    b"ros2msg\nuint8 A=1\nfloat64 level 2.5\nstring<=5 name 'x'\nint32[] a [1, 2]\nbool[<=3] b\n"
    b"Part[2] parts\n" + _RULE + b"MSG: shop_msgs/Part\nstring w\nbyte[4] raw\n",
    b"ros1msg\nHeader header\ntime stamp\nduration d\nstring S=a b # c\nchar c\n"
    + _RULE
    + b"MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n",
    b"ros2idl\nmodule shop { module msg { const long A = 1; typedef double d__3[3];\n"
    b'struct Gauge { @unit(value="m") double level; sequence<octet, 4> o; d__3 x; }; }; };\n',
]

TARGETS = (
    Target(
        name="bag",
        seeds=lambda: [*_by_others()["bag"], _recorded("a.bag")],
        run_one=_reader("a.bag"),
        allowed=(CartwheelError,),
    ),
    Target(
        name="mcap",
        seeds=lambda: [*_by_others()["mcap"], _recorded("a.mcap")],
        run_one=_reader("a.mcap"),
        allowed=(CartwheelError,),
    ),
    Target(
        name="db3",
        seeds=lambda: [_recorded("a.db3")],
        run_one=_reader("a.db3"),
        allowed=(CartwheelError,),
        most_bytes=1 << 20,
        share=0.5,
    ),
    Target(
        name="db3-tables",
        seeds=lambda: [_TABLES, _VIEW],
        run_one=_sql,
        allowed=(CartwheelError,),
        mutate=mutating.text,
        share=0.5,
    ),
    Target(
        name="bag2-folder",
        seeds=lambda: [_METADATA],
        run_one=_folder,
        allowed=(CartwheelError,),
        mutate=mutating.text,
        share=0.5,
    ),
    Target(
        name="definitions",
        seeds=lambda: list(_DEFINITIONS),
        run_one=_definition,
        allowed=(CartwheelError,),
        mutate=mutating.text,
        share=0.5,
    ),
)
