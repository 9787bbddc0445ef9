"""Recordings, read back by readers that are not ours: mcap, rosbags, Debian's rosbag, SQLite."""

from __future__ import annotations

import contextlib
import hashlib
import io
import itertools
import json
import os
import random
import re
import signal
import sqlite3
import subprocess
import sys
import threading
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import NonSeekingReader, make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from tests import launching
from tests.coded import coded, raises
from tests.processes import bridges_of

import cartwheel as cw
from cartwheel.bridges.recording import Recorder, writing
from cartwheel.bridges.recording.backlog import ROOM, WIDTH, Backlog
from cartwheel.bridges.recording.formats import encoding_for
from cartwheel.bridges.recording.opening import open_recording
from cartwheel.bridges.recording.patterns import Patterns
from cartwheel.bridges.recording.sink import Sink
from cartwheel.bridges.recording.writing import open_writer
from cartwheel.codes.command import OPTION_INVALID, OPTIONS_CONFLICT
from cartwheel.codes.recording import (
    DISK_SLOW,
    ENCODING_UNFIT,
    MESSAGE_NOT_RECORDED,
    RECORDING_BROKE_OFF,
    RECORDING_EXISTS,
    RECORDING_NAME_INVALID,
    RECORDING_NOT_WRITABLE,
    TOPIC_PATTERN_INVALID,
    TOPIC_PATTERN_UNMATCHED,
)
from cartwheel.codes.wires import BRIDGE_ENDED
from cartwheel.errors import Code, Diagnostic, RecordingError
from cartwheel.graph import Graph
from cartwheel.messages import encode_cdr, message_class
from cartwheel.messages.ros1 import encode_ros1, ros1_type
from cartwheel.messages.ros1 import writing as ros1_writing
from cartwheel.messages.ros2 import definitions as ros2

PROGRAM = Path(sys.executable).with_name("cartwheel")
PYTHON = "/usr/bin/python3"
HAS_ROSBAG = Path("/usr/lib/python3/dist-packages/rosbag").is_dir()
NAMES = ["drive.mcap", "drive.bag", "drive.db3", "drive"]

Found = dict[str, list[tuple[int, bytes]]]
"""Times and bytes by topic."""


class Witness:
    """What a subscriber of all topics sees."""

    def __init__(self, world: cw.World, *, ros1: bool) -> None:
        self.found: Found = defaultdict(list)
        self.types: dict[str, str] = {}
        for info in world.graph.topics():
            self._watch(world, info.name, info.type, ros1)

    def _watch(self, world: cw.World, name: str, kind: str, ros1: bool) -> None:
        simulation = world.session.simulation
        found = self.found[name]

        def take(message: Any) -> None:
            seq = len(found) + 1
            data = encode_ros1(message, seq=seq) if ros1 else encode_cdr(message)
            found.append((simulation.time_ns, data))

        self.types[name] = kind
        world.graph.subscribe(name, take, node="witness")


def read_with_rosbags(path: Path) -> Found:
    found: Found = defaultdict(list)
    with AnyReader([path]) as reader:
        for connection, time_ns, data in reader.messages():
            reader.deserialize(data, connection.msgtype)
            found[connection.topic].append((time_ns, bytes(data)))
    return found


def read_with_mcap(path: Path) -> Found:
    found: Found = defaultdict(list)
    with path.open("rb") as file:
        for _, channel, message in make_reader(file, validate_crcs=True).iter_messages():
            found[channel.topic].append((message.log_time, message.data))
    return found


def read_with_debian(path: Path, *options: str) -> dict[str, list[list[Any]]]:
    """By Debian's rosbag, in another Python: times and digests by topic."""
    script = (
        "import collections, hashlib, json, rosbag, sys\n"
        "found = collections.defaultdict(list)\n"
        "for topic, raw, t in rosbag.Bag(sys.argv[1], *map(json.loads, sys.argv[2:]))"
        ".read_messages(raw=True):\n"
        "    found[topic].append([t.to_nsec(), hashlib.md5(raw[1]).hexdigest(), raw[2]])\n"
        "print(json.dumps(found))\n"
    )
    run = launching.run(
        [PYTHON, "-c", script, str(path), *options],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    found: dict[str, list[list[Any]]] = json.loads(run.stdout)
    return found


def drive(path: Path, seconds: float = 1.0, **options: Any) -> Found:
    """Records the cart, driving, beside a witness."""
    with cw.World("empty", seed=3) as world:
        cart = world.spawn("rosbots.xacro")
        with world.record(path, **options):
            witness = Witness(world, ros1=path.suffix == ".bag")
            cart.publish("/part2_cmr/cmd_vel", linear_x=0.5, angular_z=0.3)
            world.run(seconds)
            return {topic: list(found) for topic, found in witness.found.items() if found}


@pytest.fixture(scope="module")
def drives(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Path, Found]]:
    folder = tmp_path_factory.mktemp("drives")
    made = {}
    for name in NAMES:
        path = folder / name
        made[name] = (path, drive(path))
    return made


@pytest.mark.parametrize("name", NAMES)
def test_a_recording_is_what_a_subscriber_saw(
    name: str, drives: dict[str, tuple[Path, Found]]
) -> None:
    path, seen = drives[name]
    assert len(seen["/clock"]) == 101
    assert len(seen["/rosbots/camera1/image_raw"]) == 31
    assert len(seen["/part2_cmr/cmd_vel"]) == 1
    found = read_with_rosbags(path)
    assert set(found) == set(seen)
    for topic in seen:
        # rosbag knows no moment before its first nanosecond.
        least = 1 if name == "drive.bag" else 0
        assert found[topic] == [(max(t, least), data) for t, data in seen[topic]], topic


@pytest.mark.parametrize("name", [*NAMES, "process.mcap"])
def test_a_recording_without_other_subscribers_has_the_same_bytes(
    name: str, drives: dict[str, tuple[Path, Found]], tmp_path: Path
) -> None:
    """Devices then publish values, of which no messages are made."""
    path = tmp_path / name
    apart = {"record": path} if name == "process.mcap" else {}
    with cw.World("empty", seed=3, **apart) as world:
        cart = world.spawn("rosbots.xacro")
        with contextlib.nullcontext() if apart else world.record(path):
            assert all(
                each._topic.takers
                for each in world.graph.publishers()
                if each.topic in ("/odom", "/tf", "/joint_states", "/imu/data", "/bumpers")
            )
            cart.publish("/part2_cmr/cmd_vel", linear_x=0.5, angular_z=0.3)
            world.run(1.0)
    _, seen = drives["drive.mcap" if apart else name]
    found = read_with_rosbags(path)
    least = 1 if name == "drive.bag" else 0
    # A run that records also publishes the transforms of all joints, and latched messages arrive at
    # its recorder after the first step.
    others = {"/tf", "/tf_static", "/robot_description"} if apart else set()
    for topic in seen.keys() - others:
        assert found[topic] == [(max(t, least), data) for t, data in seen[topic]], topic


@pytest.mark.parametrize("name", ["drive.mcap", "drive/drive_0.mcap"])
def test_mcap_is_read_by_its_own_library(name: str, drives: dict[str, tuple[Path, Found]]) -> None:
    path, seen = drives[name.partition("/")[0]]
    path = path.parent / name
    assert read_with_mcap(path) == seen
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        assert summary is not None and summary.statistics is not None
        assert summary.statistics.message_count == sum(map(len, seen.values()))
        decoded = defaultdict(list)
        for _, channel, _, message in reader.iter_decoded_messages():
            decoded[channel.topic].append(message)
        ((attachment),) = reader.iter_attachments()
        assert attachment.name == "robot_description.xml"
        assert attachment.data.decode() == decoded["/robot_description"][0].data
        (notes,) = reader.iter_metadata()
        assert notes.metadata["seed"] == "3"
    stamps = [m.header.stamp for m in decoded["/imu/data"]]
    assert [s.sec * 10**9 + s.nanosec for s in stamps] == [t for t, _ in seen["/imu/data"]]
    assert decoded["/odom"][-1].twist.twist.linear.x == pytest.approx(0.5, abs=0.05)


@pytest.mark.skipif(not HAS_ROSBAG, reason="Debian's python3-rosbag is not installed")
def test_a_bag_is_read_by_ros_1(drives: dict[str, tuple[Path, Found]]) -> None:
    path, seen = drives["drive.bag"]
    found = read_with_debian(path)
    assert set(found) == set(seen)
    for topic, messages in seen.items():
        digests = [[max(t, 1), hashlib.md5(data).hexdigest()] for t, data in messages]
        assert [row[:2] for row in found[topic]] == digests, topic
    assert found["/imu/data"][0][2] == "6a62c6daae103f4ff57a132d6f95cec2"  # rosmsg md5


def test_db3_is_rosbag2s_schema(drives: dict[str, tuple[Path, Found]]) -> None:
    path, seen = drives["drive.db3"]
    base = sqlite3.connect(path)
    rows = base.execute(
        "SELECT name, timestamp, data FROM messages JOIN topics ON topics.id = topic_id"
        " ORDER BY messages.id"
    )
    found: Found = defaultdict(list)
    for name, time_ns, data in rows:
        found[name].append((time_ns, data))
    assert found == seen
    texts = dict(
        base.execute("SELECT topic_type, encoded_message_definition FROM message_definitions")
    )
    assert texts["sensor_msgs/msg/Imu"].startswith("std_msgs/Header header\n")
    assert base.execute("SELECT schema_version FROM schema").fetchone() == (4,)


def test_ros_1s_encoding_in_mcap(tmp_path: Path) -> None:
    path = tmp_path / "one.mcap"
    drive(path, 0.2, topics=["/imu/data"], encoding="ros1")
    with path.open("rb") as file:
        rows = list(make_reader(file, validate_crcs=True).iter_messages())
    assert [message.log_time for _, _, message in rows] == [
        # 30 Hz on steps of 5 ms
        0, 35_000_000, 70_000_000, 100_000_000, 135_000_000, 170_000_000, 200_000_000,
    ]  # fmt: skip
    schema, channel, first = rows[0]
    assert schema is not None
    assert (schema.name, schema.encoding) == ("sensor_msgs/Imu", "ros1msg")
    assert schema.data.decode() == ros1_type("sensor_msgs/msg/Imu").definition
    assert channel.message_encoding == "ros1"
    assert first.data[:4] == b"\x01\0\0\0"  # the header's seq


# -- which topics


@pytest.mark.parametrize(
    ("patterns", "expected"),
    [
        ([], {"/clock", "/imu/data", "/a/image", "/b/image"}),
        (["/clock"], {"/clock"}),
        (["clock"], {"/clock"}),
        (["*/image"], {"/a/image", "/b/image"}),
        (["re:/(clock|imu/.*)"], {"/clock", "/imu/data"}),
        (["!*/image"], {"/clock", "/imu/data"}),
        (["/a/*", "!*image"], set()),
        (["/?/image"], {"/a/image", "/b/image"}),
        (["/imu"], set()),
    ],
)
def test_patterns(patterns: list[str], expected: set[str]) -> None:
    matcher = Patterns(patterns)
    topics = ("/clock", "/imu/data", "/a/image", "/b/image")
    assert {topic for topic in topics if matcher.match(topic)} == expected


@pytest.mark.parametrize("pattern", ["re:(", "", "!"])
def test_a_pattern_that_is_none(pattern: str) -> None:
    with pytest.raises(RecordingError):
        Patterns([pattern])


def test_what_is_not_recorded_is_not_computed(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        with world.record(tmp_path / "imu.mcap", topics=["/imu/*"]):
            world.run(0.5)
            wanted = {p.topic for p in world.graph.publishers() if p.wanted and p.qos != "latched"}
            images = [p for p in world.graph.publishers() if p.topic.endswith("image_raw")]
            assert wanted == {"/imu/data"}
            assert images and all(image.sent == 0 for image in images)
        assert not [p for p in world.graph.publishers() if p.wanted and p.qos != "latched"]
    assert set(read_with_mcap(tmp_path / "imu.mcap")) == {"/imu/data"}


def test_recording_changes_nothing(tmp_path: Path) -> None:
    def states(file: Path | None) -> list[bytes]:
        with cw.World("post", seed=4) as world:
            cart = world.spawn("rosbots.xacro")
            cart.publish("/part2_cmr/cmd_vel", linear_x=0.5, angular_z=-0.2)
            if file is None:
                world.run(1.5)
            else:
                with world.record(file):
                    world.run(1.5)
            data = world.session.simulation.data
            return [data.qpos.tobytes(), data.qvel.tobytes()]

    assert states(None) == states(tmp_path / "a.mcap")


def test_a_pattern_without_topics_is_reported(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        with world.record(tmp_path / "a.mcap", topics=["/clok", "/clock"]):
            world.run(0.1)
        (warning,) = (d for d in world.diagnostics if d.severity == "warning")
        assert (warning.code, warning.values) == (TOPIC_PATTERN_UNMATCHED, {"pattern": "/clok"})


def test_a_robot_that_comes_later_is_recorded_from_its_first_message_on(tmp_path: Path) -> None:
    path = tmp_path / "late.mcap"
    with cw.World("empty") as world, world.record(path):
        world.run(0.5)
        world.spawn("rosbots.xacro")
        world.run(0.5)
    found = read_with_mcap(path)
    assert [t for t, _ in found["/imu/data"]][:2] == [500_000_000, 535_000_000]
    assert len(found["/imu/data"]) == 16
    ((described, _),) = found["/robot_description"]
    # New robots are found at 10 Hz; the message follows in the next step with messages.
    assert 500_000_000 <= described <= 610_000_000


def test_a_reset_begins_a_new_file_that_stands_alone(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        with world.record(tmp_path / "a.mcap", topics=["/clock", "/tf_static"]) as recorder:
            world.run(0.5)
            world.reset()
            world.run(0.3)
            world.reset()
            world.run(0.1)
    assert recorder.summary.files == tuple(tmp_path / f"a{n}.mcap" for n in ("", "_1", "_2"))
    for name, count in (("a", 51), ("a_1", 31), ("a_2", 11)):
        found = read_with_mcap(tmp_path / f"{name}.mcap")
        assert [t for t, _ in found["/clock"]] == [i * 10_000_000 for i in range(count)]
        assert len(found["/tf_static"]) == 1


def test_a_reset_overwrites_nothing(tmp_path: Path) -> None:
    (tmp_path / "a_1.mcap").write_text("mine")
    with cw.World("empty") as world, world.record(tmp_path / "a.mcap"):
        world.run(0.1)
        world.reset()
        world.run(0.1)
    assert (tmp_path / "a_1.mcap").read_text() == "mine"
    assert len(read_with_mcap(tmp_path / "a_2.mcap")["/clock"]) == 11


# -- places


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("drive.avi", RECORDING_NAME_INVALID),
        ("nowhere/drive.mcap", RECORDING_NOT_WRITABLE),
        ("there.mcap", RECORDING_EXISTS),
        ("folder", RECORDING_EXISTS),
    ],
)
def test_a_place_that_takes_no_recording(tmp_path: Path, name: str, code: Code) -> None:
    (tmp_path / "there.mcap").write_text("mine")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "letter.txt").write_text("mine")
    with (
        cw.World("empty") as world,
        raises(code, RecordingError),
        world.record(tmp_path / name),
    ):
        pass
    assert (tmp_path / "there.mcap").read_text() == "mine"


@pytest.mark.parametrize("overwrite", [False, True])
def test_a_recording_without_a_name(tmp_path: Path, monkeypatch: Any, overwrite: bool) -> None:
    monkeypatch.chdir(tmp_path)
    with (
        cw.World("empty") as world,
        raises(RECORDING_NAME_INVALID, name=""),
        world.record("", overwrite=overwrite),
    ):
        pass


def test_overwriting_takes_recordings_alone(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "letter.txt").write_text("mine")
    with cw.World("empty") as world:
        with (
            raises(RECORDING_NOT_WRITABLE),
            world.record(tmp_path / "folder", overwrite=True),
        ):
            pass
        for name in NAMES:
            for seconds in (0.2, 0.1):
                with world.record(tmp_path / name, topics=["/clock"], overwrite=True):
                    world.run(seconds)
            assert len(read_with_rosbags(tmp_path / name)["/clock"]) == 10
    assert (tmp_path / "folder" / "letter.txt").read_text() == "mine"


@pytest.mark.parametrize(
    ("name", "encoding"), [("a.bag", "ros2"), ("a.db3", "ros1"), ("a", "ros1")]
)
def test_an_encoding_that_a_form_cannot_hold(tmp_path: Path, name: str, encoding: Any) -> None:
    with (
        cw.World("empty") as world,
        raises(ENCODING_UNFIT),
        world.record(tmp_path / name, encoding=encoding),
    ):
        pass
    assert not (tmp_path / name).exists()


def test_a_file_that_the_system_refuses(tmp_path: Path) -> None:
    with (
        cw.World("empty") as world,
        raises(RECORDING_NOT_WRITABLE),
        world.record("/proc/drive.mcap"),
    ):
        pass


# -- hardship


def test_a_slow_disk_holds_the_simulation_and_loses_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = Backlog.get

    def slow(self: Backlog, timeout: float) -> list[Any]:
        time.sleep(0.02)
        return real(self, timeout)

    defaults = Backlog.__init__.__kwdefaults__
    assert defaults["room"] == ROOM
    monkeypatch.setattr(Backlog, "get", slow)
    monkeypatch.setattr(Backlog.__init__, "__kwdefaults__", defaults | {"count": 5})
    path = tmp_path / "slow.mcap"
    with cw.World("empty") as world:
        with world.record(path, topics=["/clock"]) as recorder:
            world.run(5.0)
        slow_disk = coded(world.diagnostics, DISK_SLOW)
    assert [t for t, _ in read_with_mcap(path)["/clock"]] == [i * 10_000_000 for i in range(501)]
    # At most five wait, so there were at least a hundred turns of 20 ms.
    assert recorder.summary.waited > 1.0
    assert len(slow_disk) == 1


def test_a_backlog_counts_bytes() -> None:
    backlog = Backlog(room=3000)
    put = [0]

    def fill() -> None:
        for number in range(10):
            backlog.put(number, 5 * number, bytes(1000))
            put[0] += 1

    thread = threading.Thread(target=fill)
    thread.start()
    taken: list[int] = []
    while len(taken) < 10:
        items = backlog.get(10.0)
        assert 0 < len(items) <= 3 * WIDTH
        taken += items[0::WIDTH]
        assert items[1::WIDTH] == [5 * number for number in items[0::WIDTH]]
        backlog.done(items[2::WIDTH])
    thread.join(120)
    assert put == [10]
    assert taken == list(range(10))


def test_a_backlog_loses_nothing_between_two_threads() -> None:
    """The two threads share a list without a lock, and switch often."""
    backlog, count = Backlog(room=1 << 20, count=500), 50_000
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    try:
        thread = threading.Thread(
            target=lambda: [backlog.put(i % 7, i, str(i).encode()) for i in range(count)]
        )
        thread.start()
        taken: list[Any] = []
        while len(taken) < count * WIDTH:
            items = backlog.get(10.0)
            assert items and len(items) <= 501 * WIDTH
            taken += items
            backlog.done(items[2::WIDTH])
        thread.join(120)
    finally:
        sys.setswitchinterval(interval)
    assert taken == [each for i in range(count) for each in (i % 7, i, str(i).encode())]


def test_a_closed_backlog_takes_nothing() -> None:
    backlog = Backlog()
    backlog.put(1, 2, b"3")
    backlog.close()
    backlog.put(4, 5, b"6")
    assert backlog.get(0.0) == [1, 2, b"3"]
    assert backlog.get(0.0) == []
    assert not backlog.is_open


def test_a_message_that_cannot_be_encoded_costs_itself_alone(tmp_path: Path) -> None:
    graph = Graph()
    reports: list[Diagnostic] = []
    recorder = Recorder(graph, tmp_path / "a.bag", time_ns=lambda: 5, report=reports.append)
    publisher = graph.advertise("/a", "std_msgs/msg/UInt8")
    made = message_class("std_msgs/msg/UInt8")
    recorder.start()
    for value in (1, 4000, 2):
        publisher.publish(made(value))
    assert recorder.close().messages == 2
    assert read_with_rosbags(tmp_path / "a.bag") == {"/a": [(5, b"\1"), (5, b"\2")]}
    assert len(reports) == 1 and coded(reports, MESSAGE_NOT_RECORDED, topic="/a")


def test_a_message_that_is_changed_and_published_again(tmp_path: Path) -> None:
    """Its bytes are those of each time it was published, by either way."""
    with cw.World("empty") as world:
        publisher = world.advertise("/a", "std_msgs/msg/UInt8")
        message = world.message_class("std_msgs/msg/UInt8")(0)
        with world.record(tmp_path / "a.mcap", topics="/a"):
            for number in range(1, 6):
                message.data = number
                publisher.publish(message)
            for number in range(6, 11):
                message.data = number
                world.publish("/a", message)
                world.run(0.01)
    found = read_with_mcap(tmp_path / "a.mcap")["/a"]
    assert [data[-1] for _, data in found] == list(range(1, 11))


_RUN = ["run", "--headless", "--speed", "max", "--for", "100000", "--record"]


@pytest.mark.parametrize("name", NAMES)
def test_a_kill_leaves_all_but_the_last_second(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    process = launching.Popen(
        # Fast enough to write much within a second, and slow enough to leave the processors idle.
        [PROGRAM, *_RUN, str(path), "--record-topics", "!*image*", "--speed", "20"],
        stdout=subprocess.DEVNULL,
    )
    try:
        deadline = time.monotonic() + 120
        file = path / "drive_0.mcap" if name == "drive" else path
        while not _holds_much(file):
            assert time.monotonic() < deadline and process.poll() is None
            time.sleep(0.01)
        # What is kept is what was there a second ago.
        time.sleep(random.uniform(1.5, 3.0))
    finally:
        # Its recorder first: where the run alone is killed, that completes the file.
        for pid in (*bridges_of(process), process.pid):
            os.kill(pid, signal.SIGKILL)
        process.wait()
    times = [t for t, _ in _read_broken(name, path)["/clock"]]
    assert len(times) > 100
    assert times == [max(i * 10_000_000, int(name == "drive.bag")) for i in range(len(times))]


@pytest.mark.parametrize("name", NAMES)
def test_a_recorder_that_is_killed_early_has_the_beginning(name: str, tmp_path: Path) -> None:
    """As soon as it has handed on anything; the run says so and ends."""
    path = tmp_path / name
    process = launching.Popen(
        [PROGRAM, "run", "--headless", "--record", str(path), "--record-topics", "/clock"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        deadline = time.monotonic() + 120
        times: list[int] = []
        while not times:
            assert time.monotonic() < deadline and process.poll() is None
            time.sleep(0.01)
            times = _times_so_far(path)
        (recorder,) = bridges_of(process)
        os.kill(recorder, signal.SIGKILL)
        _, said = process.communicate(timeout=120)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 2
    assert f"[{BRIDGE_ENDED}]" in said and f"[{RECORDING_BROKE_OFF}]" in said
    kept = [t for t, _ in _read_broken(name, path)["/clock"]]
    assert len(kept) >= len(times)
    assert kept == [max(i * 10_000_000, int(name == "drive.bag")) for i in range(len(kept))]


_DELAY = """
import sys
if "recording" in sys.argv:
    import time
    from cartwheel.bridges.recording.recorder import Recorder
    start = Recorder.start
    Recorder.start = lambda self: (time.sleep(2.0), start(self))[1]
"""


@pytest.mark.parametrize("name", NAMES)
def test_a_run_waits_until_its_recorder_is_ready(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its process takes 2 s longer than usual: time begins after that, and nothing is missed."""
    (tmp_path / "sitecustomize.py").write_text(_DELAY)
    paths = (str(tmp_path), os.environ.get("PYTHONPATH", ""))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(path for path in paths if path))
    run_program(
        *("run", "--headless", "--speed", "max", "--for", "1"),
        *("--record", name, "--record-topics", "/clock"),
        folder=tmp_path,
    )
    found = read_with_rosbags(tmp_path / name)
    first = int(name == "drive.bag")
    assert [t for t, _ in found["/clock"]] == [max(i * 10_000_000, first) for i in range(100)]


@pytest.mark.parametrize(
    ("name", "module", "function"),
    [("a.mcap", ros2, "message_class"), ("a.bag", ros1_writing, "_flat")],
)
def test_definitions_are_made_before_the_first_message(
    name: str, module: Any, function: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On the thread that writes they would hold up what is to be written in the first second."""
    ros2.ros2_definition.cache_clear()
    ros1_writing._plan.cache_clear()
    real = getattr(module, function)
    threads: set[str] = set()

    def make(*arguments: Any) -> Any:
        threads.add(threading.current_thread().name)
        return real(*arguments)

    monkeypatch.setattr(module, function, make)
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        with world.record(tmp_path / name, topics=["/odom", "/joint_states", "/tf"]):
            assert threads == {"MainThread"}
            world.run(0.1)
    assert threads == {"MainThread"}


def _times_so_far(path: Path) -> list[int]:
    """Of the messages in a file that is being written; reading it changes nothing."""
    try:
        recording = open_recording(path)
    except RecordingError:
        return []  # it is not there, or has just begun
    try:
        return [message.time_ns for message in recording.messages()]
    finally:
        recording.close()


def _holds_much(file: Path) -> bool:
    """Whether a file that is being written would keep more than a second if that ended now."""
    if file.suffix != ".db3":
        return file.exists() and file.stat().st_size > 200_000
    # Its empty tables are as large as that.
    return len(_times_so_far(file)) > 2000


def _read_broken(name: str, path: Path) -> Found:
    """What others read of a file without its end."""
    found: Found = defaultdict(list)
    if name == "drive.bag":
        if not HAS_ROSBAG:
            pytest.skip("Debian's python3-rosbag is not installed")
        launching.run(["rosbag", "reindex", str(path)], check=True, capture_output=True)
        for topic, rows in read_with_debian(path).items():
            found[topic] = [(time_ns, b"") for time_ns, _, _ in rows]
    elif name == "drive.db3":
        base = sqlite3.connect(path)
        for topic, time_ns in base.execute(
            "SELECT name, timestamp FROM messages JOIN topics ON topics.id = topic_id"
        ):
            found[topic].append((time_ns, b""))
    else:
        if name == "drive":
            assert "drive_0.mcap" in (path / "metadata.yaml").read_text()
            path /= "drive_0.mcap"
        # As a stream: it ends where the file does.
        reader = NonSeekingReader(io.BytesIO(path.read_bytes()))
        try:
            for _, channel, message in reader.iter_messages(log_time_order=False):
                found[channel.topic].append((message.log_time, b""))
        except Exception as error:  # noqa: BLE001
            assert "end" in f"{type(error).__name__} {error}".lower()
    return found


@pytest.mark.wording
@pytest.mark.parametrize("name", NAMES)
def test_a_full_disk_ends_the_run_and_keeps_what_was_written(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    # The first transaction of a database is larger than what the others need.
    limit = 4_000_000 if name == "drive.db3" else 1_000_000
    script = (
        "import os, resource, sys\n"
        f"resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))\n"
        "os.execv(sys.argv[1], sys.argv[1:])\n"
    )
    run = launching.run(
        [sys.executable, "-c", script, str(PROGRAM), *_RUN, str(path), "--record-topics",
         "/clock /odom /imu/data"],
        capture_output=True, text=True, timeout=240, check=False,
    )  # fmt: skip
    assert run.returncode == 2, run.stderr
    assert "Traceback" not in run.stderr
    assert str(path) in run.stderr
    (reported,) = re.findall(r"stopped at ([\d.]+) s", run.stderr)
    found = read_with_rosbags(path) if name != "drive.db3" else _read_broken(name, path)
    times = [t for t, _ in found["/clock"]]
    assert len(times) > 100
    assert times == [max(i * 10_000_000, int(name == "drive.bag")) for i in range(len(times))]
    # Whatever else was published at that time.
    assert max(t for each in found.values() for t, _ in each) / 1e9 == pytest.approx(
        float(reported)
    )


def test_a_write_that_fails_leaves_no_part_of_itself(tmp_path: Path) -> None:
    sink = Sink(tmp_path / "a")
    sink.write(b"whole")

    class Full(io.RawIOBase):
        """Takes three bytes more."""

        def write(self, data: Any) -> int:
            os.write(number, bytes(data[:3]))
            self.write = self._refuse  # type: ignore[method-assign]
            return 3

        def _refuse(self, _: Any) -> int:
            raise OSError(28, "No space left on device")

        def truncate(self, size: int | None = None) -> int:
            os.ftruncate(number, size or 0)
            return size or 0

        def seek(self, place: int, _: int = 0) -> int:
            return os.lseek(number, place, 0)

    number = os.open(tmp_path / "a", os.O_WRONLY | os.O_APPEND)
    sink._file = Full()  # type: ignore[assignment]
    with pytest.raises(OSError, match="No space"):
        sink.write(b"never complete")
    os.close(number)
    assert (tmp_path / "a").read_bytes() == b"whole"
    assert sink.position == 5


@pytest.mark.parametrize(
    ("name", "limit"),
    [
        *itertools.product(["drive.mcap", "drive.bag"], range(30_000, 60_000, 1_500)),
        # Its file is made as that of drive.mcap, and it takes 0.7 s to read.
        *(("drive", limit) for limit in range(31_500, 60_000, 7_500)),
    ],
)
def test_room_for_the_end_is_made_where_the_disk_has_none(
    name: str, limit: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wherever the disk is full, the file is complete: the last chunk gives way to the end."""
    write = Sink.write

    def limited(sink: Sink, data: bytes) -> None:
        if sink.position + len(data) > limit:
            raise OSError(28, "No space left on device")
        write(sink, data)

    monkeypatch.setattr(Sink, "write", limited)
    path = tmp_path / name
    wanted = encoding_for(path, None)
    writer = open_writer(path, wanted, overwrite=False, notes={})
    channels = [writer.add(f"/t{i}", "std_msgs/msg/String", latched=False) for i in range(20)]
    noise = random.Random(limit)
    step = 0
    with pytest.raises(OSError, match="No space"):
        while True:
            step += 1
            text = noise.randbytes(40).hex()
            message = message_class("std_msgs/msg/String")(data=text)
            data = encode_ros1(message) if wanted == "ros1" else encode_cdr(message)
            writer.write([channels[step % 20]], [step * 10**6], [data])
            if step % 25 == 0:
                writer.flush()
    writer.abandon()
    found = read_with_rosbags(tmp_path / name)
    times = sorted(t for each in found.values() for t, _ in each)
    assert times == [i * 10**6 for i in range(1, len(times) + 1)]
    assert len(times) > step / 2
    assert writer.kept_ns == times[-1]
    if name == "drive":
        about = (tmp_path / name / "metadata.yaml").read_text()
        assert f"message_count: {len(times)}\n" in about


# -- the command


def run_program(*arguments: str, folder: Path, status: int = 0) -> str:
    done = launching.run(
        [PROGRAM, *arguments], cwd=folder, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == status, done.stderr
    assert "Traceback" not in done.stderr
    return done.stdout if status == 0 else done.stderr


def test_the_command_records_and_says_so(tmp_path: Path) -> None:
    said = run_program(
        *("run", "--headless", "--speed", "max", "--for", "2"),
        *("--record", "a.mcap", "--record-topics", "/clock", "--record-topics", "/odom"),
        folder=tmp_path,
    )
    assert "recorded 400 messages on 2 topics" in said
    assert {t: len(m) for t, m in read_with_mcap(tmp_path / "a.mcap").items()} == {
        "/clock": 200,
        "/odom": 200,
    }


@pytest.mark.parametrize(
    ("options", "code"),
    [
        (["--record", "a.mp4"], RECORDING_NAME_INVALID),
        (["--record", "there.bag"], RECORDING_EXISTS),
        (["--record", "a.mcap", "--record-encoding", "ros3"], OPTION_INVALID),
        (["--record", "a.mcap", "--record-topics", "re:("], TOPIC_PATTERN_INVALID),
    ],
)
def test_the_command_refuses(options: list[str], code: Code, tmp_path: Path) -> None:
    (tmp_path / "there.bag").write_text("mine")
    said = run_program("run", "--headless", "--for", "1", *options, folder=tmp_path, status=2)
    assert f"[{code}]" in said


def test_ctrl_c_completes_the_file(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    process = launching.Popen(
        [PROGRAM, "run", "--headless", "--speed", "max", "--record", str(path)],
        stdout=subprocess.PIPE,
        text=True,
    )
    deadline = time.monotonic() + 120
    while not path.exists() or path.stat().st_size < 50_000:
        assert time.monotonic() < deadline and process.poll() is None
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert process.returncode == 0
    with path.open("rb") as file:
        summary = make_reader(file, validate_crcs=True).get_summary()
    assert summary is not None and summary.statistics is not None
    found = read_with_mcap(path)
    assert summary.statistics.message_count == sum(map(len, found.values()))
    assert [t for t, _ in found["/clock"]] == [i * 10_000_000 for i in range(len(found["/clock"]))]


def test_an_error_in_the_block_is_not_lost(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        with pytest.raises(ZeroDivisionError), world.record(tmp_path / "a.mcap"):
            world.run(0.1)
            raise ZeroDivisionError
        assert len(read_with_mcap(tmp_path / "a.mcap")["/clock"]) == 11


@pytest.mark.parametrize("name", ["a.mcap", "a.bag", "a.db3", "a"])
def test_of_two_that_begin_at_once_one_records(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The second one looks before the first has begun.
    monkeypatch.setattr(writing, "check_writable", lambda *_, **__: None)
    path = tmp_path / name
    with cw.World("empty") as world, cw.World("empty") as other:
        with world.record(path, topics=["/clock"]):
            world.run(0.1)
            with raises(RECORDING_EXISTS), other.record(path):
                pytest.fail("it began")
            world.run(0.1)
        assert len(read_with_rosbags(path)["/clock"]) == 21


@pytest.mark.parametrize("name", ["a.mcap", "a.bag", "a"])
def test_what_is_being_recorded_is_not_replaced(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    with cw.World("empty") as world, cw.World("empty") as other:
        with world.record(path, topics=["/clock"]):
            world.run(0.1)
            refused = other.record(path, overwrite=True)
            with raises(RECORDING_EXISTS, recording=True), refused:
                pytest.fail("it began")
            world.run(0.1)
        assert len(read_with_rosbags(path)["/clock"]) == 21
        with other.record(path, topics=["/clock"], overwrite=True):
            other.run(0.1)
        assert len(read_with_rosbags(path)["/clock"]) == 11


def test_a_link_is_replaced_and_not_what_it_points_to(tmp_path: Path) -> None:
    precious = tmp_path / "precious.mcap"
    precious.write_bytes(b"as it was")
    path = tmp_path / "a.mcap"
    path.symlink_to(precious)
    with cw.World("empty") as world, world.record(path, topics=["/clock"], overwrite=True):
        world.run(0.1)
    assert precious.read_bytes() == b"as it was"
    assert len(read_with_rosbags(path)["/clock"]) == 11


def test_a_run_is_recorded_in_several_forms_at_once(tmp_path: Path) -> None:
    names = ("a b.mcap", "a.bag", "a.db3", "a")
    words = [word for name in names for word in ("--record", name)]
    launching.run(
        [PROGRAM, "run", "--headless", "--speed", "max", "--for", "1", *words,
         "--record-topics", "/clock /odom"],
        cwd=tmp_path, check=True, stdout=subprocess.DEVNULL, timeout=300,
    )  # fmt: skip
    for name in names:
        found = read_with_rosbags(tmp_path / name)
        assert {topic: len(messages) for topic, messages in found.items()} == {
            "/clock": 100,
            "/odom": 100,
        }


def test_one_file_for_two_recordings_is_refused(tmp_path: Path) -> None:
    done = launching.run(
        [PROGRAM, "run", "--headless", "--record", "a.mcap", "--record", "./a.mcap"],
        cwd=tmp_path, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    assert f"[{OPTIONS_CONFLICT}]" in done.stderr
    assert not list(tmp_path.iterdir())
