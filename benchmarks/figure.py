"""Results of benchmarks, and the comparison of several variants."""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, kw_only=True, slots=True)
class Figure:
    """One result, with its unit and goal."""

    group: str
    name: str
    value: float
    unit: str
    goal: float | None = None
    better: Literal["less", "more"] = "less"
    note: str = ""

    @property
    def met(self) -> bool | None:
        """Whether the goal is met; None without one."""
        if self.goal is None:
            return None
        return self.value <= self.goal if self.better == "less" else self.value >= self.goal


@dataclass(frozen=True, kw_only=True, slots=True)
class Effort:
    """How long to measure: rounds, simulated time, images, starts and numbers of carts."""

    rounds: int
    seconds: float
    """Simulated time per round, s."""
    images: int
    """Images per round."""
    starts: int
    carts: tuple[int, ...]
    every: int
    """One of so many seeded faults is checked."""
    turn: float
    """Wall time of each run with bridges, s."""


FULL = Effort(rounds=25, seconds=4.0, images=10, starts=5, carts=(1, 5, 10, 20), every=1, turn=1.0)
QUICK = Effort(rounds=2, seconds=0.2, images=1, starts=1, carts=(1, 2), every=20, turn=0.2)


def medians(
    rounds: int, ways: Mapping[str, Callable[[], object]], *, wall: bool = True
) -> dict[str, float]:
    """Median wall time or CPU time of each variant in s. All variants take turns in each round.

    Other programs on the machine slow all variants of a round equally, so ratios are valid on a
    busy machine too. Quote absolute times only from an idle machine.
    """
    clock = time.perf_counter if wall else time.process_time
    times: dict[str, list[float]] = {name: [] for name in ways}
    # Once: it empties the processor's caches, which no program does five times a second.
    gc.collect()
    for way in ways.values():
        way()
    for _ in range(rounds):
        for name, way in ways.items():
            start = clock()
            way()
            times[name].append(clock() - start)
    return {name: statistics.median(samples) for name, samples in times.items()}


def paired(
    rounds: int, ours: Callable[[], object], other: Callable[[], object], *, wall: bool = False
) -> tuple[float, float]:
    """Compares two variants in pairs, which take turns in beginning.

    Args:
        rounds: Number of pairs; one more is run before, and does not count.
        ours: A variant.
        other: The variant to compare it with.
        wall: Measure wall time instead of CPU time.

    Returns:
        The median of the ratios of the pairs, and the median time of `other`, s.
    """
    clock = time.perf_counter if wall else time.process_time
    ways = (ours, other)
    gc.collect()
    for way in ways:
        way()
    ratios, base = [], []
    for index in range(rounds):
        took = [0.0, 0.0]
        for which in (0, 1) if index % 2 else (1, 0):
            start = clock()
            ways[which]()
            took[which] = clock() - start
        ratios.append(took[0] / took[1])
        base.append(took[1])
    return statistics.median(ratios), statistics.median(base)
