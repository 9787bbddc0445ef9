"""ROS 2 message classes, rosbags' own and those made from our definitions.

A definition is the text of ROS 1 and ROS 2 alike: the ROS 1 bridge reads the same files
into its own store, where they have the md5 sums that ROS 1 nodes expect. Types that only
ROS 2 has are in a folder of their own, which ROS 1's store does not see. Some packages have
different types of the same names in ROS 1 and ROS 2: here ROS 2's have a package of their own.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cartwheel.errors import UnknownNameError

DEFINITIONS = Path(__file__).parent / "definitions"
"""Holds ``<package>/msg/<Name>.msg`` and ``<package>/srv/<Name>.srv``."""
ROS2_DEFINITIONS = Path(__file__).parent / "definitions_ros2"
"""The same, of types that ROS 1 does not have."""

SEPARATOR = "---\n"
"""Between the parts of a service and of an action."""

TWIN = "_ros2"
"""Ends the name that a package has here where ROS 1 has another of that name."""

_GOAL_ID = "unique_identifier_msgs/UUID goal_id\n"


@functools.cache
def store() -> Any:
    """The typestore: Jazzy's types and those of `DEFINITIONS`."""
    # rosbags takes as long to import as the rest of a command does to run, and many
    # commands see no message.
    from rosbags.typesys import Stores, get_typestore

    made = get_typestore(Stores.ROS2_JAZZY)
    ours = parsed_definitions() | parsed_definitions(ROS2_DEFINITIONS)
    made.register({name: ours[name] for name in ours if name not in made.fielddefs})
    return made


@functools.cache
def parsed_definitions(folder: Path = DEFINITIONS) -> dict[str, Any]:
    """Our types and their fields, as rosbags describes them."""
    from rosbags.typesys import get_types_from_msg

    ours: dict[str, Any] = {}
    for name, text in definitions(folder):
        # The parser has names of its own for a service's parts: ours count.
        (ours[name],) = get_types_from_msg(text, name).values()
    return ours


def definitions(folder: Path = DEFINITIONS) -> Iterator[tuple[str, str]]:
    """Our types with their texts: messages, and the parts of services and actions.

    A service ``pkg/srv/Name`` has the parts ``pkg/srv/Name_Request`` and ``…_Response``, an
    action ``pkg/action/Name`` those that ROS 2 makes of it.
    """
    for path in sorted(folder.glob("*/msg/*.msg")):
        yield f"{path.parent.parent.name}/msg/{path.stem}", path.read_text()
    for path in sorted(folder.glob("*/srv/*.srv")):
        request, _, response = path.read_text().partition(SEPARATOR)
        service = f"{path.parent.parent.name}/srv/{path.stem}"
        yield f"{service}_Request", request
        yield f"{service}_Response", response
    for path in sorted(folder.glob("*/action/*.action")):
        yield from _action(f"{path.parent.parent.name}/action/{path.stem}", path.read_text())


def _action(name: str, text: str) -> Iterator[tuple[str, str]]:
    """Source: rosidl's design of actions."""
    goal, result, feedback = text.split(SEPARATOR)
    yield f"{name}_Goal", goal
    yield f"{name}_Result", result
    yield f"{name}_Feedback", feedback
    yield f"{name}_SendGoal_Request", f"{_GOAL_ID}{name}_Goal goal\n"
    yield f"{name}_SendGoal_Response", "bool accepted\nbuiltin_interfaces/Time stamp\n"
    yield f"{name}_GetResult_Request", _GOAL_ID
    yield f"{name}_GetResult_Response", f"int8 status\n{name}_Result result\n"
    yield f"{name}_FeedbackMessage", f"{_GOAL_ID}{name}_Feedback feedback\n"


def is_ros2_only(name: str) -> bool:
    """Whether a message or service type is one of those that ROS 1 cannot know."""
    ours = parsed_definitions(ROS2_DEFINITIONS)
    return name in ours or f"{name}_Request" in ours


def type_name(name: str) -> str:
    """The ROS 2 name of a message type: ``geometry_msgs/Twist`` is ``geometry_msgs/msg/Twist``."""
    package, _, rest = name.partition("/")
    return name if "/" in rest else f"{package}/msg/{rest}"


def message_class(name: str) -> Any:
    """The class of a message type; a dataclass with one field for each of the message's.

    Raises:
        UnknownNameError: There is no such type.
    """
    full = type_name(name)
    types = store().types
    if full not in types:
        raise UnknownNameError("message type", name, types)
    return types[full]


def service_classes(name: str) -> tuple[Any, Any]:
    """The request's and the response's class of a service type ``pkg/srv/Name`` or ``pkg/Name``.

    Raises:
        UnknownNameError: There is no such type.
    """
    package, _, rest = name.partition("/")
    full = name if "/" in rest else f"{package}/srv/{rest}"
    types = store().types
    if f"{full}_Request" not in types:
        known = [key.removesuffix("_Request") for key in types if key.endswith("_Request")]
        raise UnknownNameError("service type", name, known)
    return types[f"{full}_Request"], types[f"{full}_Response"]
