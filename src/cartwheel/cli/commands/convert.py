"""Converts a description to a different format."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from cartwheel.cli.commands.grouping import grouped
from cartwheel.cli.console import note
from cartwheel.cli.showing import print_diagnostic
from cartwheel.cli.writing import writing


def convert(
    file: str,
    values: Mapping[str, str],
    package_path: Sequence[Path],
    *,
    to: str,
    output: Path | None,
) -> None:
    """Writes a file as URDF or MJCF, to a file or to stdout."""
    if to == "urdf":
        from cartwheel.description.convert import to_urdf

        text = to_urdf(file, arguments=values, package_path=package_path)
    else:
        text = _mjcf(file, values, package_path)
    if not text.endswith("\n"):
        text += "\n"
    if output is None:
        sys.stdout.write(text)
        sys.stdout.flush()
        return
    with writing(output):
        output.write_text(text)
    note(f"wrote {output}")


def _mjcf(file: str, values: Mapping[str, str], package_path: Sequence[Path]) -> str:
    from cartwheel.description import load
    from cartwheel.description.model import WorldDescription
    from cartwheel.world import build
    from cartwheel.world.entry import ModelEntry

    found = load(file, arguments=values, package_path=package_path)
    if isinstance(found, WorldDescription):
        world, models = found, found.models
    else:
        world, models = WorldDescription(name=found.name), (found,)
    for diagnostic in grouped(found.diagnostics):
        if diagnostic.severity != "info":
            print_diagnostic(diagnostic)
    entries = [ModelEntry(name=model.name, description=model, pose=model.pose) for model in models]
    xml = build(world, entries, xml=True).xml
    assert xml is not None
    return xml
