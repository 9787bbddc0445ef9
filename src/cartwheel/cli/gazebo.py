"""``cartwheel gzserver``, ``gzclient`` and their like: Gazebo's own programs by their names.

Launch files start them, by way of the package gazebo_ros in the folder ros1. They have
options of their own, and what reads those of Cartwheel is not imported for them: launch
files wait for the first clock.
"""

from __future__ import annotations

from collections.abc import Sequence

SERVERS = ("gzserver", "gazebo", "debug", "perf")
CLIENT = "gzclient"


def is_program(name: str) -> bool:
    """Whether there is such a program."""
    return name in SERVERS or name == CLIENT


def start(name: str, words: Sequence[str]) -> None:
    """Runs a program with its words."""
    if name == CLIENT:
        from cartwheel.cli.commands.gzclient import show

        show(words)
    else:
        from cartwheel.cli.commands.gzserver import serve

        serve(name, words)
