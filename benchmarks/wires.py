"""Each wire alone, and all at once: what they cost, and how late messages come.

Images of 640x480 at 30 Hz, and odometry, transforms and IMU at 100 Hz, from a simulation of the
cart to one reader of each wire, which is another process.
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
"""% that a simulation at full speed may lose to all wires."""
_TITLES = {
    "ros1": "ROS 1",
    "ros2": "ROS 2 over DDS",
    "zenoh": "ROS 2 over Zenoh",
    "foxglove": "Foxglove",
    "record": "recording",
}
_PORT = 11732
"""Of the ROS 1 master that is started for this."""


def figures(effort: Effort) -> Iterator[Figure]:
    """Those that are installed, one by one, and all that may run together."""
    wires = ["ros2", "record"]
    if shutil.which("rosmaster"):
        wires.insert(0, "ros1")
    if importlib.util.find_spec("foxglove"):
        wires.insert(-1, "foxglove")
    pairs = max(1, effort.rounds // 2)
    for wire in wires:
        yield from _of(_TITLES[wire], [wire], pairs)
    if importlib.util.find_spec("zenoh"):
        yield from _of(_TITLES["zenoh"], ["zenoh"], pairs)
    # Over DDS and Zenoh at once no simulation can be.
    yield from _of(
        f"at once: {', '.join(_TITLES[wire] for wire in wires)}", wires, pairs, all_=True
    )


def _of(group: str, wires: Sequence[str], pairs: int, *, all_: bool = False) -> Iterator[Figure]:
    found = _measured(wires, pairs)
    group = f"wires, {group}"
    yield Figure(
        group=group,
        name="CPU",
        value=100 * statistics.median(loud[0] - quiet[0] for quiet, loud in found["real"]),
        unit="% of a core",
        note="of the simulation and the bridges, beyond that of messages that stay in it",
    )
    for wire, ages in found["ages"].items():
        title = f", {_TITLES[wire]}" if all_ else ""
        for name, part in (
            ("image", ages[IMAGE]),
            ("others", [age for topic, some in ages.items() if topic != IMAGE for age in some]),
        ):
            if not part:  # a reader of a short run on a busy machine may have had no time for it
                continue
            part.sort()
            yield Figure(
                group=group,
                name=f"{name}{title}",
                value=part[len(part) // 2],
                unit="ms late",
                note=f"99 % within {part[int(len(part) * 0.99)]:.1f} ms; {len(part)} messages",
            )
    ratio = statistics.median(loud[1] / quiet[1] for quiet, loud in found["full"])
    whole = statistics.median(loud[2] / quiet[2] for quiet, loud in found["full"])
    alone = statistics.median(quiet[1] for quiet, _ in found["full"])
    yield Figure(
        group=group,
        name="full speed",
        value=100 * ratio,
        unit="% of that without",
        goal=100 - _SLOWER if all_ else None,
        better="more",
        note=f"which is {alone:.0f} times real time; {100 * whole:.0f} with the waits for a core",
    )


def _measured(wires: Sequence[str], pairs: int) -> dict[str, Any]:
    environment = {"ROS_MASTER_URI": f"http://127.0.0.1:{_PORT}", "ROS_HOSTNAME": "127.0.0.1"}
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.wire_load", *wires, "--pairs", str(pairs)],
        env={"ROS_DOMAIN_ID": "183", **os.environ, **environment},
        stdout=subprocess.PIPE,
        check=True,
        text=True,
    )
    found: dict[str, Any] = json.loads(done.stdout)
    return found
