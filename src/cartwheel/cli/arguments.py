"""Arguments shared by several commands."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from cartwheel.cli import help
from cartwheel.codes.command import OPTION_INVALID, USAGE
from cartwheel.control.registry import VARIABLE
from cartwheel.errors import CartwheelError

_MAPPING = re.compile(r"([A-Za-z_][\w.-]*):=(.*)", re.DOTALL)

RECORDING = "Recording: a .mcap, .bag or .db3 file, or a rosbag2 folder."

Sim = Annotated[
    str | None,
    help.option(
        "--sim PID|WORLD",
        "Simulation to control, if several are running: its process ID or the name of its "
        "world. For the second world of a Python program, append -2 to its process ID. "
        f"Default: the environment variable {VARIABLE}.",
    ),
]


Names = Annotated[
    list[str] | None,
    help.argument(
        "FILE [NAME:=VALUE]...",
        "Robot description (xacro, URDF or SDF), or the name of a bundled description. NAME:=VALUE "
        "sets a xacro argument.",
    ),
]
ModelNames = Annotated[
    list[str] | None,
    help.argument(
        "FILE [NAME:=VALUE]...",
        "Model file (xacro, URDF or SDF), or the name of a bundled model. NAME:=VALUE sets a xacro "
        "argument.",
    ),
]
CheckNames = Annotated[
    list[str] | None,
    help.argument(
        "FILE|FOLDER [NAME:=VALUE]...",
        "Robot description (xacro, URDF or SDF), the name of a bundled description, or a folder "
        "with descriptions. NAME:=VALUE sets a xacro argument.",
    ),
]
RunNames = Annotated[
    list[str] | None,
    help.argument(
        "[FILE] [NAME:=VALUE]...",
        "Robot description (xacro, URDF or SDF), the name of a bundled description, or a launch "
        "file. Default: the bundled example cart, rosbots.xacro.",
    ),
]
Plugin = Annotated[
    list[Path] | None,
    help.option(
        "--plugin FILE",
        "Execute this Python file and use the plugins that it defines. Can be repeated.",
        help.ROBOT,
    ),
]
PackagePath = Annotated[
    list[Path] | None,
    help.option(
        "--package-path FOLDER",
        "Search this folder first for packages and models. Can be repeated.",
        help.LOOKUP,
    ),
]
AllowPath = Annotated[
    list[Path] | None,
    help.option(
        "--allow-path FOLDER",
        "Allow services to read files in this folder, in addition to packages and models."
        " Can be repeated.",
        help.LOOKUP,
    ),
]


X = Annotated[float | None, help.option("-x M", "Initial x position in the world.", help.ROBOT)]
Y = Annotated[float | None, help.option("-y M", "Initial y position in the world.", help.ROBOT)]
Z = Annotated[float | None, help.option("-z M", "Initial z position in the world.", help.ROBOT)]
Roll = Annotated[float | None, help.option("-R RAD", "Initial roll.", help.ROBOT)]
Pitch = Annotated[float | None, help.option("-P RAD", "Initial pitch.", help.ROBOT)]
Yaw = Annotated[float | None, help.option("-Y RAD", "Initial yaw.", help.ROBOT)]
Model = Annotated[
    str | None,
    help.option(
        "--model NAME", "Name of the model in the world. Default: the name in the file.", help.ROBOT
    ),
]


def _host(servers: str) -> Any:
    return help.option(
        "--host ADDRESS",
        f"Network address of {servers}. With 0.0.0.0, other computers can connect if they "
        "have the token, which is in the printed URL.",
        help.PAGE,
    )


Host = Annotated[str, _host("the web interface")]
RunHost = Annotated[str, _host("the web interface and the Foxglove server")]
AllowOrigin = Annotated[
    list[str] | None,
    help.option(
        "--allow-origin ORIGIN",
        "Accept connections from web pages with this origin, such as"
        " https://robots.example.org. Can be repeated.",
        help.PAGE,
    ),
]
Port = Annotated[
    int,
    help.option(
        "--port PORT",
        "Port of the web interface; 0 selects a free port.",
        help.PAGE,
        min=0,
        max=65535,
    ),
]
Headless = Annotated[bool, help.option("--headless", "Run without the web interface.", help.PAGE)]
Paused = Annotated[bool, help.option("--paused", "Start paused.", help.TIME)]
OpenBrowser = Annotated[
    bool | None,
    help.option(
        "--open/--no-open",
        "Open the web interface in a browser. Default: open if a desktop session is running.",
        help.PAGE,
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


def folders(words: Sequence[str]) -> tuple[list[Path], dict[str, str]]:
    """The folders and files of a command, and its ``name:=value`` arguments, in any order.

    Raises:
        CartwheelError: There are only arguments.
    """
    pairs = [(word, _MAPPING.fullmatch(word)) for word in words]
    found = [Path(word) for word, match in pairs if match is None]
    if not found:
        raise CartwheelError(
            "a folder is missing", code=USAGE, hint="Pass a folder of robots, or a robot's file."
        )
    return found, {match[1]: match[2] for _, match in pairs if match is not None}


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
