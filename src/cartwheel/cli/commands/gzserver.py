"""Runs a simulation with gzserver's arguments."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace

from cartwheel.assembly.plan import Plan
from cartwheel.assembly.ports import free_port
from cartwheel.cli.commands.gazebo_arguments import ServerArguments, parse_server
from cartwheel.cli.commands.gazebo_paths import adopt_exports, find_world
from cartwheel.cli.commands.options import Options
from cartwheel.cli.commands.run import simulate

NODE = "gazebo"
"""Default name of the ROS node, unless ``__name:=`` is given."""


def serve(program: str, words: Sequence[str]) -> None:
    """Runs a world until it is interrupted.

    Args:
        program: gzserver, gazebo, debug or perf.
        words: The command-line arguments.

    Raises:
        CartwheelError: An option or the world is invalid.
    """
    arguments = parse_server(program, words)
    if arguments.tell():
        return
    environment = dict(os.environ)
    adopt_exports(environment)
    os.environ.update(environment)
    simulate(translated(program, arguments))


def translated(program: str, arguments: ServerArguments) -> Options:
    """The equivalent options of ``cartwheel run``.

    Raises:
        CartwheelError: The world does not exist.
    """
    options = Options(
        file=str(find_world(arguments.world)),
        values={},
        headless=program != "gazebo",
        paused=arguments.paused,
        seed=arguments.seed,
        steps=arguments.iterations,
        verbose=arguments.verbose,
        allow_path=arguments.allow_path,
        plan=Plan(ros1=NODE, ros1_arguments=arguments.ros),
    )
    if not options.headless:
        return replace(options, port=free_port(options.host, options.port))
    return options
