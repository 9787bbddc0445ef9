"""The CPU time to make worlds with robots, to compile many robots together, and to reset them."""

from __future__ import annotations

import functools
import gc
import os
import pickle
import statistics
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import cartwheel as cw
from benchmarks.figure import Effort, Figure
from cartwheel.description import load_robot
from cartwheel.description.model import RobotDescription

_ROOT = Path(__file__).parents[1]
_PUBLISHED = {
    "burger": "turtlebot3/turtlebot3_description/urdf/turtlebot3_burger.urdf.xacro",
    "waffle": "turtlebot3/turtlebot3_description/urdf/turtlebot3_waffle.urdf.xacro",
    "mir": "mir_robot/mir_description/urdf/mir.urdf.xacro",
    "husky": "husky/husky_description/urdf/husky.urdf.xacro",
    "rrbot": "gazebo_ros_demos/rrbot_description/urdf/rrbot.xacro",
}
_SPACING = 2.0
"""Distance between carts, m."""
_CARTS = 100
_RESETS = 20


def figures(effort: Effort) -> Iterator[Figure]:
    """The cart and some of the published robots, if their folder exists; then many carts."""
    yield from _robot("cart", load_robot("rosbots.xacro"), effort)
    corpus = Path(os.environ.get("CARTWHEEL_CORPUS", _ROOT.parent / "shared" / "corpus"))
    for name, file in list(_PUBLISHED.items())[:: effort.every]:
        if (corpus / file).is_file():
            yield from _robot(name, load_robot(corpus / file), effort)
    yield from _together(_CARTS if effort.every == 1 else 2)


def _robot(name: str, robot: RobotDescription, effort: Effort) -> Iterator[Figure]:
    """A world with one robot: by hand, with its visuals, from `cartwheel.build`, and reset."""
    given: dict[str, Any] = {"robot": robot, "controllers": "auto"}
    built = cw.build("empty", given)

    def by_hand() -> cw.World:
        world = cw.World("empty")
        world.spawn(**given)
        return world

    def seen() -> cw.World:
        world = by_hand()
        world.session.simulation.engine.visuals.current()
        return world

    found = _medians(effort.rounds, {"visuals": seen, "by hand": by_hand, "built": built.world})
    group = f"Making a world with one {name}, CPU time"
    yield Figure(group=group, name="World and spawn", value=1e3 * found["by hand"], unit="ms")
    yield Figure(
        group=group,
        name="the same with visuals",
        value=found["visuals"] / found["by hand"],
        unit="ratio",
    )
    yield Figure(
        group=group,
        name="from cartwheel.build",
        value=1e3 * found["built"],
        unit="ms",
        goal=20,
        note=f"pickled {len(pickle.dumps(built)) / 1e6:.2g} MB",
    )
    with built.world() as world:
        world.run(0.1)

        def resets() -> None:
            for _ in range(_RESETS):
                world.reset()

        state = world.save()

        def saves() -> None:
            for _ in range(_RESETS):
                world.save()

        def restores() -> None:
            for _ in range(_RESETS):
                world.restore(state)

        ways = {"reset": resets, "save": saves, "restore": restores}
        found = _medians(effort.rounds, ways)
    for way, goal in (("reset", 0.5), ("save", 10), ("restore", 10)):
        yield Figure(group=group, name=way, value=1e3 * found[way] / _RESETS, unit="ms", goal=goal)


def _together(count: int) -> Iterator[Figure]:
    """Several carts, each compiled with all earlier ones, or all together."""
    cart = load_robot("rosbots.xacro")

    def spawn(world: cw.World) -> None:
        for index in range(count):
            world.spawn(cart, name=f"cart_{index}", y=_SPACING * index)

    with cw.World("empty") as world:
        one_by_one = _seconds(functools.partial(spawn, world))
    with cw.World("empty") as world:
        start = time.process_time()
        with world.spawning():
            spawn(world)
        together = time.process_time() - start
    group = f"Spawning {count} carts, CPU time"
    yield Figure(group=group, name="one by one", value=one_by_one, unit="s")
    yield Figure(group=group, name="together", value=together, unit="s", goal=2.0)


def _medians(rounds: int, ways: Mapping[str, Callable[[], object]]) -> dict[str, float]:
    """Median CPU time of each way in s; worlds that a way returns are closed."""
    times: dict[str, list[float]] = {name: [] for name in ways}
    for number in range(rounds + 1):
        gc.collect()
        for name, way in ways.items():
            start = time.process_time()
            made = way()
            took = time.process_time() - start
            if isinstance(made, cw.World):
                made.close()
            if number:
                times[name].append(took)
    return {name: statistics.median(each) for name, each in times.items()}


def _seconds(way: Callable[[], object]) -> float:
    start = time.process_time()
    way()
    return time.process_time() - start
