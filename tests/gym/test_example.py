"""The example that learns, without the library that trains it."""

from __future__ import annotations

import importlib
import math
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("gymnasium")

EXAMPLES = Path(__file__).parents[2] / "examples" / "learning"


@pytest.fixture
def reach(monkeypatch):
    monkeypatch.syspath_prepend(str(EXAMPLES))
    return importlib.import_module("reach")


def test_a_simple_driver_reaches_most_goals_and_chance_does_not(reach):
    """It turns to the goal, and away from what is near."""

    def drive(values):
        scan, (_, cos, sin) = values["/scan"], values["goal"]
        turn = 2.0 * math.atan2(sin, cos)
        # Ray 12 of 24 points ahead, and the ranges go on to the left.
        left, right = scan[12:17].min(), scan[7:12].min()
        if min(left, right) < 0.6:
            turn = 1.5 if left > right else -1.5
        speed = 0.15 if min(left, right) < 0.5 else 0.4 * max(0.0, cos)
        return np.array([speed, np.clip(turn, -1.5, 1.5)], np.float32)

    random = np.random.default_rng(0)
    task = reach.task()
    assert reach.successes(task, drive, episodes=20) >= 0.5
    chance = reach.successes(task, lambda _: random.uniform([0, -1.5], [0.6, 1.5]), episodes=20)
    assert chance <= 0.3
