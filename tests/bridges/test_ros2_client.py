"""A node made with ros2-client, on RustDDS, beside the simulation.

Its build needs cargo and takes minutes the first time; it is kept in the user's cache.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.bridges.ros2_peers import DOMAIN, Ros2Bridged
from tests.bridges.test_ros2_actions import spawn_arm
from tests.bridges.test_ros2_services import prepared

SOURCE = Path(__file__).with_name("ros2_client_peer")
CACHE = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "cartwheel-tests"
TARGET = CACHE / "ros2_client"

pytestmark = [
    pytest.mark.skipif(shutil.which("cargo") is None, reason="not installed: cargo"),
    pytest.mark.timeout(1200),
]


def build() -> subprocess.CompletedProcess[str]:
    """Builds the program; a second process waits for the first."""
    return subprocess.run(
        ["cargo", "build", "--quiet", "--locked"],
        cwd=SOURCE,
        env={**os.environ, "CARGO_TARGET_DIR": str(TARGET)},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(scope="module")
def program() -> Path:
    done = build()
    offline = ("Could not resolve host", "failed to download", "failed to get")
    if done.returncode and any(word in done.stderr for word in offline):
        pytest.skip("cargo cannot reach the crates that it needs")
    if done.returncode and "rustc" in done.stderr and "requires" in done.stderr:
        pytest.skip("rustc is too old for ros2-client")
    assert done.returncode == 0, done.stderr
    return TARGET / "debug" / "peer"


@pytest.fixture
def bridged(monkeypatch: pytest.MonkeyPatch) -> Iterator[Ros2Bridged]:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN + 2))
    made = Ros2Bridged(prepare=prepared)
    yield made
    made.close()


def test_it_reads_drives_spawns_and_resets(program: Path, bridged: Ros2Bridged) -> None:
    done = subprocess.run(
        [program, "cart", str(DOMAIN + 2), "cyclone"],
        capture_output=True,
        text=True,
        timeout=400,
        check=True,
    )
    said = {line.split()[0]: line.split()[1:] for line in done.stdout.splitlines()}
    assert said["spawn"][0] == "true", done.stdout
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
    assert said["reset"] == ["true"]
    pose = bridged.simulation.call(lambda: bridged.simulation.pose("rosbots")).result()
    assert abs(pose.position[0]) < 0.2


# How a response names its request: as rmw_cyclonedds does, and as rmw_fastrtps does.
@pytest.mark.parametrize("mapping", ["cyclone", "enhanced"])
def test_it_sends_goals_and_cancels_one(
    program: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mapping: str
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN + 6))
    bridged = Ros2Bridged(robot=False, prepare=spawn_arm(tmp_path))
    try:
        done = subprocess.run(
            [program, "grip", str(DOMAIN + 6), mapping],
            capture_output=True,
            text=True,
            timeout=160,
            check=True,
        )
    finally:
        bridged.close()
    said = {line.split()[0]: line.split()[1:] for line in done.stdout.splitlines()}
    assert said["goal"] == ["true"], done.stdout
    status, position, reached = said["result"]
    assert (status, reached) == ("Succeeded", "true")
    assert float(position) == pytest.approx(0.3, abs=0.011)
    # A second and a half at 20 Hz; a busy computer gets fewer.
    assert int(said["feedback"][0]) > 5
    assert said["cancel"] == ["true"]
    assert said["second"] == ["Canceled"]
