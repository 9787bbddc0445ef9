"""Commands that select one of several worlds of a program."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from tests import launching

import cartwheel as cw
from cartwheel.codes.command import SIMULATION_AMBIGUOUS

pytestmark = pytest.mark.usefixtures("tidy")

PROGRAM = Path(sys.executable).with_name("cartwheel")


def cartwheel(*words: str) -> subprocess.CompletedProcess[str]:
    return launching.run(
        [PROGRAM, *words], check=False, capture_output=True, text=True, timeout=120
    )


def test_a_command_selects_a_world_by_its_number_or_name() -> None:
    pid = os.getpid()
    with cw.World("empty") as first, cw.World("walls") as second:
        for world, seconds in ((first, 0.1), (second, 0.2)):
            world.serve_commands()
            world.run(seconds)
        ambiguous = cartwheel("status", "--sim", str(pid))
        assert ambiguous.returncode == 2
        assert f"[{SIMULATION_AMBIGUOUS}]" in ambiguous.stderr
        listed = cartwheel("status").stdout
        for selector, time, other in (
            (f"{pid}-1", "0.100", "0.200"),
            ("empty", "0.100", "0.200"),
            (f"{pid}-2", "0.200", "0.100"),
            ("walls", "0.200", "0.100"),
        ):
            assert selector in listed + ambiguous.stderr
            selected = cartwheel("status", "--sim", selector).stdout
            assert f"{time} s" in selected
            assert f"{other} s" not in selected
