"""The verdict of a load run."""

import json
import os
import subprocess
import sys

from tests.campaign.load import IMAGE, Window, faults_of
from tests.campaign.watching import ROOT

RATES = {"/odom": 100.0, IMAGE: 30.0}


def window(odom: int, image: int, simulated: float = 10.0) -> Window:
    return Window(simulated=simulated, counts={"ros1": {"/odom": odom, IMAGE: image}})


def test_wires_that_deliver_are_well() -> None:
    assert faults_of([window(300, 20), window(990, 200)], RATES) == []


def test_a_wire_that_falls_silent_is_a_fault_also_where_it_comes_back() -> None:
    assert faults_of([window(1000, 300), window(0, 300), window(1000, 300)], RATES) == [
        "ros1: /odom fell silent in window 2"
    ]


def test_a_wire_that_is_slower_at_the_end_is_a_fault() -> None:
    assert faults_of([window(1000, 300), window(850, 80)], RATES) == [
        "ros1: 850 of 1000 messages of /odom at the end",
        f"ros1: 80 of 300 messages of {IMAGE} at the end",
    ]


def test_a_simulation_that_stands_still_is_a_fault() -> None:
    assert faults_of([window(0, 0, 0.0)], RATES) == ["the simulation stood still in window 1"]


def test_a_short_load_run_from_a_shell_without_the_environment() -> None:
    paths = (str(ROOT), str(ROOT / "src"), str(ROOT / "tools"))
    done = subprocess.run(
        [
            *(sys.executable, "-m", "tests.campaign.load", "--minutes", "0"),
            *("--wires", "foxglove", "--busy", "0", "--window", "1"),
        ],
        cwd=ROOT,
        env={**os.environ, "PATH": "/usr/bin:/bin", "PYTHONPATH": os.pathsep.join(paths)},
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )
    verdict = json.loads(done.stdout)
    # Whether a busy machine brings all images in a second is not asked here.
    assert verdict.get("windows") == 1, verdict
    assert verdict["simulated"] > 0
    assert all(rate > 0 for rate in verdict["rates"].values())
