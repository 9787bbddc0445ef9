"""The publish rate of a topic."""

from __future__ import annotations

import time
from collections import deque
from itertools import pairwise

from cartwheel.cli.commands.clients import connect
from cartwheel.cli.commands.topics import ends_quietly
from cartwheel.cli.console import note, say

_INTERVAL = 1.0
"""s of wall time between two reports."""


def measure(sim: str | None, topic: str, *, count: int | None, window: int) -> None:
    """Reports the rate once a second, in the layout of ``rostopic hz``.

    The rate is measured in simulation time, so it does not depend on the speed of the simulation.
    The rate in wall time is printed after it.
    """
    stamps: deque[int] = deque(maxlen=window)
    walls: deque[float] = deque(maxlen=window)
    reports = 0
    with (
        connect(sim) as client,
        client.subscribe(topic, data=False, queue=10_000) as subscription,
        ends_quietly(count),
    ):
        note(f"subscribed to {subscription.topic}; press Ctrl-C to stop")
        due = time.monotonic() + _INTERVAL
        while count is None or reports < count:
            try:
                sample = subscription.get(max(0.01, due - time.monotonic()))
            except TimeoutError:
                sample = None
            else:
                if sample is None:
                    note("the simulation has ended")
                    return
                if stamps and sample.time_ns < stamps[-1]:
                    note("time jumped back: the simulation was reset")
                    stamps.clear()
                    walls.clear()
                stamps.append(sample.time_ns)
                walls.append(time.monotonic())
            if time.monotonic() >= due:
                due += _INTERVAL
                reports += 1
                say(report(list(stamps), list(walls)))


def report(stamps: list[int], walls: list[float]) -> str:
    """The report as two lines.

    Args:
        stamps: Simulation times of the messages, in ns.
        walls: Wall times at which they arrived, in s.
    """
    if len(stamps) < 2:
        return "no new messages"
    gaps = [(later - sooner) / 1e9 for sooner, later in pairwise(stamps)]
    mean = sum(gaps) / len(gaps)
    deviation = (sum((gap - mean) ** 2 for gap in gaps) / len(gaps)) ** 0.5
    wall = (walls[-1] - walls[0]) / (len(walls) - 1)
    rate = (
        f"{1 / mean:.3f}"
        if mean > 0
        else ("infinite, because all messages have the same timestamp")
    )
    lines = f"average rate: {rate}"
    if wall > 0:
        lines += f" (wall time: {1 / wall:.3f})"
    return (
        f"{lines}\n\tmin: {min(gaps):.3f}s max: {max(gaps):.3f}s "
        f"std dev: {deviation:.5f}s window: {len(stamps)}"
    )
