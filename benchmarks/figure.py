"""What a benchmark finds, and how two ways of doing one thing are compared."""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, kw_only=True, slots=True)
class Figure:
    """One number."""

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
    """How long to measure."""

    rounds: int
    seconds: float
    """Of simulated time in each round."""
    images: int
    """In each round."""
    starts: int
    carts: tuple[int, ...]


FULL = Effort(rounds=25, seconds=4.0, images=10, starts=5, carts=(1, 5, 10, 20))
QUICK = Effort(rounds=2, seconds=0.2, images=1, starts=1, carts=(1, 2))


def medians(rounds: int, ways: Mapping[str, Callable[[], object]]) -> dict[str, float]:
    """Median wall time in s of each way, all of them in turn in each round.

    Other programs on the machine slow all ways of a round alike, so ratios of one run hold on a
    busy machine too. Times themselves are worth quoting from an idle one.
    """
    times: dict[str, list[float]] = {name: [] for name in ways}
    for way in ways.values():
        way()
    for _ in range(rounds):
        gc.collect()
        for name, way in ways.items():
            start = time.perf_counter()
            way()
            times[name].append(time.perf_counter() - start)
    return {name: statistics.median(found) for name, found in times.items()}
