"""Batches of driving robots, compared with as many copies of MuJoCo alone."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import cartwheel as cw
from benchmarks.carts import Bare
from benchmarks.figure import Effort, Figure, paired
from benchmarks.published import command_topic, with_laser
from cartwheel.batch import Batch, Observations, PoseOf

_WORLDS, _MANY = 8, 32
_PERIOD = 0.1
"""s."""
POSES: Observations = {"pose": PoseOf("robot", "x", "y", "yaw")}
_SPEED, _TURN = 0.2, 0.3
"""m/s and rad/s."""
_LEAST = 0.8
"""Part of the commanded distance that MuJoCo alone must drive."""


def pose(world: cw.World) -> list[float]:
    """Where the robot is."""
    place = world.model("robot").pose
    return [place.x, place.y, place.yaw]


def figures(effort: Effort) -> Iterator[Figure]:
    """The speed of a batch relative to MuJoCo alone, in one process and in two."""
    robot, title = with_laser()
    built = cw.build("empty", [{"robot": robot, "name": "robot"}])
    with built.world() as world:
        act = {command_topic(world): ["linear.x", "angular.z"]}
    group = f"batch of {_WORLDS} {title}s, relative to MuJoCo alone"
    read: Observations = {"pose": pose}
    odometry: Observations = {"/odom": ["pose.pose.position.x", "twist.twist.linear.x"]}
    for name, obs, goal in (
        ("poses observed", POSES, 0.85),
        ("poses observed by a function", read, None),
        ("odometry observed", odometry, None),
        ("laser of 360 rays at 5 Hz observed", {**POSES, "/scan": "ranges"}, 0.6),
    ):
        with Batch(built, _WORLDS, act=act, obs=obs, period=_PERIOD, workers=0) as batch:
            found = _measured(batch, batch, effort, _run_alone, wall=False)
        yield Figure(
            group=group, name=name, value=1 / found[0], unit="times as fast", goal=goal,
            better="more", note=f"one thread, CPU time; {found[1] * 1e6:.0f} us per period alone",
        )  # fmt: skip
    for count in (_WORLDS, _MANY):
        with (
            Batch(built, count, act=act, obs=POSES, period=_PERIOD, workers=0) as here,
            Batch(built, count, act=act, obs=POSES, period=_PERIOD, workers=1) as batch,
            ThreadPoolExecutor(2) as pool,
        ):
            found = _measured(here, batch, effort, _run_alone, wall=True)
            threads = functools.partial(_run_in_threads, pool)
            shared = _measured(here, batch, effort, threads, wall=True)
        name = f"poses of {count} robots observed, two processes"
        yield Figure(
            group=group, name=name, value=1 / found[0], unit="times as fast", goal=1.7,
            better="more", note="wall time; requires two idle cores",
        )  # fmt: skip
        yield Figure(
            group=group, name=f"{name}, relative to two threads", value=1 / shared[0],
            unit="times as fast", goal=0.85, better="more",
            note="wall time; both use two cores",
        )  # fmt: skip


def _measured(
    here: Batch, batch: Batch, effort: Effort, run: Callable[[Sequence[Bare]], None], *, wall: bool
) -> tuple[float, float]:
    """The time of a batch relative to MuJoCo alone, and that of MuJoCo alone for a period.

    Args:
        here: A batch in this process, whose states MuJoCo alone continues.
        batch: The measured batch.
        effort: How long to measure.
        run: Runs MuJoCo alone for a period.
        wall: Measure wall time instead of CPU time.
    """
    actions = np.tile([_SPEED, _TURN], (batch.n, 1))
    for each in dict.fromkeys((here, batch)):
        each.reset()
        for _ in range(round(2.0 / _PERIOD)):
            each.step(actions)
    alone = [Bare(here.world(index)) for index in range(here.n)]
    count = max(1, round(effort.seconds / 2 / _PERIOD))

    def ours() -> None:
        for _ in range(count):
            batch.step(actions)

    def bare() -> None:
        for _ in range(count):
            run(alone)

    found = paired(effort.rounds, ours, bare, wall=wall)
    _check_driven(alone)
    return found[0], found[1] / count / len(alone)


def _run_alone(alone: Sequence[Bare]) -> None:
    for each in alone:
        each.steps(_PERIOD)


def _run_in_threads(pool: ThreadPoolExecutor, alone: Sequence[Bare]) -> None:
    """Runs half of the copies in each of two threads, which wait for each other."""
    half = len(alone) // 2
    list(pool.map(_run_alone, (alone[:half], alone[half:])))


def _check_driven(alone: list[Bare]) -> None:
    """MuJoCo alone drives as commanded: its robots neither stand still nor sleep."""
    for each in alone:
        start = each.data.qpos[:2].copy()
        each.steps(_PERIOD)
        went = float(np.linalg.norm(each.data.qpos[:2] - start))
        assert went >= _LEAST * _SPEED * _PERIOD, "MuJoCo alone did not drive as commanded"
