"""The CPU time of recordings: all small messages of the cart, and the images of its camera."""

from __future__ import annotations

import contextlib
import gc
import statistics
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import cartwheel as cw
from benchmarks.carts import IMAGE, Bare, Listener, driving
from benchmarks.figure import Effort, Figure

_RATE = 30.0
"""Rate of the camera, Hz."""
_LINGER = 0.1
"""Wall time in which a recorder's thread writes the last messages, s."""
_SMALL = "!*camera*"


def figures(effort: Effort) -> Iterator[Figure]:
    """Recordings by ``World.record``, compared with worlds that nobody reads and with MuJoCo."""
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:

        def recorded(name: str, *topics: str) -> cw.World:
            world = stack.enter_context(driving())
            stack.enter_context(world.record(Path(folder) / f"{name}.mcap", topics=topics))
            return world

        unread = stack.enter_context(driving())
        worlds = {"unread": unread, "recorded": recorded("small", _SMALL)}
        seen = stack.enter_context(driving())
        Listener(seen, (IMAGE,))
        images = {"unread": unread, "seen": seen, "recorded": recorded("images", IMAGE)}
        bare = Bare(unread)
        yield from _messages(worlds, bare, effort)
        yield from _images(images, effort)


def _messages(worlds: dict[str, cw.World], bare: Bare, effort: Effort) -> Iterator[Figure]:
    seconds = effort.seconds
    rounds = []
    for _ in range(effort.rounds):
        took = _round(worlds, seconds)
        start = time.process_time()
        bare.step(seconds)
        rounds.append(took | {"bare": time.process_time() - start})
    for name, other, goal in (("recorded", "unread", 2.5), ("recorded", "bare", None)):
        yield Figure(
            group="Recording all messages of one cart except images, CPU time",
            name="time to unread" if other == "unread" else "time to bare loop",
            value=statistics.median(took[name] / took[other] for took in rounds),
            unit="ratio",
            goal=goal,
        )


def _images(worlds: dict[str, cw.World], effort: Effort) -> Iterator[Figure]:
    seconds = 3 * effort.images / _RATE
    rounds = [_round(worlds, seconds) for _ in range(effort.rounds)]
    count = seconds * _RATE
    for name, label in (("seen", "rendered"), ("recorded", "rendered and recorded")):
        added = statistics.median(took[name] - took["unread"] for took in rounds) / count
        yield Figure(
            group="Recording 320 x 240 images at 30 Hz, CPU time for an image",
            name=label,
            value=1e3 * added,
            unit="ms",
        )


def _round(worlds: dict[str, cw.World], seconds: float) -> dict[str, float]:
    """CPU time of each world in turn, s, with the threads of its recorder."""
    gc.collect()
    took = {}
    for name, world in worlds.items():
        start = time.process_time()
        world.run(seconds)
        if name == "recorded":
            time.sleep(_LINGER)
        took[name] = time.process_time() - start
    return took
