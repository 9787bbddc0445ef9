"""Sweeps on a Ray cluster: the same table, also if the program or a computer is lost."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path

import pytest
from tests.coded import raises
from tests.sweeps.duties import drive, waiting
from tests.sweeps.listening import descendants, listening

import cartwheel as cw
from cartwheel.codes.wires import PACKAGE_MISSING
from cartwheel.codes.world import CLUSTER_UNUSABLE, SWEEP_INVALID

# Imported only when the tests run, because each process of a run of all tests imports this file.
pytestmark = pytest.mark.skipif(
    find_spec("ray") is None, reason="Ray has no packages for this version of Python"
)
ROOT = Path(__file__).parents[2]
ROBOTS = ROOT / "robots" / "rosbots_description"
# Without it, Ray uses another interface for a cluster whose computers are all this one.
LOOPBACK = {**os.environ, "RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0", "RAY_USAGE_STATS_ENABLED": "0"}
PATIENCE = 480


def start(module, *words, **options):
    command = [sys.executable, "-m", f"tests.sweeps.{module}", *words]
    return subprocess.Popen(
        command, cwd=ROOT, env=LOOPBACK, stdout=subprocess.PIPE, text=True, **options
    )


def study(robots, *sweeps):
    plan = {"robots": [str(each) for each in robots], "sweeps": sweeps}
    return start("study", json.dumps(plan))


def tables(process):
    text, _ = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0
    return [json.loads(line) for line in text.splitlines()]


def wait_for(condition):
    end = time.monotonic() + PATIENCE
    while not (found := condition()):
        assert time.monotonic() < end
        time.sleep(0.05)
    return found


def running(pid):
    """Whether a process exists and has not ended."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.fixture(scope="module")
def cluster():
    process = start("two_nodes", stdin=subprocess.PIPE)
    try:
        yield process.stdout.readline().strip(), process
        process.communicate(timeout=PATIENCE)
    finally:
        process.kill()


def test_the_table_is_the_same_on_a_cluster(cluster, built, gyro, tmp_path):
    cases = [{"speed": speed, "seed": seed} for speed in (0.2, 0.6) for seed in (0, 1)]
    log = str(tmp_path / "log")
    robot = shutil.copytree(ROBOTS, tmp_path / "rosbots_description")
    described = robot / "urdf" / "rosbots.xacro"
    images = {"function": "without_files", "cases": [{
        "folder": str(robot), "topic": "/rosbots/camera1/image_raw",
    }]}  # fmt: skip
    bad = [{"n": 2, "log": log, "how": how, "seed": 7} for how in ("raise", "exit")]
    slow = {**bad[0], "how": "sleep", "log": log + ".slow"}
    sweeps = [
        {"function": "drive", "cases": cases},
        {"function": "counted", "cases": bad, "results": str(tmp_path / "bad.jsonl")},
        {"function": "counted", "cases": [slow], "timeout": 0.5},
        images,
    ]
    address, _ = cluster
    process = study([described, gyro], *[{**each, "cluster": address} for each in sweeps])
    good, failed, late, seen = tables(process)
    assert good == cw.sweep(drive, cases, built, jobs=0).columns()
    assert failed["seed"] == [7, 7] and late["seed"] == [7]
    assert "no luck" in failed["error"][0] and "3 times" in failed["error"][1]
    assert "0.5 s" in late["error"][0]
    # An error of the function is its result; a process that ends may have been ended.
    assert len(Path(log).read_text().split()) == 1 + 3
    # On a busy computer, its time may pass before it starts. It is not repeated.
    calls = Path(slow["log"])
    assert not calls.exists() or len(calls.read_text().split()) == 1
    rows = [json.loads(line) for line in (tmp_path / "bad.jsonl").read_text().splitlines()[1:]]
    assert sorted(row["case"]["how"] for row in rows) == ["exit", "raise"]
    assert not robot.exists() and seen["error"] == [""] and seen["result"][0] > 10


def test_a_lost_program_and_a_lost_computer_lose_no_case(cluster, built, gyro, tmp_path):
    address, nodes = cluster
    cases = [{"n": n, "folder": str(tmp_path)} for n in range(6)]
    results, starts = tmp_path / "results.jsonl", tmp_path / "starts"
    sweep = {"function": "waiting", "cases": cases, "cluster": address, "results": str(results)}
    robots = ["rosbots.xacro", gyro]

    def begun(count):
        lines = starts.read_text().split("\n")[:-1] if starts.exists() else []
        return [line.split() for line in lines] if len(lines) >= count else None

    first = study(robots, sweep)
    ids = [int(pid) for _, pid in wait_for(lambda: begun(4))]
    first.kill()
    first.wait()
    first.stdout.close()
    wait_for(lambda: not any(map(running, ids)))
    assert len(results.read_text().splitlines()) == 3

    second = study(robots, sweep)
    again = wait_for(lambda: begun(6))[4:]
    nodes.stdin.write("0\n")
    nodes.stdin.flush()
    assert nodes.stdout.readline() == "killed\n"
    lost, *others = wait_for(lambda: [n for n, pid in again if not running(pid)])
    assert not others
    (tmp_path / "go").touch()
    (table,) = tables(second)
    assert table == cw.sweep(waiting, cases, built, jobs=0).columns()
    counts = [[n for n, _ in begun(0)].count(str(n)) for n in range(6)]
    # The table in this process has started each once more. Those of the first program are done.
    assert counts[:2] == [2, 2] and counts[int(lost)] == 4
    assert sum(counts) == 6 + 4 + 6 - 2 + 1


def test_a_cluster_for_the_sweep_is_private_and_ends_with_it(gyro, tmp_path):
    starts = tmp_path / "starts"
    cases = [{"n": 5, "folder": str(tmp_path)}] * 2
    sweep = {"function": "waiting", "cases": cases, "cluster": "local", "jobs": 1}
    folders = set(Path("/tmp").glob("cw-ray-*"))
    process = study(["rosbots.xacro", gyro], sweep)
    wait_for(starts.exists)
    started = descendants(process.pid)
    places = {place for pid in (process.pid, *started) for place in listening(pid)}
    assert places and places <= {"127.0.0.1", "::ffff:127.0.0.1"}
    server = [pid for pid in started if "gcs_server" in Path(f"/proc/{pid}/comm").read_text()]
    settings = Path(f"/proc/{server[0]}/environ").read_text().split("\0")
    assert "RAY_USAGE_STATS_ENABLED=0" in settings
    assert any(each.startswith("RAY_AUTH_TOKEN=") for each in settings)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=PATIENCE)
    assert process.returncode != 0
    wait_for(lambda: not any(map(running, started)))
    assert set(Path("/tmp").glob("cw-ray-*")) <= folders


def test_a_cluster_that_cannot_be_used_is_an_error(built, monkeypatch):
    for address in ("127.0.0.1:1", "nowhere"):
        with raises(CLUSTER_UNUSABLE):
            cw.sweep(drive, [{"speed": 1.0}], built, cluster=address)
    with raises(SWEEP_INVALID):
        cw.sweep(drive, [{"speed": 1.0}], built, cluster="auto", jobs=0)
    monkeypatch.setitem(sys.modules, "ray", None)
    with raises(PACKAGE_MISSING, package="ray"):
        cw.sweep(drive, [{"speed": 1.0}], built, cluster="auto")
