"""``cartwheel view``, ``convert`` and ``version``: commands without a simulation."""

from __future__ import annotations

import enum
from pathlib import Path
from typing import Annotated

from cartwheel.cli import arguments, help
from cartwheel.cli.console import say_version
from cartwheel.codes.command import USAGE
from cartwheel.errors import CartwheelError


class Format(enum.StrEnum):
    """What a description can be written as."""

    URDF = "urdf"
    MJCF = "mjcf"


_SUFFIXES = {".urdf": Format.URDF, ".xml": Format.MJCF, ".mjcf": Format.MJCF}


def view(
    words: arguments.Names = None,
    host: arguments.Host = "127.0.0.1",
    allow_origin: arguments.AllowOrigin = None,
    port: arguments.Port = 8080,
    package_path: arguments.PackagePath = None,
) -> None:
    """View a robot description without physics.

    The browser shows the joints, frames and inertia of the robot.
    """
    from cartwheel.cli.commands import view as work

    file, values = arguments.split(words)
    work.view(
        arguments.needed(file),
        values,
        package_path or [],
        host=host,
        allow_origin=allow_origin or [],
        port=port,
    )


def convert(
    words: arguments.Names = None,
    to: Annotated[
        Format | None,
        help.option("--to", "Output format. Default: that of the output file, .urdf or .xml."),
    ] = None,
    output: Annotated[
        Path | None, help.option("-o --output FILE", "Output file. Default: stdout.")
    ] = None,
    package_path: arguments.PackagePath = None,
) -> None:
    """Convert a robot description to plain URDF or MuJoCo's MJCF."""
    from cartwheel.cli.commands import convert as work

    file, values = arguments.split(words)
    if to is None:
        to = _format_of(output)
    work.convert(arguments.needed(file), values, package_path or [], to=to.value, output=output)


def _format_of(output: Path | None) -> Format:
    """The format of an output file.

    Raises:
        CartwheelError: There is no file, or its name does not state a format.
    """
    found = None if output is None else _SUFFIXES.get(output.suffix.lower())
    if found is None:
        raise CartwheelError(
            "the output format is missing", code=USAGE, hint="Add --to urdf or --to mjcf."
        )
    return found


def version() -> None:
    """Show the version."""
    say_version()
