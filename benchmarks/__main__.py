"""Measures, prints a table, writes ``benchmarks/results/<date>.json``."""

from __future__ import annotations

import argparse
import os
from datetime import UTC, datetime
from pathlib import Path

# Read when MuJoCo is imported, for its own renderer: without it that looks for a display.
os.environ.setdefault("MUJOCO_GL", "egl")

from rich.console import Console

from benchmarks import camera, headless, process, sensors, wires
from benchmarks.figure import FULL, QUICK
from benchmarks.report import machine, show, write

_PARTS = {
    "headless": headless,
    "camera": camera,
    "sensors": sensors,
    "process": process,
    "wires": wires,
}


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("parts", nargs="*", help=f"some of {', '.join(_PARTS)}; all when none")
    parser.add_argument("--quick", action="store_true", help="try everything once, measure nothing")
    parser.add_argument("--output", type=Path, help="of the JSON file")
    options = parser.parse_args()
    unknown = set(options.parts) - set(_PARTS)
    if unknown:
        parser.error(f"no part {', '.join(sorted(unknown))}; there are {', '.join(_PARTS)}")
    console = Console(width=max(Console().width, 120))
    found = []
    for name in options.parts or _PARTS:
        with console.status(f"measuring {name}"):
            found += list(_PARTS[name].figures(QUICK if options.quick else FULL))
    about = machine()
    console.print(
        f"{about['processor']}, {about['cores']} cores, load {about['load']}, {about['opengl']}"
    )
    show(found, console)
    name = datetime.now(UTC).strftime("%Y-%m-%d-%H%M%S.json")
    path = options.output or Path(__file__).parent / "results" / name
    write(found, path)
    console.print(f"written to {path}")


if __name__ == "__main__":
    main()
