"""The processes of a running simulation."""

import contextlib
import subprocess
from pathlib import Path
from typing import Any

from tests.launching import BRIDGE

_MARK = "cartwheel.bridges.apart.child"


def bridges_of(process: subprocess.Popen[Any]) -> list[int]:
    """The process IDs of a run's bridges and recorders, in ascending order."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError, IndexError):
            name, _, state = (folder / "stat").read_text().partition("(")[2].rpartition(")")
            if name == BRIDGE.format(process.pid) or (
                int(state.split()[1]) == process.pid and _MARK in (folder / "cmdline").read_text()
            ):
                found.append(int(folder.name))
    return sorted(found)


def is_alive(pid: int) -> bool:
    """Whether a process runs, and is not only waited for."""
    try:
        return (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
