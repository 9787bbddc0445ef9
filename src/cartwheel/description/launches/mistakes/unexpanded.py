"""Launch files that pass the text of a xacro to ROS without expanding it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from cartwheel.codes.files import DESCRIPTION_NOT_EXPANDED
from cartwheel.description.elements.xml import needs_xacro, parse
from cartwheel.description.files.regular_files import read_regular_text
from cartwheel.description.launches.launch_use import LaunchUse
from cartwheel.errors import CartwheelError, Diagnostic

_XACRO = re.compile(r"<xacro:|\$\{")


def needs_expansion(description: Path) -> bool:
    """Whether a file contains xacro elements or expressions, outside of comments."""
    try:
        text = read_regular_text(description)
    except OSError:
        return False
    first, *rest = text.split("<!--")
    if not any(
        _XACRO.search(each) for each in (first, *(each.partition("-->")[2] for each in rest))
    ):
        return False
    try:
        return needs_xacro(parse(text, str(description)))
    except CartwheelError:
        return True


def unexpanded(description: Path, launches: Sequence[LaunchUse]) -> Iterator[Diagnostic]:
    """The launch file that starts a robot in Gazebo without expanding its description.

    It is reported only if no launch file that starts the robot in Gazebo expands the description.

    Args:
        description: The description.
        launches: Launch files of its author.
    """
    path = description.resolve()
    own = [
        each
        for each in launches
        if each.simulated and each.description is not None and each.description.resolve() == path
    ]
    raw = {each.file: each for each in own if each.raw}
    # What the launch file publishes may be expanded, although what it spawns is not.
    left = [raw.get(each.file, each) for each in own]
    if all(each.plain is not None for each in left):
        for use in left[:1]:
            yield from not_expanded(use)


def not_expanded(use: LaunchUse) -> Iterator[Diagnostic]:
    """The diagnostic for a launch file that passes a xacro as it is."""
    if use.plain is not None and use.description is not None and needs_expansion(use.description):
        name, what = use.description.name, "robot_description is"
        command = f"command=\"xacro '$(find PACKAGE)/…/{name}'\""
        if use.plain.file.endswith(".py"):
            command = 'Command(["xacro ", file])'
        hint = f"Run xacro, for example with {command}."
        if use.raw:
            what = "the spawner passes to Gazebo"
            hint += " Publish the result as robot_description, and spawn this instead of the file."
        yield DESCRIPTION_NOT_EXPANDED.diagnostic(
            f'{what} the text of "{name}", which xacro does not expand, so Gazebo '
            "finds no links of its macros and included files, and no values of its expressions",
            origin=use.plain,
            values={"description": str(use.description)},
            hint=hint,
        )
