"""Functions of the tests. Other processes import them."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

import cartwheel as cw


def drive(world: cw.World, case: Mapping[str, Any]) -> dict[str, Any]:
    """Drives for a second."""
    imu = world.topic("/gyro")
    world.publish("/part2_cmr/cmd_vel", linear_x=case["speed"])
    world.run(1.0)
    pose = world.model("rosbots").pose
    return {"x": pose.x, "y": pose.y, "rate": imu.latest.angular_velocity.z}


def counted(world: cw.World, case: Mapping[str, Any]) -> float:
    """Notes that it was called, and fails, dies or sleeps if the case says so."""
    with Path(case["log"]).open("a") as file:
        file.write(f"{case['n']}\n")
    if case["n"] == 2 and not Path(case["log"] + ".good").exists():
        {"raise": _fail, "exit": _exit, "sleep": _sleep}[case["how"]]()
    return world.time + case["n"]


def _fail() -> None:
    raise ValueError("no luck")


def _exit() -> None:
    os._exit(5)


def _sleep() -> None:
    time.sleep(600)


def waiting(world: cw.World, case: Mapping[str, Any]) -> dict[str, Any]:
    """Drives; then, from case 2, waits until the file ``go`` exists."""
    folder = Path(case["folder"])
    with (folder / "starts").open("a") as file:
        file.write(f"{case['n']} {os.getpid()}\n")
    found = drive(world, {"speed": 0.1 * case["n"]})
    end = time.monotonic() + 120
    while case["n"] >= 2 and not (folder / "go").exists():
        assert time.monotonic() < end
        time.sleep(0.02)
    return found


def without_files(world: cw.World, case: Mapping[str, Any]) -> float:
    """Deletes the robot's files before the first image; returns the spread of its pixels."""
    shutil.rmtree(case["folder"], ignore_errors=True)
    assert not Path(case["folder"]).exists()
    image = world.topic(case["topic"])
    world.run(0.2)
    return float(np.std(image.array()))
