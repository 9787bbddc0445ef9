"""``cartwheel info``: the contents of a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cartwheel.cli import arguments, help


def info(
    file: Annotated[Path, help.argument("FILE", arguments.RECORDING)],
    *,
    json: Annotated[bool, help.option("--json", "Print the information as JSON.")] = False,
) -> None:
    """List the topics of a recording, with types, counts and rates."""
    from cartwheel.cli.commands import info as work

    work.info(file, as_json=json)
