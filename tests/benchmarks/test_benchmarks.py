"""The benchmark runs and writes what its readers expect; how fast is not asked here."""

import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from tests import launching

ROOT = Path(__file__).parents[2]
FIELDS = {"group", "name", "value", "unit", "goal", "better", "note", "met"}

PARTS = {
    "headless": "by subscribed topic",
    "unread": "without subscribers",
    "sensors": "among walls",
    "process": "cartwheel run",
    "making": "Making a world",
    "wires": "wires",
    "batch": "batch of",
    "crowd": "a laser on each cart",
    "check": "check: ",
}
"""In the names of a group of each."""


def figures_of(start: Any, module: str, folder: Path, *words: str) -> dict:
    output = folder / "figures.json"
    done = start(
        [sys.executable, "-m", module, *words, "--output", str(output)],
        check=False,
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=570,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(output.read_text())


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict:
    """What all parts give in one process, which has imported them already."""
    folder = tmp_path_factory.mktemp("figures")
    return figures_of(launching.run, "tests.benchmarks.quick", folder, *PARTS)


@pytest.mark.parametrize("part", [part for part in PARTS if part != "check"])
def test_figures_name_themselves_and_are_measured(found: dict, part: str):
    figures = [figure for figure in found["figures"] if PARTS[part] in figure["group"]]
    assert figures
    for figure in figures:
        assert set(figure) == FIELDS
        # The CPU time of a wire is a difference of two, which noise may turn negative.
        is_difference = part == "wires" and figure["name"] == "CPU"
        assert math.isfinite(figure["value"]) and (figure["value"] > 0 or is_difference)
        assert figure["met"] in (None, True, False)


def test_figures_are_of_a_named_machine(found: dict):
    assert {"processor", "cores", "load", "opengl"} <= set(found["machine"])
    assert all(set(figure) == FIELDS for figure in found["figures"])
    assert {"cartwheel", "mujoco", "numpy", "rosbags", "python"} <= set(found["versions"])


def test_every_frame_is_delivered(tmp_path: Path):
    try:
        from mujoco.egl import GLContext

        GLContext(16, 16).free()
    except Exception as error:  # noqa: BLE001 - a missing library shows in many ways
        pytest.skip(f"no OpenGL: {error}")
    # MuJoCo's own renderer, with which it is compared, reads a variable when it is imported.
    found = figures_of(subprocess.run, "benchmarks", tmp_path, "camera", "--quick")
    frames = next(f for f in found["figures"] if f["name"] == "frames delivered")
    # 30 Hz in three runs of 50 ms, and one frame at the start of the first.
    assert frames["value"] == pytest.approx(30, rel=0.35)


def test_a_sample_of_the_seeded_faults_is_found(found: dict):
    checks = (figure for figure in found["figures"] if PARTS["check"] in figure["group"])
    figures = {figure["name"]: figure for figure in checks}
    assert figures["recall, documents of the tests"]["value"] == 100
    for kind in ("URDF", "SDF", "xacro"):
        assert figures[f"recall, mutations of {kind}"]["value"] >= 80, figures
        assert figures[f"precision, mutations of {kind}"]["value"] >= 80, figures
    assert figures["harmless edits with a finding"]["value"] == 0, figures
    assert figures["shipped"]["value"] == 0, figures


def test_an_unknown_part_is_refused(tmp_path: Path):
    with pytest.raises(AssertionError, match="gazebo"):
        figures_of(launching.run, "benchmarks", tmp_path, "gazebo", "--quick")
