"""Messages are replaced by their codes, and tests of several rooms still pass."""

import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
REPRESENTATIVE = (
    "tests/description/sdf/test_frames.py",
    "tests/description/test_loading.py",
    "tests/gazebo/test_hostile_text.py",
    "tests/graph/test_graph.py",
)


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
        "error = CartwheelError('words', code=USAGE)\n"
        "print(error.message == USAGE.diagnostic('words').message == str(USAGE))"
    )
    assert run("-c", program).stdout == "True\n"


def test_nothing_depends_on_words():
    done = run("-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", *REPRESENTATIVE)
    assert done.returncode == 0, done.stdout
    passed = re.search(r"(\d+) passed", done.stdout)
    assert passed and int(passed[1]) > 100, done.stdout
