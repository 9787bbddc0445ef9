"""A node on Cyclone DDS beside the simulation, as rmw_cyclonedds makes them."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.bridges.ros2_peers import DOMAIN, Ros2Bridged
from tests.bridges.test_ros2_actions import spawn_arm
from tests.bridges.test_ros2_services import prepared

PEER = Path(__file__).with_name("cyclone_peer.py")

pytestmark = [
    pytest.mark.skipif(
        importlib.util.find_spec("cyclonedds") is None, reason="not installed: cyclonedds"
    ),
    pytest.mark.timeout(600),
]


def reported(client: str, domain: int, seconds: float) -> dict[str, list[str]]:
    """What the peer prints: words by the first word of the line."""
    done = subprocess.run(
        [sys.executable, PEER, client, str(domain)],
        capture_output=True,
        text=True,
        timeout=seconds,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return {line.split()[0]: line.split()[1:] for line in done.stdout.splitlines()}


@pytest.fixture
def bridged(monkeypatch: pytest.MonkeyPatch) -> Iterator[Ros2Bridged]:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN + 2))
    made = Ros2Bridged(prepare=prepared)
    yield made
    made.close()


def test_it_reads_drives_spawns_and_resets(bridged: Ros2Bridged) -> None:
    said = reported("cart", DOMAIN + 2, 500)
    assert said["spawn"][0] == "True", said
    assert "crate" in bridged.simulation.models
    count, x = said["odometry"]
    assert int(count) > 200
    assert float(x) > 0.5
    assert int(said["tf"][0]) > 200
    assert said["tf"][1] == "base_footprint"
    assert int(said["clock"][0]) > 200
    assert int(said["images"][0]) > 20
    width, height, size = map(int, said["images"][1:])
    assert size == width * height * 3
    assert said["reset"] == ["True"]
    pose = bridged.simulation.call(lambda: bridged.simulation.pose("rosbots")).result()
    assert abs(pose.position[0]) < 0.2


def test_it_sends_goals_and_cancels_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN + 6))
    bridged = Ros2Bridged(robot=False, prepare=spawn_arm(tmp_path))
    try:
        said = reported("grip", DOMAIN + 6, 400)
    finally:
        bridged.close()
    assert said["goal"] == ["True"], said
    succeeded, position, reached = said["result"]
    assert (succeeded, reached) == ("True", "True")
    assert float(position) == pytest.approx(0.3, abs=0.011)
    # A second and a half at 20 Hz; a busy computer gets fewer.
    assert int(said["feedback"][0]) > 5
    assert said["cancel"] == ["True"]
    assert said["second"] == ["True"]
