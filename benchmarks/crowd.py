"""Robots with lasers and crowds of carts in one world, compared in pairs with MuJoCo alone."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Iterator, Sequence

import numpy as np

import cartwheel as cw
from benchmarks.carts import READ, Bare, Listener, driving
from benchmarks.figure import Effort, Figure, paired
from benchmarks.published import command_topic, with_laser, with_two_lasers
from benchmarks.sensors import carrying, scanner
from cartwheel.description.model import RobotDescription

_GROUP = "all topics subscribed, CPU time relative to MuJoCo alone"
_SCAN = "sensor_msgs/msg/LaserScan"
_RUN = 0.5
"""Simulation time between two commands, s; those of the MiR expire after this time."""
_MOVES = 0.05
"""Velocity of a wheel or of a robot that drives, rad/s or m/s."""


def figures(effort: Effort) -> Iterator[Figure]:
    """One robot with its lasers, twenty carts that are read, and a hundred carts with lasers."""
    robot, name = with_laser()
    yield _robot(robot, f"{name} with a laser", 2.0, effort)
    mir = with_two_lasers()
    if mir is not None:
        yield _robot(mir, "MiR with two scanners", 4.0, effort)
    count = min(20, 2 * max(effort.carts))
    with driving(count) as world:
        listener = Listener(world, READ)
        yield _compared(world, f"{count} carts, odometry, tf, joint states and IMU", 1.9, effort,
                        world.run, seconds=effort.seconds / count)  # fmt: skip
        assert listener.count
    yield _many(min(100, 5 * max(effort.carts)), effort)


def _robot(robot: RobotDescription, name: str, goal: float, effort: Effort) -> Figure:
    with cw.World("walls", lenient=True) as world:
        world.spawn(robot, name="robot", controllers="auto")
        scans = [topic.name for topic in world.graph.topics() if topic.type == _SCAN]
        listener = Listener(world, tuple(scans))
        _run(world, 2.0)
        found = _compared(
            world, name, goal, effort, functools.partial(_run, world), seconds=effort.seconds / 4
        )
        assert listener.count >= len(scans) > 0
    return found


def _run(world: cw.World, seconds: float) -> None:
    """Drives a robot."""
    for _ in range(round(seconds / _RUN) or 1):
        world.publish(command_topic(world), linear_x=0.1, angular_z=0.4)
        world.run(min(_RUN, seconds))


def _compared(
    world: cw.World, name: str, goal: float, effort: Effort, run: Callable[[float], None],
    *, seconds: float,
) -> Figure:  # fmt: skip
    bare = Bare(world)
    alone = functools.partial(bare.step, seconds)
    ratio, base = paired(effort.rounds, functools.partial(run, seconds), alone)
    # A robot that stands still takes less time.
    assert np.abs(bare.data.qvel).max() > _MOVES, "MuJoCo alone did not drive"
    step = base / seconds * bare.model.opt.timestep
    return Figure(
        group=_GROUP, name=name, value=ratio, unit="ratio", goal=goal,
        note=f"MuJoCo alone: {step * 1e6:.0f} us per step",
    )  # fmt: skip


def _many(count: int, effort: Effort) -> Figure:
    """Carts in rows, each with a laser of 360 rays at 5 Hz that is read."""
    cart = carrying(scanner(columns=360, rate=5.0, reach=3.5))
    with cw.World("empty") as world:
        _spawn(world, cart, count)
        listener = Listener(world, tuple(f"/cart_{index}/scan" for index in range(count)))
        for index in range(count):
            world.publish(f"/cart_{index}/part2_cmr/cmd_vel", linear_x=0.3, angular_z=0.3)
        world.run(0.5)
        seconds = effort.seconds / 4
        times: Sequence[float] = [_wall(world, seconds) for _ in range(min(5, effort.rounds))]
        assert listener.count >= count
    return Figure(
        group="a laser on each cart, all subscribed", name=f"{count} carts in one world",
        value=seconds / sorted(times)[len(times) // 2], unit="x real time", goal=1.0, better="more",
    )  # fmt: skip


def _spawn(world: cw.World, cart: RobotDescription, count: int) -> None:
    with world.spawning():
        for index in range(count):
            world.spawn(
                cart,
                name=f"cart_{index}",
                namespace=f"cart_{index}",
                x=4.0 * (index % 10),
                y=4.0 * (index // 10),
            )


def _wall(world: cw.World, seconds: float) -> float:
    start = time.perf_counter()
    world.run(seconds)
    return time.perf_counter() - start
