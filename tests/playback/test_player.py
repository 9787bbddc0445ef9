"""Recordings that are played: the same messages, at their times, from any place on."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests import launching
from tests.bridges.test_recording_reading import COUNT, WRITERS
from tests.coded import raises

import cartwheel as cw
from cartwheel.bridges.recording.opening import open_recording
from cartwheel.codes.command import RECORDING_UNFINISHED
from cartwheel.codes.recording import PLAYBACK_READ_ONLY, RECORDING_EMPTY
from cartwheel.description import load_robot, load_world
from cartwheel.geometry import Pose
from cartwheel.messages import encode_cdr
from cartwheel.playback import PlaybackSession
from cartwheel.simulation.snapshot import RunState

PROGRAM = Path(sys.executable).with_name("cartwheel")
NAMES = ["drive.mcap", "drive.bag", "drive.db3", "drive"]
SECONDS = 3.0


class Drive:
    """A cart that drove in a circle, recorded, and what it was like on the way."""

    def __init__(self, path: Path) -> None:
        self.path = path
        seen: dict[str, list[tuple[int, bytes]]] = defaultdict(list)
        self.snapshots: dict[int, Any] = {}
        with cw.World("empty") as world:
            cart = world.spawn("rosbots.xacro")
            simulation = world.session.simulation
            least = 1 if path.suffix == ".bag" else 0

            def keep(name: str) -> Callable[[Any], None]:
                return lambda message: seen[name].append(
                    (max(simulation.time_ns, least), encode_cdr(message))
                )

            def look(_: Any) -> None:
                self.snapshots[simulation.time_ns] = simulation.snapshot()

            with world.record(path):
                for topic in world.graph.topics():
                    world.graph.subscribe(topic.name, keep(topic.name))
                world.graph.subscribe("/tf", look)
                cart.publish("/part2_cmr/cmd_vel", linear_x=0.5, angular_z=0.6)
                world.run(SECONDS)
                self.seen = {name: list(found) for name, found in seen.items() if found}


@pytest.fixture(scope="module")
def drives(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[[str], Drive]]:
    folder = tmp_path_factory.mktemp("drives")
    made: dict[str, Drive] = {}

    def drive(name: str) -> Drive:
        if name not in made:
            made[name] = Drive(folder / name)
        return made[name]

    yield drive


def opened(drive: Drive, **options: Any) -> PlaybackSession:
    return PlaybackSession(open_recording(drive.path), **options)


@pytest.mark.parametrize("name", NAMES)
def test_what_is_played_is_what_was_recorded(name: str, drives: Callable[[str], Drive]) -> None:
    drive = drives(name)
    session = opened(drive, hold=False)
    player = session.simulation
    found: dict[str, list[tuple[int, bytes]]] = defaultdict(list)

    def keep(topic: str) -> Callable[[Any], None]:
        return lambda message: found[topic].append((player.time_ns, encode_cdr(message)))

    for topic in session.graph.topics():
        session.graph.subscribe(topic.name, keep(topic.name))
    player.drain()
    latched = {t.name for t in session.graph.topics() if t.qos == "latched"}
    player.reset()
    player.set_speed(None)
    for messages in found.values():
        messages.clear()
    player.seek(player.start_ns)
    player.run()
    assert set(found) == set(drive.seen) > latched
    for topic, messages in drive.seen.items():
        if topic in latched:
            # Said at the start, and when its time comes.
            assert messages[-1][1] == found[topic][-1][1]
        else:
            assert found[topic] == messages, topic


@pytest.mark.parametrize("name", ["drive.mcap", "drive.bag"])
def test_the_robot_is_where_it_was(name: str, drives: Callable[[str], Drive]) -> None:
    drive = drives(name)
    session = opened(drive)
    player = session.simulation
    assert player.models == ("rosbots",)
    for place in (2_500_000_000, 400_000_000, 1_730_000_000):
        player.seek(place)
        shown = player.snapshot()
        was = drive.snapshots[place]
        rows = [i for i, (model, _) in enumerate(was.scene.links) if model == "rosbots"]
        assert shown.scene.links == tuple(was.scene.links[i] for i in rows)
        # The scene's root is odom, where the cart began; its wheels slip a little on the way.
        assert np.allclose(shown.positions, was.positions[rows], atol=0.03)
        dots = np.abs((shown.quaternions * was.quaternions[rows]).sum(axis=1))
        # Odometry's angle is off by a few degrees at most, and each wheel's turn is measured.
        assert (dots > np.cos(np.radians(3))).all(), dots


def test_a_jump_says_again_what_was_said_last(drives: Callable[[str], Drive]) -> None:
    drive = drives("drive.mcap")
    session = opened(drive)
    player = session.simulation
    player.pause()
    found: dict[str, list[bytes]] = defaultdict(list)
    for topic in ("/imu/data", "/rosbots/camera1/image_raw"):
        session.graph.subscribe(topic, lambda m, t=topic: found[t].append(encode_cdr(m)))
    player.seek(2_010_000_000)
    for topic, messages in found.items():
        assert messages == [[data for t, data in drive.seen[topic] if t <= 2_010_000_000][-1]]
    assert set(found) == {"/imu/data", "/rosbots/camera1/image_raw"}
    assert player.time_ns == 2_010_000_000


def test_nothing_is_decoded_that_nobody_reads(
    drives: Callable[[str], Drive], monkeypatch: pytest.MonkeyPatch
) -> None:
    from cartwheel.playback import player as module

    decoded: set[str] = set()
    real = module.decoder

    def watched(topic: Any) -> Any:
        decode = real(topic)

        def note(data: bytes) -> Any:
            decoded.add(topic.name)
            return decode(data)

        return note

    monkeypatch.setattr(module, "decoder", watched)
    session = opened(drives("drive.mcap"), hold=False)
    session.simulation.set_speed(None)
    session.simulation.run()
    assert "/tf" in decoded and "/robot_description" in decoded
    assert not {"/odom", "/imu/data", "/clock", "/rosbots/camera1/image_raw"} & decoded


def test_pause_step_end_and_loop(drives: Callable[[str], Drive]) -> None:
    session = opened(drives("drive.mcap"), loop=False, hold=True)
    player = session.simulation
    thread = threading.Thread(target=player.run)
    thread.start()
    try:
        player.call(player.pause).result(120)
        begin = player.call(lambda: player.time_ns).result(120)
        player.call(lambda: player.step(3)).result(120)
        assert player.call(lambda: player.time_ns).result(120) == begin + 3 * player.step_ns
        player.call(lambda: player.set_speed(None)).result(120)
        player.call(player.resume).result(120)
        deadline = time.monotonic() + 120
        while player.run_state is not RunState.PAUSED:
            assert time.monotonic() < deadline
            time.sleep(0.01)
        assert player.time_ns == player.end_ns
        player.call(lambda: player.set_speed(1.0)).result(120)
        player.call(player.resume).result(120)
        assert player.call(lambda: player.time_ns).result(120) < player.end_ns
    finally:
        player.post(player.stop)
        thread.join(120)
    assert not thread.is_alive()


def test_it_keeps_to_its_speed(drives: Callable[[str], Drive]) -> None:
    session = opened(drives("drive.mcap"), hold=False)
    session.simulation.set_speed(2.0)
    begin = time.monotonic()
    session.simulation.run()
    assert time.monotonic() - begin > (SECONDS - 0.05) / 2


def test_a_world_around_the_robot(drives: Callable[[str], Drive]) -> None:
    session = opened(drives("drive.mcap"), world=load_world("post"))
    names = session.simulation.models
    assert "rosbots" in names and "post" in names
    snapshot = session.simulation.snapshot()
    row = next(i for i, (model, _) in enumerate(snapshot.scene.links) if model == "post")
    wanted = next(m.pose for m in load_world("post").models if m.name == "post")
    assert np.allclose(snapshot.positions[row][:2], wanted.position[:2], atol=1e-9)


def test_an_empty_recording_is_reported(tmp_path: Path) -> None:
    with cw.World("empty") as world, world.record(tmp_path / "a.mcap", topics=["/nothing"]):
        world.run(0.1)
    with raises(RECORDING_EMPTY):
        PlaybackSession(open_recording(tmp_path / "a.mcap"))


def test_clients_reach_it(drives: Callable[[str], Drive], tmp_path: Path) -> None:
    process = launching.Popen(
        [PROGRAM, "play", drives("drive.mcap").path, "--headless", "--loop"],
        stdout=subprocess.PIPE,
        text=True,
    )

    def command(*words: str) -> str:
        done = launching.run(
            [PROGRAM, *words, "--sim", str(process.pid)],
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        assert "Traceback" not in done.stderr
        return done.stdout + done.stderr

    try:
        assert process.stdout is not None
        assert "playing" in process.stdout.readline()
        assert "frame_id" in command("topic", "echo", "-n", "1", "/imu/data")
        assert "rosbots" in command("models")
        assert f"[{PLAYBACK_READ_ONLY}]" in command("delete", "rosbots")
    finally:
        process.terminate()
        process.wait(120)
    assert process.returncode == 0


@pytest.mark.parametrize("name", ["bz2.bag", "sqlite8", "bare.mcap"])
def test_what_others_recorded_is_played_with_types_of_their_own(name: str, tmp_path: Path) -> None:
    WRITERS[name](tmp_path / name)
    session = PlaybackSession(open_recording(tmp_path / name), hold=False)
    found: list[str] = []
    session.graph.subscribe("/gauge", lambda message: found.append(message.label.data))
    session.simulation.set_speed(None)
    session.simulation.run()
    assert found == [f"n{i}" for i in range(COUNT)]
    assert session.simulation.snapshot().positions.shape == (0, 3)


def test_two_robots_are_distinguished(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        description = load_robot("rosbots.xacro")
        for name, y in (("left", 1.0), ("right", -1.0)):
            world.session.spawn(
                description,
                name=name,
                pose=cw.Pose((0.0, y, 0.0)),
                namespace=name,
                frame_prefix=name,
            )
        with world.record(tmp_path / "a.mcap", topics=["!*image*"]):
            world.publish("/left/part2_cmr/cmd_vel", linear_x=0.5)
            world.run(2.0)
    session = PlaybackSession(open_recording(tmp_path / "a.mcap"))
    player = session.simulation
    assert set(player.models) == {"left", "right"}
    player.seek(1_990_000_000)
    # It speeds up with 1 m/s² for half a second.
    ahead = player.pose("left").x - player.pose("right").x
    assert ahead == pytest.approx(0.5 * 1.99 - 0.125, abs=0.03)
    assert player.pose("left").y - player.pose("right").y == pytest.approx(2.0, abs=0.02)


def test_an_incomplete_recording_is_played_with_a_warning(
    drives: Callable[[str], Drive], tmp_path: Path
) -> None:
    whole = drives("drive.mcap").path.read_bytes()
    for name, content, warned in (("cut", whole[: len(whole) // 2], True), ("whole", whole, False)):
        path = tmp_path / f"{name}.mcap"
        path.write_bytes(content)
        done = launching.run(
            [PROGRAM, "play", path, "--headless", "--speed", "max"],
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        assert (f"[{RECORDING_UNFINISHED}]" in done.stderr) == warned


def test_a_recording_refuses_changes_and_keeps_reports(drives: Callable[[str], Drive]) -> None:
    played = PlaybackSession(open_recording(drives("drive.mcap").path), hold=False)
    player = played.simulation
    for change in (
        lambda: player.set_pose("rosbots", Pose()),
        lambda: player.delete("rosbots"),
        player.occupied,
        played.spawn,
    ):
        with raises(PLAYBACK_READ_ONLY):
            change()
    # A control client's last message that cannot be published is reported this way.
    diagnostic = PLAYBACK_READ_ONLY.diagnostic("a client's final message cannot be published")
    player.report(diagnostic)
    player.drain()
    assert played.diagnostics[-1] is diagnostic
