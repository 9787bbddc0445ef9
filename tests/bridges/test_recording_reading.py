"""Reading recordings that others wrote, whole, broken and strange."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mcap.writer
import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Bag1Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Bag2Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from tests import launching
from tests.bridges.test_recording import (
    HAS_ROSBAG,
    PROGRAM,
    PYTHON,
    drive,
    read_with_mcap,
    run_program,
)
from tests.coded import raises

from cartwheel.bridges.recording.decoding import decoder
from cartwheel.bridges.recording.encoding import codec
from cartwheel.bridges.recording.opening import open_recording
from cartwheel.bridges.recording.reading import RecordedTopic
from cartwheel.codes.command import RECORDING_UNFINISHED
from cartwheel.codes.recording import (
    NOT_A_RECORDING,
    RECORDED_TYPE_UNUSABLE,
    RECORDING_DAMAGED,
    RECORDING_UNREADABLE,
    RECORDING_VERSION_UNKNOWN,
)
from cartwheel.errors import RecordingError
from cartwheel.messages import decode_cdr, encode_cdr, zero

COUNT = 200
STORE = get_typestore(Stores.ROS2_JAZZY)
STORE1 = get_typestore(Stores.ROS1_NOETIC)
GAUGE = "float64 level\nstd_msgs/String label\n"
"""Of the type shop_msgs/Gauge, which nobody else knows."""
for store in (STORE, STORE1):
    store.register(get_types_from_msg(GAUGE, "shop_msgs/msg/Gauge"))


def point(i: int, store: Any) -> Any:
    return store.types["geometry_msgs/msg/Point"](float(i), -1.0, 0.5)


def gauge(i: int, store: Any) -> Any:
    return store.types["shop_msgs/msg/Gauge"](i / 2, store.types["std_msgs/msg/String"](f"n{i}"))


def by_rosbags1(path: Path) -> None:
    with Bag1Writer(path) as bag:
        _fill1(bag)


def by_rosbags1_bz2(path: Path) -> None:
    bag = Bag1Writer(path)
    bag.set_compression(Bag1Writer.CompressionFormat.BZ2)
    with bag:
        _fill1(bag)


def by_rosbags1_lz4(path: Path) -> None:
    bag = Bag1Writer(path)
    bag.set_compression(Bag1Writer.CompressionFormat.LZ4)
    with bag:
        _fill1(bag)


def _fill1(bag: Any) -> None:
    points = bag.add_connection("/point", "geometry_msgs/msg/Point", typestore=STORE1)
    gauges = bag.add_connection("/gauge", "shop_msgs/msg/Gauge", typestore=STORE1)
    for i in range(COUNT):
        data = STORE1.serialize_ros1(point(i, STORE1), "geometry_msgs/msg/Point")
        bag.write(points, 10**9 + i * 10**7, data)
        data = STORE1.serialize_ros1(gauge(i, STORE1), "shop_msgs/msg/Gauge")
        bag.write(gauges, 10**9 + i * 10**7 + 5, data)


def _by_rosbags2(plugin: StoragePlugin, mode: CompressionMode, version: Any) -> Any:
    def write(path: Path) -> None:
        bag = Bag2Writer(path, version=version, storage_plugin=plugin)
        bag.set_compression(mode, CompressionFormat.ZSTD)
        with bag:
            points = bag.add_connection("/point", "geometry_msgs/msg/Point", typestore=STORE)
            gauges = bag.add_connection("/gauge", "shop_msgs/msg/Gauge", typestore=STORE)
            for i in range(COUNT):
                data = STORE.serialize_cdr(point(i, STORE), "geometry_msgs/msg/Point")
                bag.write(points, 10**9 + i * 10**7, data)
                data = STORE.serialize_cdr(gauge(i, STORE), "shop_msgs/msg/Gauge")
                bag.write(gauges, 10**9 + i * 10**7 + 5, data)

    return write


def _by_mcap(**options: Any) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        with path.open("wb") as file:
            writer = mcap.writer.Writer(file, **options)
            writer.start(profile="ros2", library="a test")
            texts = {"geometry_msgs/msg/Point": "float64 x\nfloat64 y\nfloat64 z\n"}
            texts["shop_msgs/msg/Gauge"] = STORE.generate_msgdef(
                "shop_msgs/msg/Gauge", ros_version=2
            )[0]
            channels = {}
            for name, text in texts.items():
                schema = writer.register_schema(name, "ros2msg", text.encode())
                topic = f"/{name.rsplit('/', 1)[1].lower()}"
                channels[name] = writer.register_channel(topic, "cdr", schema)
            other = writer.register_channel("/json", "json", 0)
            for i in range(COUNT):
                for name, made, late in (
                    ("geometry_msgs/msg/Point", point, 0),
                    ("shop_msgs/msg/Gauge", gauge, 5),
                ):
                    data = bytes(STORE.serialize_cdr(made(i, STORE), name))
                    time_ns = 10**9 + i * 10**7 + late
                    writer.add_message(channels[name], time_ns, data, time_ns)
            writer.add_message(other, 10**9 + 1, b"{}", 10**9 + 1)
            writer.finish()

    return write


_TYPES = mcap.writer.CompressionType
WRITERS = {
    "rosbags.bag": by_rosbags1,
    "bz2.bag": by_rosbags1_bz2,
    "lz4.bag": by_rosbags1_lz4,
    "sqlite8": _by_rosbags2(StoragePlugin.SQLITE3, CompressionMode.NONE, 8),
    "sqlite9": _by_rosbags2(StoragePlugin.SQLITE3, CompressionMode.NONE, 9),
    "packed": _by_rosbags2(StoragePlugin.SQLITE3, CompressionMode.MESSAGE, 9),
    "mcap9": _by_rosbags2(StoragePlugin.MCAP, CompressionMode.NONE, 9),
    "zstd.mcap": _by_mcap(chunk_size=1000, compression=_TYPES.ZSTD),
    "lz4.mcap": _by_mcap(chunk_size=1000, compression=_TYPES.LZ4),
    "bare.mcap": _by_mcap(use_chunking=False),
    "noindex.mcap": _by_mcap(chunk_size=1000, index_types=mcap.writer.IndexType.NONE),
    "terse.mcap": _by_mcap(chunk_size=1000, repeat_channels=False, repeat_schemas=False),
}


@pytest.mark.parametrize("name", WRITERS)
def test_what_others_wrote_is_read(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    WRITERS[name](path)
    recording = open_recording(path)
    assert recording.complete
    topics = {topic.name: topic for topic in recording.topics if topic.name != "/json"}
    assert {name: (t.type, t.count) for name, t in topics.items()} == {
        "/point": ("geometry_msgs/msg/Point", COUNT),
        "/gauge": ("shop_msgs/msg/Gauge", COUNT),
    }
    assert topics["/point"].rate == pytest.approx(100.0)
    assert topics["/gauge"].first_ns == 10**9 + 5
    decode = {recording.topics.index(topic): decoder(topic) for topic in topics.values()}
    numbers = {topic.name: recording.topics.index(topic) for topic in topics.values()}
    found = [m for m in recording.messages() if m.number in decode]
    assert [m.time_ns for m in found] == sorted(
        10**9 + i * 10**7 + late for i in range(COUNT) for late in (0, 5)
    )
    points = [decode[m.number](m.data) for m in found if m.number == numbers["/point"]]
    assert [p.x for p in points] == list(map(float, range(COUNT)))
    gauges = [decode[m.number](m.data) for m in found if m.number == numbers["/gauge"]]
    assert [(g.level, g.label.data) for g in gauges] == [(i / 2, f"n{i}") for i in range(COUNT)]
    # From the middle on, one topic alone.
    late = list(recording.messages(start_ns=2 * 10**9, topics=[numbers["/gauge"]]))
    assert [m.time_ns for m in late] == [10**9 + i * 10**7 + 5 for i in range(100, COUNT)]
    recording.close()


def test_bytes_that_are_no_messages_are_listed_and_not_decoded(tmp_path: Path) -> None:
    WRITERS["zstd.mcap"](tmp_path / "a.mcap")
    recording = open_recording(tmp_path / "a.mcap")
    (topic,) = (topic for topic in recording.topics if topic.name == "/json")
    assert (topic.encoding, topic.count) == ("json", 1)
    with raises(RECORDED_TYPE_UNUSABLE, encoding="json"):
        decoder(topic)


def test_another_type_of_a_known_name_is_not_taken_for_it(tmp_path: Path) -> None:
    with (tmp_path / "a.mcap").open("wb") as file:
        writer = mcap.writer.Writer(file)
        writer.start()
        schema = writer.register_schema("geometry_msgs/msg/Point", "ros2msg", b"int32 x\n")
        channel = writer.register_channel("/a", "cdr", schema)
        writer.add_message(channel, 1, b"\0\1\0\0\5\0\0\0", 1)
        writer.finish()
    (topic,) = open_recording(tmp_path / "a.mcap").topics
    with raises(RECORDED_TYPE_UNUSABLE, why="fields"):
        decoder(topic)


@pytest.mark.skipif(not HAS_ROSBAG, reason="Debian's python3-rosbag is not installed")
@pytest.mark.parametrize("compression", ["none", "bz2"])
def test_a_bag_of_ros_1_itself(compression: str, tmp_path: Path) -> None:
    script = (
        "import rosbag, rospy, sys\n"
        "from geometry_msgs.msg import Twist\n"
        "with rosbag.Bag(sys.argv[1], 'w', compression=sys.argv[2], chunk_threshold=2000) as b:\n"
        "    for i in range(200):\n"
        "        t = Twist(); t.linear.x = i\n"
        "        b.write('/cmd_vel', t, rospy.Time.from_sec(100 + i * 0.01))\n"
    )
    path = tmp_path / "a.bag"
    launching.run([PYTHON, "-c", script, str(path), compression], check=True)
    recording = open_recording(path)
    (topic,) = recording.topics
    assert (topic.type, topic.count) == ("geometry_msgs/msg/Twist", 200)
    decode = decoder(topic)
    assert [decode(m.data).linear.x for m in recording.messages()] == list(map(float, range(200)))


@pytest.mark.parametrize("name", ["a.mcap", "a.bag"])
def test_a_file_cut_anywhere_gives_what_lies_before(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    drive(path, 0.5, topics=["!*image*"])
    whole = path.read_bytes()
    every = [(m.time_ns, m.data) for m in open_recording(path).messages()]
    cut = tmp_path / f"cut{path.suffix}"
    chance = random.Random(5)
    sizes = [13, 4120, len(whole) - 1, *(chance.randrange(13, len(whole)) for _ in range(40))]
    kept = {}
    for size in sizes:
        cut.write_bytes(whole[:size])
        try:
            recording = open_recording(cut)
        except RecordingError:
            assert size < 5000
            continue
        found = [(m.time_ns, m.data) for m in recording.messages()]
        assert found == every[: len(found)]
        assert sum(topic.count for topic in recording.topics) == len(found)
        kept[size] = len(found)
    # The end alone is missing here, or some of the last block.
    assert kept[len(whole) - 1] > 0.8 * len(every)
    assert [kept[size] for size in sorted(kept)] == sorted(kept.values())


@pytest.mark.parametrize("name", ["a.mcap", "a.bag", "a.db3"])
def test_damage_is_reported_and_is_no_fault(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    drive(path, 0.3, topics=["!*image*"])
    whole = path.read_bytes()
    chance = random.Random(7)
    reported = 0
    for _ in range(60):
        broken = bytearray(whole)
        for _ in range(8):
            broken[chance.randrange(len(broken))] = chance.randrange(256)
        path.write_bytes(broken)
        try:
            recording = open_recording(path)
            for topic in recording.topics:
                decoder(topic)
            list(recording.messages())
            recording.close()
        except RecordingError as error:
            assert error.code in (
                RECORDING_DAMAGED,
                RECORDED_TYPE_UNUSABLE,
                NOT_A_RECORDING,
                RECORDING_VERSION_UNKNOWN,
            )
            reported += 1
    assert reported > 0 or name != "a.mcap"


# -- the command


def test_info_lists_a_recording(tmp_path: Path) -> None:
    drive(tmp_path / "a.mcap", 1.0, topics=["/clock", "/imu/data", "/robot_description"])
    said = run_program("info", "a.mcap", folder=tmp_path)
    assert "MCAP" in said and "robot_description.xml" in said
    lines = {line.split()[0]: line.split() for line in said.splitlines() if line.startswith("/")}
    assert lines["/clock"][1:] == ["rosgraph_msgs/Clock", "101", "100", "Hz"]
    assert lines["/robot_description"][1:] == ["std_msgs/String", "1", "latched"]
    found = json.loads(run_program("info", "a.mcap", "--json", folder=tmp_path))
    assert found["complete"] and found["messages"] == 133
    assert found["end_ns"] == 1_000_000_000
    assert {t["name"]: t["messages"] for t in found["topics"]}["/imu/data"] == 31


@pytest.mark.parametrize("content", [b"", b"hello", b"\x89MCAP0\r\n", b"#ROSBAG V1.2\n"])
def test_info_of_what_is_no_recording(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "a.mcap").write_bytes(content)
    done = launching.run(
        [PROGRAM, "info", "a.mcap"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert "Traceback" not in done.stderr
    if content.startswith(b"\x89"):
        assert f"[{RECORDING_UNFINISHED}]" in done.stderr
    else:
        assert done.returncode == 2 and "[CW90" in done.stderr


def test_info_of_nothing(tmp_path: Path) -> None:
    assert f"[{RECORDING_UNREADABLE}]" in run_program(
        "info", "nowhere.bag", folder=tmp_path, status=2
    )
    (tmp_path / "empty").mkdir()
    assert f"[{NOT_A_RECORDING}]" in run_program("info", "empty", folder=tmp_path, status=2)


def test_a_type_that_ros1_and_ros2_have_differently_is_read_as_each_has_it() -> None:
    name = "control_msgs/msg/JointTrajectoryControllerState"
    for mine, field in ((name, "desired"), (name.replace("/", "_ros2/", 1), "reference")):
        schema = codec("ros2").schema(mine)
        assert schema.name == name
        topic = RecordedTopic(
            name="/state", type=name, encoding="cdr", schema="ros2msg", definition=schema.text
        )
        message = zero(mine)
        getattr(message, field).positions = np.array([0.5])
        again = decoder(topic)(encode_cdr(message))
        assert again.__msgtype__ == mine
        assert getattr(again, field).positions.tolist() == [0.5]


ARM = """<robot name="arm">
  <link name="base"/>
  <link name="upper"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tip"/>
  <joint name="shoulder" type="continuous">
    <parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
  <joint name="glue" type="fixed">
    <parent link="upper"/><child link="tip"/><origin xyz="0.4 0 0"/></joint>
</robot>"""


def test_a_file_states_where_links_are_that_no_plugin_states(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(ARM)
    run_program(
        *("run", "arm.urdf", "--headless", "--speed", "max", "--for", "1", "--record", "a.mcap"),
        folder=tmp_path,
    )
    found = read_with_mcap(tmp_path / "a.mcap")
    links = {
        topic: {
            one.child_frame_id
            for _, data in found[topic]
            for one in decode_cdr(data, "tf2_msgs/msg/TFMessage").transforms
        }
        for topic in ("/tf", "/tf_static")
    }
    assert links == {"/tf": {"upper"}, "/tf_static": {"tip"}}
