"""``cartwheel gzserver``, ``gzclient`` and similar: Gazebo's programs under their own names.

Launch files start them through the package gazebo_ros in the folder ros1. They have separate
options, and Cartwheel's option parser is not imported for them, because launch files wait for the
first clock message.
"""

from __future__ import annotations

from collections.abc import Sequence

SERVERS = ("gzserver", "gazebo", "debug", "perf")
CLIENT = "gzclient"


def is_program(name: str) -> bool:
    """Whether there is such a program."""
    return name in SERVERS or name == CLIENT


def start(name: str, words: Sequence[str]) -> None:
    """Runs a program with its arguments."""
    if name == CLIENT:
        from cartwheel.cli.commands.gzclient import show

        show(words)
    else:
        from cartwheel.cli.commands.gzserver import serve

        serve(name, words)
