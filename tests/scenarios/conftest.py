"""Scenarios from texts, and their outcomes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from cartwheel.scenarios import Options, Outcome, Runner, cases_of, digests, load_scenario
from cartwheel.scenarios.cases import Scenario

CART = "robots: [{robot: rosbots.xacro, name: cart}]\n"
DRIVE = "/part2_cmr/cmd_vel"


@pytest.fixture
def scenario(tmp_path: Path) -> Callable[..., Scenario]:
    """Loads a text."""

    def load(text: str, name: str = "test.yaml") -> Scenario:
        path = tmp_path / name
        path.write_text(text)
        return load_scenario(path)

    return load


@pytest.fixture
def run(scenario, tmp_path: Path) -> Callable[..., Outcome]:
    """Runs the only case of a text."""

    def run(text: str, **options: Any) -> Outcome:
        loaded = scenario(text)
        (case,) = digests(loaded, cases_of(loaded))
        given = {"record": "none", "pictures": "none", **options}
        return Runner([loaded], Options(folder=tmp_path / "out", **given)).run(case)

    return run
