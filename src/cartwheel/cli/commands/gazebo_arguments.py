"""Command-line arguments of Gazebo's programs, with notes about unsupported options.

Source: gzserver 11 and gzclient 11, their ``--help``; gazebo_ros, its launch files and scripts.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import NoReturn

from cartwheel.cli.console import say, say_version
from cartwheel.cli.showing import print_diagnostic
from cartwheel.codes.command import GAZEBO_OPTION_UNSUPPORTED, OPTION_INVALID, USAGE
from cartwheel.errors import CartwheelError

WORLD = "worlds/empty.world"
"""The default world."""

OWN_PLUGINS = frozenset(
    f"libgazebo_ros_{name}"
    for name in ("api_plugin", "paths_plugin", "init", "factory", "state", "force_system", "clock")
)
"""System plugins that Cartwheel replaces, without file extensions."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ClientArguments:
    """The arguments of gzclient."""

    verbose: bool = False
    ros: tuple[str, ...] = ()
    """``name:=value`` arguments for the ROS node."""
    notes: tuple[str, ...] = ()
    """Notes about options without effect, one per line."""
    help: str = ""
    """The text of ``--help``, if requested."""
    version: bool = False

    def tell(self) -> bool:
        """Prints the notes; returns whether only a text was requested."""
        if self.help:
            say(self.help)
        elif self.version:
            say_version()
        else:
            for note in self.notes:
                print_diagnostic(GAZEBO_OPTION_UNSUPPORTED.diagnostic(note))
        return bool(self.help or self.version)


@dataclass(frozen=True, kw_only=True, slots=True)
class ServerArguments(ClientArguments):
    """The arguments of gzserver."""

    world: str = WORLD
    paused: bool = False
    seed: int = 0
    iterations: int | None = None
    """Number of steps to run."""
    allow_path: tuple[Path, ...] = ()
    """Folders with files that services may access."""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise CartwheelError(
            f"{self.prog}: {message}",
            code=USAGE,
            hint=f"See: {self.prog} --help",
            values={"program": self.prog},
        )


def parse_server(program: str, words: Sequence[str]) -> ServerArguments:
    """Parses the arguments of gzserver, gazebo, debug or perf.

    Raises:
        CartwheelError: An option is unknown or unsupported, or its value is invalid.
    """
    parser = _Parser(
        prog=program,
        add_help=False,
        description="Simulates a world. Accepts the options of gzserver.",
        epilog="name:=value sets an argument of the ROS node, such as __name:=gazebo.",
    )
    add = parser.add_argument
    add("world", nargs="*", metavar="WORLD", help=f"world file; default: {WORLD}. Searched in the "
        "current folder, in GAZEBO_RESOURCE_PATH, and among the bundled worlds")  # fmt: skip
    add("-h", "--help", action="store_true", help="show this message and exit")
    add("-v", "--version", action="store_true", help="show the version and exit")
    add("--verbose", action="store_true", help="show informational messages")
    add("-q", "--quiet", action="store_true", help="no effect: quiet output is the default")
    add("-u", "--pause", action="store_true", help="start paused")
    add("--seed", type=_whole, metavar="N", default=0, help="random seed for sensor noise")
    add("--iters", type=_whole, metavar="N", help="stop after N steps")
    add("-s", "--server-plugin", action="append", metavar="FILE", default=[],
        help="ignored with a warning, except gazebo_ros plugins, which are built in")  # fmt: skip
    add("--allow-path", action="append", metavar="FOLDER", default=[], type=Path,
        help="let services read files in this folder, in addition to packages and "
             "models")  # fmt: skip
    add("--lockstep", action="store_true", help="no effect: cameras never drop frames")
    add("-e", "--physics", metavar="ENGINE", default="ode",
        help="no effect: MuJoCo is used, with the ODE parameters of the world")  # fmt: skip
    inert = parser.add_argument_group("ignored, with a warning")
    inert.add_argument("-r", "--record", action="store_true", help=argparse.SUPPRESS)
    for name in ("encoding", "path", "period", "filter"):
        inert.add_argument(f"--record_{name}", metavar="X", help=argparse.SUPPRESS)
    inert.add_argument("--record_resources", action="store_true", help=argparse.SUPPRESS)
    inert.add_argument("-p", "--play", metavar="FILE", help=argparse.SUPPRESS)
    inert.add_argument("-o", "--profile", metavar="NAME", help="name of a physics preset")
    inert.add_argument("--initial_sim_time", metavar="S", default="0", help="time starts at 0")
    inert.add_argument("--minimal_comms", action="store_true", help="Gazebo transport option")
    inert.add_argument("--headless", action="store_true", help="argument of launch files")
    given = parser.parse_args([word for word in words if ":=" not in word])
    if given.play is not None:
        raise CartwheelError(
            f"{program} -p {given.play}: Gazebo state logs cannot be played",
            code=GAZEBO_OPTION_UNSUPPORTED,
            hint="Record topics with rosbag record, and play them with rosbag play.",
            values={"option": "-p"},
        )
    if given.iters is not None and given.iters < 1:
        raise CartwheelError(
            f"{program} --iters must be above 0 (got {given.iters})",
            code=OPTION_INVALID,
            values={"option": "--iters", "value": given.iters},
        )
    return ServerArguments(
        world=given.world[0] if given.world else WORLD,
        paused=given.pause,
        verbose=given.verbose or program == "debug",
        seed=abs(given.seed),
        iterations=given.iters,
        allow_path=tuple(given.allow_path),
        ros=tuple(word for word in words if ":=" in word),
        notes=tuple(_server_notes(program, given)),
        help=parser.format_help() if given.help else "",
        version=given.version,
    )


def parse_client(words: Sequence[str]) -> ClientArguments:
    """Parses the arguments of gzclient.

    Raises:
        CartwheelError: An option is unknown.
    """
    parser = _Parser(
        prog="gzclient",
        add_help=False,
        description="Shows the running simulation in the browser until the simulation or this "
        "program ends.",
    )
    add = parser.add_argument
    add("world", nargs="*", help=argparse.SUPPRESS)
    add("-h", "--help", action="store_true", help="show this message and exit")
    add("-v", "--version", action="store_true", help="show the version and exit")
    add("--verbose", action="store_true", help="no effect")
    add("-q", "--quiet", action="store_true", help="no effect")
    add("-g", "--gui-client-plugin", "--gui-plugin", action="append", metavar="FILE", default=[],
        help="Gazebo GUI plugins are ignored with a warning")  # fmt: skip
    given = parser.parse_args([word for word in words if ":=" not in word])
    notes = [
        f"-g {plugin} is ignored: the web interface does not support Gazebo GUI plugins"
        for plugin in given.gui_client_plugin
        if _stem(plugin) not in OWN_PLUGINS
    ]
    return ClientArguments(
        verbose=given.verbose,
        ros=tuple(word for word in words if ":=" in word),
        notes=tuple(notes),
        help=parser.format_help() if given.help else "",
        version=given.version,
    )


def _server_notes(program: str, given: argparse.Namespace) -> list[str]:
    notes = []
    if program == "debug":
        notes.append(
            "debug: gdb is not used; informational messages are shown instead, as with --verbose"
        )
    if program == "perf":
        notes.append("perf: valgrind is not used; the simulation runs normally")
    if given.physics != "ode":
        notes.append(
            f"-e {given.physics} is ignored: the engine is always MuJoCo, with the parameters for "
            "ode"
        )
    recording = (
        given.record,
        given.record_encoding,
        given.record_path,
        given.record_period,
        given.record_filter,
        given.record_resources,
    )
    if any(recording):
        notes.append(
            "the recording options are ignored: no state log is written. Record topics instead: "
            "rosbag record -a"
        )
    if given.headless:
        notes.append(
            "--headless is ignored: this program opens no window. In a launch file, "
            "gui:=false does not start gzclient"
        )
    if given.profile is not None:
        notes.append(f"-o {given.profile} is ignored: physics profiles are not supported")
    if _number(given.initial_sim_time) != 0.0:
        notes.append("--initial_sim_time is ignored: time always starts at 0")
    if given.minimal_comms:
        notes.append("--minimal_comms is ignored: Gazebo transport is not used")
    notes.extend(
        f"-s {plugin} is ignored: system plugins are not supported"
        for plugin in given.server_plugin
        if _stem(plugin) not in OWN_PLUGINS
    )
    notes.extend(f"{word} is ignored: only one world is loaded" for word in given.world[1:])
    return notes


def _stem(plugin: str) -> str:
    return PurePath(plugin).name.partition(".")[0]


def _whole(text: str) -> int:
    value = _number(text)
    if value != math.floor(value):
        raise argparse.ArgumentTypeError(f"expected a whole number, got {text}")
    return int(value)


def _number(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"expected a number, got {text}")
    return value
