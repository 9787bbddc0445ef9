"""Arguments shared by several commands."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from cartwheel.cli import help
from cartwheel.codes.command import OPTION_INVALID, USAGE
from cartwheel.control.registry import VARIABLE
from cartwheel.errors import CartwheelError

_MAPPING = re.compile(r"([A-Za-z_][\w.-]*):=(.*)", re.DOTALL)

RECORDING = "Recording: a .mcap, .bag or .db3 file, or a rosbag2 folder."

Sim = Annotated[
    str | None,
    typer.Option(
        "--sim",
        metavar="PID|WORLD",
        help="Simulation to control, if several are running: its process ID or the name of its "
        "world. For the second world of a Python program, append -2 to its process ID. "
        f"Default: the environment variable {VARIABLE}.",
    ),
]


def _names(metavar: str, text: str) -> Any:
    return typer.Argument(metavar=metavar, show_default=False, help=text)


Names = Annotated[
    list[str] | None,
    _names(
        "FILE [NAME:=VALUE]...",
        "Robot description (xacro, URDF or SDF), or the name of a bundled description. NAME:=VALUE "
        "sets a xacro argument.",
    ),
]
ModelNames = Annotated[
    list[str] | None,
    _names(
        "FILE [NAME:=VALUE]...",
        "Model file (xacro, URDF or SDF), or the name of a bundled model. NAME:=VALUE sets a xacro "
        "argument.",
    ),
]
CheckNames = Annotated[
    list[str] | None,
    _names(
        "FILE|FOLDER [NAME:=VALUE]...",
        "Robot description (xacro, URDF or SDF), the name of a bundled description, or a folder "
        "with descriptions. NAME:=VALUE sets a xacro argument.",
    ),
]
RunNames = Annotated[
    list[str] | None,
    _names(
        "[FILE] [NAME:=VALUE]...",
        "Robot description (xacro, URDF or SDF), or the name of a bundled description. Default: "
        "the bundled example cart, rosbots.xacro.",
    ),
]
PackagePath = Annotated[
    list[Path] | None,
    typer.Option(
        "--package-path",
        metavar="FOLDER",
        help="Search this folder first for packages and models. Can be repeated.",
        rich_help_panel=help.LOOKUP,
    ),
]
AllowPath = Annotated[
    list[Path] | None,
    typer.Option(
        "--allow-path",
        metavar="FOLDER",
        help="Allow services to read files in this folder, in addition to packages and models."
        " Can be repeated.",
        rich_help_panel=help.LOOKUP,
    ),
]


def _pose(flag: str, unit: str, text: str) -> Any:
    return typer.Option(flag, metavar=unit, help=text, rich_help_panel=help.ROBOT)


X = Annotated[float | None, _pose("-x", "M", "Initial x position in the world.")]
Y = Annotated[float | None, _pose("-y", "M", "Initial y position in the world.")]
Z = Annotated[float | None, _pose("-z", "M", "Initial z position in the world.")]
Roll = Annotated[float | None, _pose("-R", "RAD", "Initial roll.")]
Pitch = Annotated[float | None, _pose("-P", "RAD", "Initial pitch.")]
Yaw = Annotated[float | None, _pose("-Y", "RAD", "Initial yaw.")]
Model = Annotated[
    str | None,
    typer.Option(
        "--model",
        metavar="NAME",
        help="Name of the model in the world. Default: the name in the file.",
        rich_help_panel=help.ROBOT,
    ),
]


def _host(servers: str) -> Any:
    return typer.Option(
        metavar="ADDRESS",
        help=f"Network address of {servers}. With 0.0.0.0, other computers can connect if they "
        "have the token, which is in the printed URL.",
        rich_help_panel=help.PAGE,
    )


Host = Annotated[str, _host("the web interface")]
RunHost = Annotated[str, _host("the web interface and the Foxglove server")]
AllowOrigin = Annotated[
    list[str] | None,
    typer.Option(
        "--allow-origin",
        metavar="ORIGIN",
        help="Accept connections from web pages with this origin, such as"
        " https://robots.example.org. Can be repeated.",
        rich_help_panel=help.PAGE,
    ),
]
Port = Annotated[
    int,
    typer.Option(
        min=0,
        max=65535,
        metavar="PORT",
        help="Port of the web interface; 0 selects a free port.",
        rich_help_panel=help.PAGE,
    ),
]
Headless = Annotated[
    bool,
    typer.Option("--headless", help="Run without the web interface.", rich_help_panel=help.PAGE),
]
Paused = Annotated[bool, typer.Option("--paused", help="Start paused.", rich_help_panel=help.TIME)]
OpenBrowser = Annotated[
    bool | None,
    typer.Option(
        "--open/--no-open",
        help="Open the web interface in a browser. Default: open if a desktop session is running.",
        rich_help_panel=help.PAGE,
    ),
]


def split(words: Sequence[str] | None) -> tuple[str | None, dict[str, str]]:
    """The file and the ``name:=value`` arguments of a command, in any order.

    Raises:
        CartwheelError: There are two files.
    """
    file = None
    values: dict[str, str] = {}
    for word in words or ():
        match = _MAPPING.fullmatch(word)
        if match:
            values[match[1]] = match[2]
        elif file is None:
            file = word
        else:
            raise CartwheelError(
                f'only one file is allowed (got "{file}" and "{word}")',
                code=USAGE,
                hint=f"Pass a xacro argument as {word.partition('=')[0]}:=value.",
                values={"argument": word},
            )
    return file, values


def split_ros1(words: Sequence[str] | None) -> tuple[list[str], list[str]]:
    """A command's words without ROS 1 arguments, and those: ``__name:=``, ``_param:=``, ``/a:=b``.

    Words that may be xacro arguments or remappings stay in the first list.
    """
    ours: list[str] = []
    ros: list[str] = []
    for word in words or ():
        (ros if ":=" in word and word[0] in "_/~" else ours).append(word)
    return ours, ros


def rmw(name: str) -> Literal["dds", "zenoh"]:
    """The middleware by Cartwheel's name or the name of the RMW implementation.

    Raises:
        CartwheelError: The name is unknown.
    """
    if name in ("dds", "rmw_fastrtps_cpp", "rmw_cyclonedds_cpp"):
        return "dds"
    if name in ("zenoh", "rmw_zenoh_cpp"):
        return "zenoh"
    raise CartwheelError(
        f"--rmw must be dds or zenoh (got {name})",
        code=OPTION_INVALID,
        values={"option": "--rmw", "value": name},
    )


def needed(file: str | None) -> str:
    """The file argument of a command that requires one.

    Raises:
        CartwheelError: The file is missing.
    """
    if file is None:
        raise CartwheelError(
            "a file argument is missing", code=USAGE, hint="Pass a xacro, URDF or SDF file."
        )
    return file


def place(**values: float | None) -> dict[str, float]:
    """The given values of x, y, z, roll, pitch, yaw."""
    return {name: value for name, value in values.items() if value is not None}
