"""Spawning, deleting and listing models."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cartwheel.cli.commands.clients import connect
from cartwheel.cli.commands.grouping import grouped
from cartwheel.cli.console import note, say, say_table
from cartwheel.cli.showing import print_diagnostic
from cartwheel.control.faults import unpacked


def spawn(
    sim: str | None,
    file: str,
    values: Mapping[str, str],
    *,
    place: Mapping[str, float],
    model: str | None,
    package_path: Sequence[Path],
) -> None:
    """Spawns a file. The simulation's process reads the description."""
    with connect(sim) as client:
        # Paths are relative to the user's folder, not the simulation's.
        from cartwheel.description.files.named_files import find_description

        path = find_description(file, package_path).absolute()
        answer = client.request(
            "spawn",
            file=str(path),
            arguments=dict(values),
            package_path=[str(folder.absolute()) for folder in package_path],
            model=model or "",
            **dict[str, Any](place),
        )
    for diagnostic in grouped(unpacked(each) for each in answer["diagnostics"]):
        print_diagnostic(diagnostic)
    say(answer["name"])


def delete(sim: str | None, model: str) -> None:
    """Deletes a model."""
    with connect(sim) as client:
        client.request("delete", model=model)


def print_list(sim: str | None) -> None:
    """Prints a table of all models."""
    with connect(sim) as client:
        found = client.request("models")["models"]
    if not found:
        note("the world is empty")
        return
    rows = [["model", "x", "y", "z", "yaw", "mass", "file"]]
    for one in found:
        x, y, z = one["position"]
        yaw = math.degrees(one["rpy"][2])
        mass = "static" if one["static"] else f"{one['mass']:.3g} kg"
        rows.append(
            [one["name"], *(f"{v:z.3f}" for v in (x, y, z)), f"{yaw:z.0f}°", mass, one["file"]]
        )
    say_table(rows)
