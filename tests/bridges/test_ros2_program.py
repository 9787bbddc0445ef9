"""``cartwheel run --ros2`` as a user starts it."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests import launching
from tests.bridges.ros1_peers import PROGRAM, wait_for
from tests.bridges.ros2_peers import DOMAIN, REASON, Peer
from tests.bridges.test_recording import read_with_mcap

from cartwheel.codes.command import OPTION_INVALID

pytestmark = pytest.mark.skipif(bool(REASON), reason=REASON)

STRING, TF = "std_msgs/msg/String", "tf2_msgs/msg/TFMessage"
CLOCK = "rosgraph_msgs/msg/Clock"
Start = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def start(tmp_path: object) -> Iterator[Start]:
    started: list[subprocess.Popen[str]] = []

    def run(*arguments: str) -> subprocess.Popen[str]:
        process = launching.Popen(
            [PROGRAM, "run", "--headless", "--ros2", *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "ROS_DOMAIN_ID": str(DOMAIN + 4), "XDG_RUNTIME_DIR": str(tmp_path)},
        )
        started.append(process)
        return process

    yield run
    for process in started:
        process.kill()
        process.communicate()


@pytest.fixture
def peer() -> Iterator[Peer]:
    made = Peer(DOMAIN + 4)
    yield made
    made.close()


def test_the_robot_is_described_and_its_links_placed(start: Start, peer: Peer) -> None:
    process = start()
    peer.subscribe("/robot_description", STRING, transient=True)
    peer.subscribe("/tf", TF)
    peer.subscribe("/tf_static", TF, transient=True)
    peer.subscribe("/clock", CLOCK)
    wait_for(lambda: peer.received("/robot_description"), "the description")
    _, head = peer.received("/robot_description")[0]
    assert b'<robot name="rosbots"' in head

    def frames(topic: str) -> set[str]:
        return {one.child_frame_id for each in peer.messages(topic, TF) for one in each.transforms}

    wait_for(lambda: {"base_footprint"} < frames("/tf"), "odometry's frame and the wheels'")
    wait_for(lambda: "camera_link" in frames("/tf_static"), "the fixed frames")
    assert not frames("/tf") & frames("/tf_static")
    wait_for(lambda: len(peer.received("/clock")) > 10, "the clock")
    process.send_signal(signal.SIGINT)
    out, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors
    assert f"/gazebo on DDS domain {DOMAIN + 4}, visible on this computer" in out
    assert "Traceback" not in errors
    # It takes its leave: nobody needs to wait for its silence.
    wait_for(lambda: ["NO_PARTICIPANT"] in peer.lines, "its farewell", 10.0)


def test_it_makes_way_for_a_robot_state_publisher(start: Start, peer: Peer) -> None:
    start()
    wait_for(lambda: "rt/robot_description" in peer.endpoints("WRITER"), "the description")
    peer.publish("/robot_description", STRING, {"data": "<robot name='another'/>"})

    def gone() -> bool:
        return any(line[:2] == ["NO_WRITER", "rt/robot_description"] for line in peer.lines)

    wait_for(gone, "that it makes way")
    before = len([line for line in peer.lines if line[:2] == ["WRITER", "rt/robot_description"]])
    peer.tell("quiet", "rt/robot_description")
    wait_for(
        lambda: (
            len([line for line in peer.lines if line[:2] == ["WRITER", "rt/robot_description"]])
            > before
        ),
        "that it steps in again",
    )


def test_a_recorded_robot_is_described_once(start: Start, peer: Peer, tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    process = start("--record", str(path), "--record-topics", "/robot_description")
    peer.subscribe("/robot_description", STRING, transient=True)
    peer.subscribe("/clock", CLOCK)
    wait_for(lambda: peer.received("/robot_description"), "the description")
    peer.publish("/robot_description", STRING, {"data": "<robot name='another'/>"})
    wait_for(
        lambda: any(line[:2] == ["NO_WRITER", "rt/robot_description"] for line in peer.lines),
        "that it makes way",
    )
    before = len(peer.received("/clock"))
    wait_for(lambda: len(peer.received("/clock")) > before + 50, "half a second more")
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors
    ours = [head for _, head in peer.received("/robot_description") if b'"rosbots"' in head]
    assert len(ours) == 1
    assert len(read_with_mcap(path)["/robot_description"]) == 1


def test_two_simulations_live_in_one_domain(start: Start, peer: Peer) -> None:
    start()
    start("--ros2-node", "second")
    peer.subscribe("/clock", CLOCK)

    def described() -> int:
        came = sum(line[:2] == ["WRITER", "rt/robot_description"] for line in peer.lines)
        return came - sum(line[:2] == ["NO_WRITER", "rt/robot_description"] for line in peer.lines)

    wait_for(lambda: described() == 2, "both descriptions")
    before = len(peer.received("/clock"))
    wait_for(lambda: len(peer.received("/clock")) > before + 200, "both clocks")
    assert described() == 2
    assert not [line for line in peer.lines if line[0] == "NO_WRITER"]


def test_a_middleware_that_is_none_is_reported(start: Start) -> None:
    process = start("--rmw", "tin_cans", "--for", "1")
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 2
    assert f"[{OPTION_INVALID}]" in errors
