"""Runs the examples, and the commands of a page of the documentation, and keeps what they print."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from tests.docs.pages import Command, commands
from tests.docs.test_commands import ASKS, Reader, matches

from . import plain

PATIENCE = 30.0
"""s in which the answer of a simulation that runs must become what the page shows."""


def measure_example(script: Path) -> dict[str, Any]:
    """Exit status and output of an example."""
    with tempfile.TemporaryDirectory(prefix="golden") as folder:
        done = subprocess.run(
            [sys.executable, str(script)],
            cwd=folder,
            capture_output=True,
            text=True,
            check=False,
        )
        lines = plain.output(done.stdout + done.stderr, {folder: "<folder>"}, live=False)
        files = sorted(str(each.relative_to(folder)) for each in Path(folder).rglob("*"))
    return {"status": done.returncode, "output": lines, "files": files}


def measure_page(page: Path) -> dict[str, Any]:
    """Exit status and output of each command of a page, in order."""
    with (
        tempfile.TemporaryDirectory(prefix="golden") as folder,
        tempfile.TemporaryDirectory(prefix="cw", dir="/tmp") as runtime,
    ):
        reader = Recorder(Path(folder), Path(runtime))
        try:
            for command in commands(page):
                reader.record(command)
        finally:
            reader.close()
        return {"commands": reader.found}


class Recorder(Reader):
    """Follows a page as its test does, and keeps what it saw."""

    def __init__(self, folder: Path, runtime: Path) -> None:
        super().__init__(folder, runtime)
        self.found: list[dict[str, Any]] = []
        self._places = {str(folder): "<folder>", str(runtime): "<runtime>"}

    def record(self, command: Command) -> None:
        """Runs a command."""
        before = len(self.found)
        entry: dict[str, Any] = {"command": command.text}
        try:
            self.follow(command)
        except BaseException as failed:
            # pytest's own failures are no `Exception`.
            if isinstance(failed, (KeyboardInterrupt, SystemExit)):
                raise
            entry["failed"] = plain.output(str(failed), self._places, live=True)
        if len(self.found) == before:
            self.found.append(entry)

    def _ask(self, command: Command) -> None:
        deadline = time.monotonic() + PATIENCE
        while True:
            done = subprocess.run(
                ["bash", "-c", f"set -o pipefail; {command.text}"],
                cwd=self.folder,
                env=self._environment,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                timeout=120,
                check=False,
            )
            printed = done.stdout + done.stderr
            fits = done.returncode == command.status and matches(command.expected, printed)
            if fits or not command.text.startswith(ASKS) or time.monotonic() > deadline:
                break
            time.sleep(0.2)
        live = self._running is not None
        self.found.append(
            {
                "command": command.text,
                "status": done.returncode,
                "as shown": fits,
                "output": plain.output(printed, self._places, live=live),
            }
        )
