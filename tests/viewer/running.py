"""The real program with its page, in a folder of sockets of its own."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tests import launching

PROGRAM = Path(sys.executable).with_name("cartwheel")


@dataclass
class Running:
    """A started simulation."""

    process: subprocess.Popen[str]
    port: int
    """Of its page."""


@contextlib.contextmanager
def running(folder: Path, *arguments: str) -> Iterator[Running]:
    """Starts one, and kills it at the end."""
    process = launching.Popen(
        [PROGRAM, "run", "--port", "0", "--no-open", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, "XDG_RUNTIME_DIR": str(folder)},
    )
    assert process.stdout is not None
    try:
        line = next(line for line in process.stdout if line.startswith("viewer"))
        yield Running(process, int(line.rpartition(":")[2].partition("/")[0]))
    finally:
        process.kill()
        process.communicate()
