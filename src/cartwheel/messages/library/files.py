"""Reads the files of message types: ``.msg``, ``.srv`` and ``.action``."""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterator
from pathlib import Path

from cartwheel.codes.graph import MESSAGE_DEFINITION_INVALID
from cartwheel.errors import GraphError, Origin
from cartwheel.messages.definition import Definition, Dialect
from cartwheel.messages.learnt import ACTION_PARTS, ROS1_ACTION_PARTS
from cartwheel.messages.library.parsing import LARGEST, parse_definition
from cartwheel.messages.store import action_parts

_SEPARATOR = re.compile(r"^[ \t]*---[ \t]*$", re.MULTILINE)
_ROS1_SIGNS = (b"catkin", b"message_generation", b"message_runtime")
_ROS2_SIGNS = (b"ament_", b"rosidl_")
_XML_COMMENT = re.compile(rb"<!--.*?(?:-->|\Z)", re.DOTALL)
_ROS1_ACTION = {
    "ActionGoal": "std_msgs/Header header\nactionlib_msgs/GoalID goal_id\n{name}Goal goal\n",
    "ActionResult": (
        "std_msgs/Header header\nactionlib_msgs/GoalStatus status\n{name}Result result\n"
    ),
    "ActionFeedback": (
        "std_msgs/Header header\nactionlib_msgs/GoalStatus status\n{name}Feedback feedback\n"
    ),
    "Action": (
        "{name}ActionGoal action_goal\n{name}ActionResult action_result\n"
        "{name}ActionFeedback action_feedback\n"
    ),
}
"""Types that ROS 1 generates for an action. Source: actionlib_msgs, genaction."""


def stems(kind: str, last: str) -> Iterator[tuple[str, str]]:
    """The folders and file names that may define a type."""
    if kind == "srv":
        yield "srv", re.sub(r"_(Request|Response)\Z", "", last)
    elif kind == "action":
        yield "action", re.sub(rf"_({'|'.join(ACTION_PARTS)})\Z", "", last)
    else:
        yield "msg", last
        for part in sorted(ROS1_ACTION_PARTS, key=len, reverse=True):
            if last.endswith(part) and last != part:
                yield "action", last.removesuffix(part)
                return


def parse_file(
    name: str, text: str, origin: Origin, *, dialect: Dialect | None, own_header: bool
) -> list[Definition]:
    """The definitions in a file, including those that ROS generates for an action.

    Args:
        name: The type's full name, such as ``pkg/srv/Name``.
        text: The file's content.
        origin: The file.
        dialect: The ROS version of the file's package; None if unknown.
        own_header: The package defines its own ``Header``.

    Raises:
        GraphError: The content is invalid.
    """
    kind = name.split("/")[1]
    parts = [(name, text, 1)] if kind == "msg" else list(_split(name, text, origin))
    made = [
        parse_definition(
            part,
            content,
            Origin(file=origin.file, line=line),
            dialect=dialect,
            own_header=own_header,
        )
        for part, content, line in parts
    ]
    return [*made, *_generated(name, made, origin)] if kind == "action" else made


def _split(name: str, text: str, origin: Origin) -> Iterator[tuple[str, str, int]]:
    """The parts of a service or action, with the lines at which they begin."""
    is_service = "/srv/" in name
    titles = ("Request", "Response") if is_service else ("Goal", "Result", "Feedback")
    parts = _SEPARATOR.split(text)
    if len(parts) != len(titles):
        raise GraphError(
            f'{"a service" if is_service else "an action"} definition must contain "---" '
            f"{len(titles) - 1} times (got {len(parts) - 1})",
            code=MESSAGE_DEFINITION_INVALID,
            origin=origin,
            values={"type": name, "count": len(parts) - 1},
        )
    line = 1
    for title, part in zip(titles, parts, strict=True):
        yield f"{name}_{title}", part.removeprefix("\n"), line + part.startswith("\n")
        line += part.count("\n")


def _generated(name: str, parts: list[Definition], origin: Origin) -> Iterator[Definition]:
    """The types that ROS 1 and ROS 2 generate for an action."""
    package, _, last = name.split("/")
    for part, text in action_parts(name):
        yield parse_definition(part, text, origin)
    for definition in parts:
        yield Definition(
            name=f"{package}/msg/{last}{definition.name.rpartition('_')[2]}",
            dialect=definition.dialect,
            text=definition.text,
            origin=definition.origin,
            constants=definition.constants,
            fields=definition.fields,
        )
    for part, text in _ROS1_ACTION.items():
        yield parse_definition(f"{package}/msg/{last}{part}", text.format(name=last), origin)


def content(path: Path, origin: Origin) -> bytes:
    """The first bytes of a file, at most one more than a definition may have.

    Raises:
        GraphError: The file cannot be read.
    """
    try:
        # A pipe would block, and a device may be endless.
        with open(os.open(path, os.O_RDONLY | os.O_NONBLOCK), "rb") as file:  # noqa: PTH123
            if stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                return file.read(LARGEST + 1)
            reason = "it is not a regular file"
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
    raise GraphError(
        f"the file cannot be read: {reason}",
        code=MESSAGE_DEFINITION_INVALID,
        origin=origin,
        values={"name": str(path)},
    )


def dialect_of(folder: Path) -> Dialect | None:
    """The ROS version for which a package is built, if its manifest states only one."""
    try:
        with (folder / "package.xml").open("rb") as file:
            text = _XML_COMMENT.sub(b"", file.read(1 << 16))
    except OSError:
        return None
    first = any(sign in text for sign in _ROS1_SIGNS)
    second = any(sign in text for sign in _ROS2_SIGNS)
    if first == second:
        return None
    return "ros1" if first else "ros2"
