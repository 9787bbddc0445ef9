"""Simulations without subscribers, compared with MuJoCo alone: the cart and published robots."""

from __future__ import annotations

import contextlib
import gc
import statistics
import time
from collections.abc import Callable, Iterator
from functools import partial

import cartwheel as cw
from benchmarks.carts import Bare, driving
from benchmarks.figure import Effort, Figure
from benchmarks.published import BURGER, TWIST, corpus
from cartwheel.corpus import robots_in
from cartwheel.description import load_robot
from cartwheel.dialects.ros_control.suggestion import suggested
from cartwheel.errors import CartwheelError
from cartwheel.simulation.clock import to_ns

_RATIO, _ADDED_US = 1.35, 6.0
"""The goal is the larger of this multiple of MuJoCo alone, and this time added to it."""
_SLOW = 1e-3
"""Time of a step above which a robot is left out, s: what Cartwheel adds cannot be measured."""
_RUN = 0.2
"""Simulation time between two commands, s; commands can expire."""


def figures(effort: Effort) -> Iterator[Figure]:
    """The cart, and each robot of the folder of published robots that can be loaded."""
    with driving() as world:
        yield _measured("cart", world, effort)
    folder = corpus()
    if folder is None:
        return
    # Briefly, one: to look which files of the folder are robots takes seconds.
    for file in robots_in(folder) if effort.every == 1 else [folder / BURGER]:
        with contextlib.suppress(CartwheelError), cw.World(lenient=True) as world:
            robot = load_robot(file)
            world.spawn(robot, controllers=suggested(robot))
            _drive(world)
            world.run(2.0)
            if _seconds(partial(world.run, 0.1)) / _steps(world, 0.1) < _SLOW:
                yield _measured(str(file.relative_to(folder)), world, effort)


def _measured(name: str, world: cw.World, effort: Effort) -> Figure:
    """The median ratio of the CPU times of pairs, measured in turn.

    Each time is the sum of several short runs, because a command expires within a long one. The
    costs of the command and of the call of `World.run` are left out.
    """
    simulation = world.session.simulation
    step = simulation.step_ns / 1e9
    seconds = min(_RUN, effort.seconds)
    runs = round(effort.seconds / 4 / seconds) or 1
    ratios, added, base = [], [], []
    for index in range(effort.rounds):
        gc.collect()
        _drive(world)
        world.run(seconds)
        bare = Bare(world)
        took = {"ours": 0.0, "alone": 0.0}
        for way in sorted(took, reverse=bool(index % 2)):
            for _ in range(runs):
                if way == "ours":
                    _drive(world)
                    world.run(step)
                    end = simulation.time_ns + to_ns(seconds)
                    took[way] += _seconds(partial(simulation.advance, end))
                else:
                    bare.step(step)
                    took[way] += _seconds(partial(bare.step, seconds))
        ratios.append(took["ours"] / took["alone"])
        steps = _steps(world, seconds) * runs
        added.append((took["ours"] - took["alone"]) / steps * 1e6)
        base.append(took["alone"] / steps * 1e6)
    ratio, more = statistics.median(ratios), statistics.median(added)
    return Figure(
        group="without subscribers, CPU time",
        name=name,
        value=ratio,
        unit="ratio",
        goal=max(_RATIO, 1.0 + _ADDED_US / statistics.median(base)),
        note=f"{more:+.1f} us per step",
    )


def _drive(world: cw.World) -> None:
    """Commands all bases, because commands can expire."""
    for topic in world.graph.topics():
        if topic.subscribers and topic.type == TWIST:
            world.publish(topic.name, linear_x=0.3, angular_z=0.2)


def _steps(world: cw.World, seconds: float) -> int:
    return round(seconds * 1e9 / world.session.simulation.step_ns)


def _seconds(way: Callable[[], object]) -> float:
    start = time.process_time()
    way()
    return time.process_time() - start
