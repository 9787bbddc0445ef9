"""Reads launch files: the descriptions, xacro arguments and controller files that they name."""

from cartwheel.description.files.repositories import root_of
from cartwheel.description.launches.gazebos import in_simulator
from cartwheel.description.launches.launch_use import LaunchUse, unread
from cartwheel.description.launches.mistakes.reports import launch_mistakes, stopping
from cartwheel.description.launches.mistakes.unexpanded import needs_expansion, unexpanded
from cartwheel.description.launches.own import (
    LaunchSearch,
    OwnLaunches,
    own_launches,
)
from cartwheel.description.launches.search import (
    chosen,
    controllers_for,
    launches_near,
    moves,
    shared_parts,
    starters,
)
from cartwheel.description.launches.start import (
    LaunchedModel,
    LaunchStart,
    is_launch_file,
    read_launch,
)

__all__ = [
    "LaunchSearch",
    "LaunchStart",
    "LaunchUse",
    "LaunchedModel",
    "OwnLaunches",
    "chosen",
    "controllers_for",
    "in_simulator",
    "is_launch_file",
    "launch_mistakes",
    "launches_near",
    "moves",
    "needs_expansion",
    "own_launches",
    "read_launch",
    "root_of",
    "shared_parts",
    "starters",
    "stopping",
    "unexpanded",
    "unread",
]
