"""Values for the ``$(arg name)`` and ``$(var name)`` of controllers' files.

Launch files mostly give them to the robot's xacro as well, under the same name. One that the
xacro does not have is a prefix of joints: the one with which its words name joints.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from cartwheel.description.model import RobotDescription

_BEFORE_NAME = re.compile(r"\$\(\s*(?:arg|var)\s+(\w+)\s*\)(\w+)")


def launch_arguments(content: Any, robot: RobotDescription) -> dict[str, str]:
    """The robot's arguments, and those of the file that can be told from its joints.

    Args:
        content: Of the file, as read.
        robot: Whose controllers it has.
    """
    prefixes: dict[str, set[str]] = {}
    for text in _texts(content):
        for name, rest in _BEFORE_NAME.findall(text):
            able = {
                joint.name.removesuffix(rest) for joint in robot.joints if joint.name.endswith(rest)
            }
            if able:
                prefixes[name] = prefixes.get(name, able) & able
    found = {name: min(able, key=len) for name, able in prefixes.items() if able}
    return {**found, **robot.arguments}


def _texts(content: Any) -> Iterator[str]:
    if isinstance(content, str):
        yield content
    elif isinstance(content, Mapping):
        for key, value in content.items():
            yield from _texts(key)
            yield from _texts(value)
    elif isinstance(content, list):
        for value in content:
            yield from _texts(value)
