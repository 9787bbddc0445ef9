"""Batches of driving robots on MuJoCo Warp, compared with the same batches on MuJoCo.

On a GPU if there is one, and otherwise on Warp's CPU device, which the figures name.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Iterator

import numpy as np

import cartwheel as cw
from benchmarks.batch import POSES
from benchmarks.figure import Effort, Figure, paired
from benchmarks.published import command_topic, with_laser
from cartwheel.batch import Batch, Observations

_PERIOD = 0.1
"""s."""
_STEP = 0.005
"""s."""
_SPEED, _TURN = 0.2, 0.3
"""m/s and rad/s."""
_ON_GPU, _ON_CPU = (256, 1024, 4096), (8,)
"""Numbers of worlds."""


def figures(effort: Effort) -> Iterator[Figure]:
    """The speed of batches on MuJoCo Warp; nothing if it is not installed."""
    try:
        import mujoco_warp  # noqa: F401
        import warp
    except ImportError as error:
        print(f"no figures of MuJoCo Warp: {error}", file=sys.stderr)
        return
    on_gpu = warp.is_cuda_available()
    device = "cuda:0" if on_gpu else "cpu"
    name = warp.get_device(device).name if on_gpu else "Warp's CPU device, no GPU"
    robot, title = with_laser()
    built = cw.build("empty", [{"robot": robot, "name": "robot"}])
    with built.world() as world:
        act = {command_topic(world): ["linear.x", "angular.z"]}
    odometry: Observations = {"/odom": ["pose.pose.position.x", "twist.twist.linear.x"]}
    for count in _ON_GPU if on_gpu else _ON_CPU:
        for what, obs in (("poses", POSES), ("odometry", odometry)):
            with (
                Batch(built, count, act=act, obs=obs, period=_PERIOD, workers=0) as other,
                Batch(
                    built, count, act=act, obs=obs, period=_PERIOD, backend="warp", device=device
                ) as batch,
            ):
                ratio, seconds = _measured(batch, other, effort)
            group = f"Warp batch of {title}s on {name}"
            yield Figure(
                group=group, name=f"{count} worlds, {what} observed", value=1 / ratio,
                unit="times as fast", better="more",
                note="wall time, relative to MuJoCo in one process",
            )  # fmt: skip
            yield Figure(
                group=group, name=f"{count} worlds, {what} observed, speed",
                value=count * _PERIOD / _STEP / seconds, unit="steps of worlds per s",
                better="more",
            )  # fmt: skip


def _measured(batch: Batch, other: Batch, effort: Effort) -> tuple[float, float]:
    """The wall time of a batch relative to another, and its time for a period, s."""
    actions = np.tile([_SPEED, _TURN], (batch.n, 1))
    count = max(1, round(effort.seconds / 2 / _PERIOD))
    for each in (batch, other):
        each.reset()
        each.step(actions)
    rounds = min(effort.rounds, 5)
    ratio, seconds = paired(
        rounds, functools.partial(_run, batch, count, actions),
        functools.partial(_run, other, count, actions), wall=True,
    )  # fmt: skip
    return ratio, ratio * seconds / count


def _run(batch: Batch, count: int, actions: np.ndarray) -> None:
    for _ in range(count):
        batch.step(actions)
