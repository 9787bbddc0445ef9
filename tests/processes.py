"""The processes of a running simulation."""

import contextlib
import subprocess
from pathlib import Path
from typing import Any

_MARK = "cartwheel.bridges.apart.child"


def bridges_of(process: subprocess.Popen[Any]) -> list[int]:
    """The process IDs of a run's bridges and recorders, in ascending order."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError, IndexError):
            parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
            if parent == process.pid and _MARK in (folder / "cmdline").read_text():
                found.append(int(folder.name))
    return sorted(found)
