"""Runs the benchmarks, prints a table and writes ``benchmarks/results/<date>.json``."""

from __future__ import annotations

import argparse
import os
from datetime import UTC, datetime
from pathlib import Path

# MuJoCo reads this on import. By default its renderer needs a display.
os.environ.setdefault("MUJOCO_GL", "egl")

from rich.console import Console

from benchmarks import (
    batch,
    camera,
    check,
    crowd,
    headless,
    making,
    process,
    rays,
    recording,
    scenario,
    sensors,
    unread,
    warp,
    wires,
)
from benchmarks.figure import FULL, QUICK
from benchmarks.report import machine, show, write

_PARTS = {
    "headless": headless,
    "unread": unread,
    "camera": camera,
    "sensors": sensors,
    "rays": rays,
    "process": process,
    "batch": batch,
    "warp": warp,
    "crowd": crowd,
    "making": making,
    "recording": recording,
    "scenario": scenario,
    "wires": wires,
    "check": check,
}


def main() -> None:
    """Entry point of ``python -m benchmarks``."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("parts", nargs="*", help=f"any of {', '.join(_PARTS)}; default: all")
    parser.add_argument("--quick", action="store_true", help="run everything briefly, as a test")
    parser.add_argument("--output", type=Path, help="path of the JSON file")
    options = parser.parse_args()
    unknown = set(options.parts) - set(_PARTS)
    if unknown:
        names = ", ".join(sorted(unknown))
        parser.error(f"unknown part {names}; expected any of {', '.join(_PARTS)}")
    console = Console(width=max(Console().width, 120))
    figures = []
    for name in options.parts or _PARTS:
        with console.status(f"measuring {name}"):
            figures += list(_PARTS[name].figures(QUICK if options.quick else FULL))
    about = machine()
    console.print(
        f"{about['processor']}, {about['cores']} cores, load {about['load']}, {about['opengl']}"
    )
    show(figures, console)
    name = datetime.now(UTC).strftime("%Y-%m-%d-%H%M%S.json")
    path = options.output or Path(__file__).parent / "results" / name
    write(figures, path)
    console.print(f"written to {path}")


if __name__ == "__main__":
    main()
