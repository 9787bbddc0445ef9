"""Values for ``$(arg name)`` and ``$(var name)`` in controller files.

Launch files usually pass the same values to the robot's xacro, under the same name. A name that the
xacro does not declare is assumed to be a joint prefix: the one for which the text after it
completes the name of a joint.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from cartwheel.description.model import RobotDescription

_BEFORE_NAME = re.compile(r"\$\(\s*(?:arg|var)\s+(\w+)\s*\)(\w+)")


def launch_arguments(content: Any, robot: RobotDescription) -> dict[str, str]:
    """Returns the robot's arguments, and the joint prefixes that the file requires.

    Args:
        content: Content of the file.
        robot: The robot that the controllers belong to.
    """
    prefixes: dict[str, set[str]] = {}
    for text in texts(content):
        for name, rest in _BEFORE_NAME.findall(text):
            able = {
                joint.name.removesuffix(rest) for joint in robot.joints if joint.name.endswith(rest)
            }
            if able:
                prefixes[name] = prefixes.get(name, able) & able
    shortest = {name: min(able, key=len) for name, able in prefixes.items() if able}
    return {**shortest, **robot.arguments}


def texts(content: Any) -> Iterator[str]:
    """Yields the strings in nested mappings and lists, with the keys."""
    if isinstance(content, str):
        yield content
    elif isinstance(content, Mapping):
        for key, value in content.items():
            yield str(key)
            yield from texts(value)
    elif isinstance(content, list):
        for value in content:
            yield from texts(value)
