"""docs/check.md lists every code as it is."""

import sys
from pathlib import Path

from tests import launching

ROOT = Path(__file__).parents[2]


def test_the_table_of_codes_is_up_to_date():
    command = [sys.executable, ROOT / "tools" / "make_code_table.py", "--check"]
    done = launching.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
