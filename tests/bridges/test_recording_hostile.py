"""Recordings that were made to hang or devour their reader."""

from __future__ import annotations

import bz2
import os
import sqlite3

import mcap.writer
import pytest
from backports import zstd
from lz4 import frame
from tests.coded import raises

from cartwheel.bridges.recording import bag_writing, compression, mcap_format, reading
from cartwheel.bridges.recording.compression import decompress
from cartwheel.bridges.recording.decoding import decoder
from cartwheel.bridges.recording.opening import open_recording
from cartwheel.bridges.recording.reading import RecordedTopic
from cartwheel.codes.recording import (
    NOT_A_RECORDING,
    RECORDED_TYPE_UNUSABLE,
    RECORDING_DAMAGED,
    RECORDING_UNREADABLE,
)
from cartwheel.errors import RecordingError
from cartwheel.messages import store

PACKERS = {"bz2": bz2.compress, "lz4": frame.compress, "zstd": zstd.compress}
TABLES = """CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT,
  serialization_format TEXT, offered_qos_profiles TEXT);
  INSERT INTO topics VALUES(1, '/p', 'geometry_msgs/msg/Point', 'cdr', '');"""
MESSAGES = "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data);"


def streamed(data):
    """As zstd packs what it does not know the size of."""
    packer = zstd.ZstdCompressor()
    return packer.compress(data[:10]) + packer.compress(data[10:]) + packer.flush()


@pytest.mark.parametrize("kind", PACKERS)
def test_what_was_packed_is_unpacked(kind):
    data = os.urandom(1000) * 20
    pack = PACKERS[kind]
    assert decompress(pack(data), kind) == data
    assert decompress(pack(b""), kind) == b""
    # Several frames in a row are one.
    assert decompress(pack(data) + pack(data), kind) == data * 2
    for cut in range(1, 40):
        with pytest.raises(ValueError, match=r"."):
            decompress(pack(data)[:-cut], kind)


@pytest.mark.parametrize("kind", [*PACKERS, "zstd without its size"])
def test_a_bomb_is_refused_before_it_fills_memory(kind, monkeypatch):
    monkeypatch.setattr(compression, "MOST_BYTES", 1 << 20)
    pack = PACKERS.get(kind, streamed)
    kind = kind.split()[0]
    assert len(decompress(pack(bytes(1 << 20)), kind)) == 1 << 20
    with pytest.raises(compression.TooLargeError):
        decompress(pack(bytes((1 << 20) + 1)), kind)
    with pytest.raises(compression.TooLargeError):
        decompress(pack(bytes(1 << 19)) * 3, kind)


def test_chunks_that_all_overlap_are_refused_where_they_would_fill_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(reading, "_MOST_WAITING", 1 << 20)
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = mcap.writer.Writer(file, chunk_size=1 << 18)
        writer.start()
        channel = writer.register_channel("/a", "json", 0)
        for _ in range(30):
            writer.add_message(channel, 10**9, bytes(1 << 17), 10**9)
            writer.add_message(channel, 1, b"", 1)
        writer.finish()
    recording = open_recording(path)
    with raises(RECORDING_DAMAGED) as caught:
        list(recording.messages())
    assert caught.value.values["overlap"] > 1 << 20


def test_a_record_without_its_fields_is_damage(tmp_path):
    """A message record that is shorter than its header, and a bag record with an empty type."""
    short = mcap_format.record(mcap_format.Op.MESSAGE, b"\1\0\0")
    (tmp_path / "a.mcap").write_bytes(mcap_format.MAGIC + short)
    with raises(RECORDING_DAMAGED, byte=20):
        open_recording(tmp_path / "a.mcap")
    nothing = bag_writing.record({"op": b""}, b"")
    empty = bag_writing.record({"op": bytes([bag_writing.BAG_HEADER])}, b"")
    (tmp_path / "a.bag").write_bytes(bag_writing.MAGIC + nothing)
    assert open_recording(tmp_path / "a.bag").topics == []
    (tmp_path / "b.bag").write_bytes(bag_writing.MAGIC + empty)
    with raises(RECORDING_DAMAGED, byte=len(bag_writing.MAGIC) + len(empty)):
        open_recording(tmp_path / "b.bag")


@pytest.mark.parametrize(
    ("paths", "code"),
    [
        ("[.]", NOT_A_RECORDING),  # the folder itself, for ever
        ("[a/..]", RECORDING_UNREADABLE),
        ("[/etc/passwd]", RECORDING_UNREADABLE),
        ("[fifo]", RECORDING_UNREADABLE),
        ("5", NOT_A_RECORDING),
        ("{a: b}", NOT_A_RECORDING),
        ("&a [*a, *a]", RECORDING_DAMAGED),
        ("[" * 2000, RECORDING_DAMAGED),
        ("2001-99-99", RECORDING_DAMAGED),
    ],
    ids=["itself", "parent", "elsewhere", "fifo", "number", "mapping", "alias", "deep", "date"],
)
def test_a_folder_names_only_its_own_files(tmp_path, paths, code):
    os.mkfifo(tmp_path / "fifo")
    about = f"rosbag2_bagfile_information:\n  relative_file_paths: {paths}\n"
    (tmp_path / "metadata.yaml").write_text(about)
    with raises(code):
        open_recording(tmp_path)


@pytest.mark.parametrize(
    "tables",
    [
        # Rows without end.
        "CREATE VIEW messages AS WITH RECURSIVE c(x) AS (VALUES(1) UNION ALL SELECT x + 1"
        " FROM c) SELECT x AS id, 1 AS topic_id, x AS timestamp, x'00' AS data FROM c",
        MESSAGES + "INSERT INTO messages VALUES(1, 1, 'noon', x'00')",
        MESSAGES + "INSERT INTO messages VALUES(1, 1, 5, NULL)",
        MESSAGES + "INSERT INTO topics VALUES(2, NULL, 'a/b', 'cdr', '')",
        "CREATE TABLE messages(id, topic_id, timestamp)",
    ],
    ids=["view", "time", "data", "name", "column"],
)
def test_a_database_has_tables_of_the_right_types(tmp_path, tables):
    path = tmp_path / "a.db3"
    with sqlite3.connect(path) as base:
        base.executescript(TABLES + tables)
    with pytest.raises(RecordingError) as caught:
        list(open_recording(path).messages())
    assert caught.value.code in (NOT_A_RECORDING, RECORDING_DAMAGED)


@pytest.mark.parametrize(
    ("schema", "definition", "why"),
    [
        # Each further pair makes rosbags' parser take 70 times as long.
        ("ros2idl", "module a { const long A = ((((1)))); };", "parentheses"),
        ("ros2idl", "module a {" * 400, "definition"),
        ("ros2msg", "uint8 A=1e400", "definition"),
        ("ros1msg", "string S=a\nstring S=a", "definition"),
        ("ros1msg", "Lost x", "unknown"),
        ("ros2msg", "float64 y\nlost_msgs/Lost[2] x", "unknown"),
        ("ros2idl", "module a { module msg { struct B { b::msg::C x; }; }; };", "unknown"),
        ("ros2msg", "string[400000000] x", "size"),
        ("ros2msg", "int32[-1] x", "size"),
        ("ros2msg", "int32[10000000000000000000] x", "size"),
        ("ros2msg", "B[3] x\n", "recursive"),
        ("ros1msg", "B[] x\n", "recursive"),
        ("ros2msg", "float64 x # " + "a" * (1 << 20), "length"),
    ],
    ids=[
        "parentheses",
        "deep",
        "endless",
        "twice",
        "lost",
        "lost in an array",
        "lost, IDL",
        "array",
        "below zero",
        "numbers",
        "itself",
        "itself, ROS 1",
        "long",
    ],
)
def test_a_definition_is_read_in_bounded_time(schema, definition, why):
    topic = RecordedTopic(
        name="/a",
        type=f"a{len(definition)}/msg/B",
        encoding="ros1" if schema == "ros1msg" else "cdr",
        schema=schema,
        definition=definition,
    )
    known = set(store().fielddefs)
    with raises(RECORDED_TYPE_UNUSABLE, why=why):
        decoder(topic)
    assert set(store().fielddefs) == known


@pytest.mark.wording
def test_the_message_about_an_invalid_definition_is_one_line():
    definition = "int32 x\nint32[ y\n"
    topic = RecordedTopic(
        name="/a", type="a/msg/B", encoding="cdr", schema="ros2msg", definition=definition
    )
    with raises(RECORDED_TYPE_UNUSABLE, why="definition") as caught:
        decoder(topic)
    assert "cannot be parsed" in caught.value.message
    assert "\n" not in caught.value.message and "int32" not in caught.value.message


def test_parentheses_of_texts_and_comments_do_not_count():
    text = (
        'module shop9_msgs { module msg { @verbatim(language="comment", text="((a))")\n'
        "// ((b\n struct Gauge { double level; }; }; };\n"
    )
    topic = RecordedTopic(
        name="/a", type="shop9_msgs/msg/Gauge", encoding="cdr", schema="ros2idl", definition=text
    )
    assert decoder(topic)(b"\0\1\0\0" + bytes(8)).level == 0.0
