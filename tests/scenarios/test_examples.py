"""The scenarios in ``examples/scenarios`` pass."""

from __future__ import annotations

from pathlib import Path

import pytest

from cartwheel.scenarios import Options, Runner, cases_of, digests, load_scenario

FOLDER = Path(__file__).parents[2] / "examples" / "scenarios"
FILES = [path for path in sorted(FOLDER.glob("*.yaml")) if not path.stem.startswith("lockstep")]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_an_example_passes(path, tmp_path):
    scenario = load_scenario(path)
    runner = Runner([scenario], Options(folder=tmp_path, record="none", pictures="none"))
    for case in digests(scenario, cases_of(scenario)):
        outcome = runner.run(case)
        assert outcome.status == "passed", outcome.findings[0].text


def test_there_are_eight_examples_without_ros():
    assert len(FILES) >= 8
