"""The output of the benchmarks: a table and a JSON file."""

from __future__ import annotations

import importlib.metadata
import itertools
import json
import os
import platform
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal

from rich.console import Console
from rich.table import Table

from benchmarks.figure import Figure

_PACKAGES = ("cartwheel", "mujoco", "numpy", "rosbags")


def show(figures: Iterable[Figure], console: Console) -> None:
    """Prints a table for each group of figures."""
    for group, members in itertools.groupby(figures, key=lambda figure: figure.group):
        table = Table(box=None, pad_edge=False, show_header=False)
        for width in (28, 8, 18, 8, 4):
            side: Literal["left", "right"] = "right" if width == 8 else "left"
            table.add_column(min_width=width, justify=side, no_wrap=True)
        table.add_column()
        for figure in members:
            goal = (
                f"{'≤' if figure.better == 'less' else '≥'} {figure.goal:g}" if figure.goal else ""
            )
            met = {None: "", True: "[green]yes", False: "[red]no"}[figure.met]
            value = f"{figure.value:.3g}" if figure.value < 100 else f"{figure.value:.0f}"
            table.add_row(figure.name, value, figure.unit, goal, met, figure.note)
        console.print(f"\n[bold]{group}")
        console.print(table)


def write(figures: Sequence[Figure], path: Path) -> None:
    """Writes the figures as JSON, with the machine and the versions of packages."""
    path.parent.mkdir(parents=True, exist_ok=True)
    content = {
        "when": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": machine(),
        "versions": {name: importlib.metadata.version(name) for name in _PACKAGES}
        | {"python": platform.python_version()},
        "figures": [asdict(figure) | {"met": figure.met} for figure in figures],
    }
    path.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n")


def machine() -> dict[str, Any]:
    """Describes the machine: processor, cores, system, load and OpenGL renderer."""
    return {
        "processor": _processor(),
        "cores": len(os.sched_getaffinity(0)),
        "system": platform.system(),
        "load": round(os.getloadavg()[0], 2),
        "opengl": _opengl(),
    }


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    named = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(named, platform.machine())


def _opengl() -> str:
    """The OpenGL renderer. Image times of a GPU do not apply to machines without one."""
    try:
        from mujoco.egl import GLContext

        context = GLContext(16, 16)
        context.make_current()
        from OpenGL import GL

        name = GL.glGetString(GL.GL_RENDERER)
        context.free()
    except Exception as error:  # noqa: BLE001 - a missing library raises various errors
        return f"none: {error}"
    return name.decode() if isinstance(name, bytes) else str(name)
