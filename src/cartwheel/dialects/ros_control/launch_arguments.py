"""Values for ``$(arg name)`` and ``$(var name)`` in controller files.

Launch files usually pass the same values to the robot's xacro, under the same name. A name that the
xacro does not declare is assumed to be a joint prefix: the one for which the text after it
completes the name of a joint. A name that is only used as the prefix of frames is assumed to be
empty.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from cartwheel.description.model import RobotDescription

_ARGUMENT = re.compile(r"\$\(\s*(?:arg|var)\s+(\w+)\s*\)")
_BEFORE_NAME = re.compile(r"\$\(\s*(?:arg|var)\s+(\w+)\s*\)(\w+)")


def launch_arguments(content: Any, robot: RobotDescription) -> dict[str, str]:
    """Returns the robot's arguments, and the prefixes of names that the file requires.

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
    empty = dict.fromkeys(_of_frames(content), "")
    return {**empty, **shortest, **robot.arguments}


def with_arguments(text: str, arguments: Mapping[str, str]) -> str:
    """A text in which known arguments are replaced by their values."""
    return _ARGUMENT.sub(lambda match: arguments.get(match[1], match[0]), text)


def _of_frames(content: Any) -> set[str]:
    """Names of arguments that only precede the names of frames, in values of keys with `frame`."""
    frames, others = set[str](), set[str]()

    def walk(node: Any, key: str) -> None:
        if isinstance(node, Mapping):
            for name, value in node.items():
                others.update(_ARGUMENT.findall(str(name)))
                walk(value, str(name))
        elif isinstance(node, list):
            for value in node:
                walk(value, key)
        elif isinstance(node, str):
            prefixes = {name for name, _ in _BEFORE_NAME.findall(node)} if "frame" in key else set()
            frames.update(prefixes)
            others.update(set(_ARGUMENT.findall(node)) - prefixes)

    walk(content, "")
    return frames - others


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
