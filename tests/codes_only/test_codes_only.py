"""Messages are replaced by their codes, and tests of each room still pass."""

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src" / "cartwheel"
REPRESENTATIVE = {
    "api": "tests/api/test_api.py",
    "arrays": "tests/arrays/test_arrays.py",
    "assembly": "tests/assembly/test_assets.py",
    "batch": "tests/batch/test_batch.py::test_wrong_worlds_are_errors",
    "bridges": "tests/bridges/test_apart_link.py",
    "checks": "tests/checks/test_checks.py",
    "cli": "tests/cli/test_gazebo_arguments.py",
    "component": "tests/component/test_component.py",
    "control": "tests/control/test_registry.py",
    "dataset": "tests/dataset/test_dataset.py::test_mistakes",
    "description": "tests/description/test_loading.py",
    "corpus": "tests/corpus/test_finding.py",
    "devices": "tests/devices/cameras/test_camera_services.py",
    "dialects": "tests/dialects/sdf/test_scan.py",
    "gate": "tests/gate/test_frames.py",
    "gazebo": "tests/gazebo/test_hostile_text.py",
    "graph": "tests/graph/test_graph.py",
    "gym": "tests/gym/test_env.py::test_mistakes_are_errors",
    "messages": "tests/messages/library/test_library.py",
    "playback": "tests/playback/test_player.py::test_an_empty_recording_is_reported",
    "saving": "tests/saving/test_saving.py::test_not_while_it_runs_and_not_when_closed",
    "scenarios": "tests/scenarios/test_schema.py",
    "simulation": "tests/simulation/dynamics/test_separation.py",
    "sweeps": "tests/sweeps/test_sweep.py::test_invalid_cases_are_errors",
    "testing": "tests/testing/test_matchers.py::test_a_condition_that_says_nothing_is_refused",
    "viewer": "tests/viewer/test_port.py",
    "world": "tests/world/test_chains.py",
}
"""Tests of each room that reports diagnostics. Together they take a few seconds."""
_SLOW = (
    "tests/checks/test_checks.py::test_a_long_line_of_comments_is_read_at_once",
    "tests/description/test_loading.py::test_nothing_slow_is_imported_before_it_is_needed",
    "tests/gate/test_frames.py::test_what_is_no_frame_or_too_large_is_an_error[data3]",
    "tests/messages/library/test_library.py::test_long_lines_are_read_in_linear_time",
    "tests/viewer/test_port.py::test_making_a_viewer_does_not_import_viser",
)
"""Tests of these files that look at time or imports, and not at errors."""


def run(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *command],
        cwd=ROOT,
        env={**os.environ, "CARTWHEEL_CODES_ONLY": "1"},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def test_a_message_is_its_code():
    program = (
        "import tests.codes_only.sitecustomize\n"
        "from cartwheel.codes.command import USAGE\n"
        "from cartwheel.errors import CartwheelError\n"
        "error = CartwheelError('words', code=USAGE, hint='Use other words.')\n"
        "made = USAGE.diagnostic('words', hint='Use other words.')\n"
        "print(error.message == made.message == USAGE.number, error.hint == made.hint == 'hint')"
    )
    assert run("-c", program).stdout == "True True\n"


def test_each_room_that_reports_diagnostics_is_represented():
    rooms = {
        file.relative_to(SOURCE).parts[0]
        for file in SOURCE.glob("*/**/*.py")
        if "cartwheel.codes" in file.read_text()
    }
    assert set(REPRESENTATIVE) == rooms - {"codes"}


def test_nothing_depends_on_words():
    files = REPRESENTATIVE.values()
    left_out = [f"--deselect={test}" for test in _SLOW]
    plugins = ("-p", "no:cacheprovider", "-p", "no:xdist")
    done = run("-m", "pytest", "-v", *plugins, *left_out, *files)
    assert done.returncode == 0, done.stdout
    passed = {line.split("::")[0] for line in re.findall(r"(?m)^(tests/.*) PASSED", done.stdout)}
    assert passed == {file.partition("::")[0] for file in files}
