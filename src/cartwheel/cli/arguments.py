"""Arguments that several commands share."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal

import typer

from cartwheel.control.registry import VARIABLE
from cartwheel.errors import CartwheelError

_MAPPING = re.compile(r"([A-Za-z_][\w.-]*):=(.*)", re.DOTALL)

Sim = Annotated[
    int | None,
    typer.Option(
        "--sim", metavar="PID", help=f"Which simulation, where several run. Also {VARIABLE}."
    ),
]
Names = Annotated[
    list[str] | None,
    typer.Argument(metavar="[FILE] [NAME:=VALUE]...", show_default=False),
]
PackagePath = Annotated[
    list[Path] | None,
    typer.Option(
        "--package-path",
        metavar="FOLDER",
        help="Look for packages and models here first. May be given again.",
    ),
]
AllowPath = Annotated[
    list[Path] | None,
    typer.Option(
        "--allow-path",
        metavar="FOLDER",
        help="Allow services to read files below this folder, besides packages and models. Can be"
        " repeated.",
    ),
]
X = Annotated[float | None, typer.Option("-x", metavar="M", help="Place in the world.")]
Y = Annotated[float | None, typer.Option("-y", metavar="M")]
Z = Annotated[float | None, typer.Option("-z", metavar="M")]
Roll = Annotated[float | None, typer.Option("-R", metavar="RAD", help="Roll, pitch and yaw.")]
Pitch = Annotated[float | None, typer.Option("-P", metavar="RAD")]
Yaw = Annotated[float | None, typer.Option("-Y", metavar="RAD")]
Model = Annotated[
    str | None, typer.Option("--model", metavar="NAME", help="Its name in the world.")
]
Host = Annotated[
    str,
    typer.Option(
        help="Address for the viewer and Foxglove's server. With 0.0.0.0 other computers can"
        " connect; they need the token in the printed address."
    ),
]
AllowOrigin = Annotated[
    list[str] | None,
    typer.Option(
        "--allow-origin",
        metavar="ORIGIN",
        help="Admit web pages of this origin, for example https://robots.example.org, and"
        " browsers that use its name for the server. Can be repeated.",
    ),
]
Port = Annotated[
    int, typer.Option(min=0, max=65535, help="Port of the viewer; 0 takes a free one.")
]

Headless = Annotated[bool, typer.Option("--headless", help="Without the viewer.")]
Paused = Annotated[bool, typer.Option("--paused", help="Begin with time held.")]
OpenBrowser = Annotated[
    bool | None, typer.Option("--open/--no-open", help="Open the browser; on a desktop it is.")
]


def split(words: Sequence[str] | None) -> tuple[str | None, dict[str, str]]:
    """The file and the ``name:=value`` among the words of a command, in any order.

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
                f'"{word}" is one file too many after "{file}"',
                hint=f"An argument of a xacro file is written {word.partition('=')[0]}:=value.",
            )
    return file, values


def split_ros1(words: Sequence[str] | None) -> tuple[list[str], list[str]]:
    """The words of a command without ROS 1's, and ROS 1's: ``__name:=``, ``_param:=``, ``/a:=b``.

    What may be an argument of a xacro file or a remapping stays among the first.
    """
    ours: list[str] = []
    ros: list[str] = []
    for word in words or ():
        (ros if ":=" in word and word[0] in "_/~" else ours).append(word)
    return ours, ros


def rmw(name: str) -> Literal["dds", "zenoh"]:
    """The middleware by our name or by that of ROS's implementation.

    Raises:
        CartwheelError: There is none of that name.
    """
    if name in ("dds", "rmw_fastrtps_cpp", "rmw_cyclonedds_cpp"):
        return "dds"
    if name in ("zenoh", "rmw_zenoh_cpp"):
        return "zenoh"
    raise CartwheelError(f"--rmw {name} is no middleware", hint="It can be dds or zenoh.")


def needed(file: str | None) -> str:
    """The file of a command that cannot do without.

    Raises:
        CartwheelError: There is none.
    """
    if file is None:
        raise CartwheelError("which file?", hint="Name a xacro, URDF or SDF file.")
    return file


def place(**values: float | None) -> dict[str, float]:
    """The given ones of x, y, z, roll, pitch, yaw."""
    return {name: value for name, value in values.items() if value is not None}
