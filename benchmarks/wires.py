"""The bridges, one by one and all at once: their cost, and the latency of messages.

A simulation of the cart publishes images of 640x480 at 30 Hz, and odometry, transforms and IMU at
100 Hz. Each bridge has one subscriber, in another process.
"""

from __future__ import annotations

import importlib.util
import json
import os
import shutil
import statistics
import subprocess
import sys
from collections.abc import Iterator, Sequence
from typing import Any

from benchmarks.figure import Effort, Figure
from benchmarks.wire_readers import IMAGE

_SLOWER = 10.0
"""Goal: the largest loss of speed with all bridges, for a simulation at full speed, %."""
_TITLES = {
    "ros1": "ROS 1",
    "ros2": "ROS 2 over DDS",
    "zenoh": "ROS 2 over Zenoh",
    "foxglove": "Foxglove",
    "record": "recording",
}
_PORT = 11732
"""Port of the ROS 1 master that the benchmark starts."""


def figures(effort: Effort) -> Iterator[Figure]:
    """Each installed bridge alone, and all that can run together."""
    wires = ["ros2", "record"]
    if shutil.which("rosmaster"):
        wires.insert(0, "ros1")
    if importlib.util.find_spec("foxglove"):
        wires.insert(-1, "foxglove")
    pairs = max(1, effort.rounds // 2)
    # Briefly, the run with all of them tries each.
    for wire in wires if effort.every == 1 else ():
        yield from _of(_TITLES[wire], [wire], pairs, effort.turn)
    if importlib.util.find_spec("zenoh"):
        yield from _of(_TITLES["zenoh"], ["zenoh"], pairs, effort.turn)
    # A simulation cannot use DDS and Zenoh at the same time.
    title = f"at once: {', '.join(_TITLES[wire] for wire in wires)}"
    yield from _of(title, wires, pairs, effort.turn, all_=True)


def _of(
    group: str, wires: Sequence[str], pairs: int, turn: float, *, all_: bool = False
) -> Iterator[Figure]:
    found = _measured(wires, pairs, turn)
    group = f"wires, {group}"
    yield Figure(
        group=group,
        name="CPU",
        value=100 * statistics.median(loud[0] - quiet[0] for quiet, loud in found["real"]),
        unit="% of a core",
        note="of the simulation and the bridges, minus that of messages within the process",
    )
    for wire, ages in found["ages"].items():
        title = f", {_TITLES[wire]}" if all_ else ""
        for name, part in (
            ("image", ages[IMAGE]),
            ("others", [age for topic, some in ages.items() if topic != IMAGE for age in some]),
        ):
            if not part:  # on a busy machine, a short run may receive none
                continue
            part.sort()
            yield Figure(
                group=group,
                name=f"{name}{title}",
                value=part[len(part) // 2],
                unit="ms latency",
                note=f"99 % within {part[int(len(part) * 0.99)]:.1f} ms; {len(part)} messages",
            )
    ratio = statistics.median(loud[1] / quiet[1] for quiet, loud in found["full"])
    whole = statistics.median(loud[2] / quiet[2] for quiet, loud in found["full"])
    alone = statistics.median(quiet[1] for quiet, _ in found["full"])
    yield Figure(
        group=group,
        name="full speed",
        value=100 * ratio,
        unit="% of the speed without",
        goal=100 - _SLOWER if all_ else None,
        better="more",
        note=f"without: {alone:.0f} x real time; {100 * whole:.0f} % including waits for a core",
    )


def _measured(wires: Sequence[str], pairs: int, turn: float) -> dict[str, Any]:
    environment = {"ROS_MASTER_URI": f"http://127.0.0.1:{_PORT}", "ROS_HOSTNAME": "127.0.0.1"}
    done = subprocess.run(
        [
            *(sys.executable, "-m", "benchmarks.wire_load", *wires),
            *("--pairs", str(pairs), "--turn", str(turn)),
        ],
        env={"ROS_DOMAIN_ID": "183", **os.environ, **environment},
        stdout=subprocess.PIPE,
        check=True,
        text=True,
    )
    found: dict[str, Any] = json.loads(done.stdout)
    return found
