"""ROS 2 message classes, rosbags' own and those made from our definitions.

A definition is the text of ROS 1 and ROS 2 alike: the ROS 1 bridge reads the same files
into its own store, where they have the md5 sums that ROS 1 nodes expect. Types that only
ROS 2 has are in a folder of their own, which ROS 1's store does not see. Some packages have
different types of the same names in ROS 1 and ROS 2: here ROS 2's have a package of their own, and
so have types of older releases of ROS 2.
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cartwheel.codes.graph import MESSAGE_TYPE_UNKNOWN
from cartwheel.errors import UnknownNameError

DEFINITIONS = Path(__file__).parent / "definitions"
"""Holds ``<package>/msg/<Name>.msg`` and ``<package>/srv/<Name>.srv``."""
ROS2_DEFINITIONS = Path(__file__).parent / "definitions_ros2"
"""The same, of types that ROS 1 does not have."""

SEPARATOR = "---\n"
"""Between the parts of a service and of an action."""

TWIN = "_ros2"
"""Ends the name that a package has here where ROS 1 has another of that name."""
FIRST = "_v1"
"""Ends the name of a package that holds the first version of types that have two in ROS 2."""

_GOAL_ID = "unique_identifier_msgs/UUID goal_id\n"


_learning = threading.RLock()


@functools.cache
def loaded() -> Any:
    """The typestore as far as it was asked for: it has the type of every message there is."""
    # rosbags takes as long to import as the rest of a command does to run, and many
    # commands see no message.
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


@functools.cache
def store() -> Any:
    """The typestore, complete: Jazzy's types and all of ours. What needs no others is quicker
    with `loaded`.
    """
    made = loaded()
    with _learning:
        ours = parsed_definitions() | parsed_definitions(ROS2_DEFINITIONS)
        made.register({name: ours[name] for name in ours if name not in made.fielddefs})
    return made


def _learn(name: str) -> bool:
    """Loads one of our types, with those within it; False where there is none of that name."""
    made = loaded()
    with _learning:
        if name in made.types:
            return True
        text = _texts().get(name)
        if text is None:
            return False
        constants, fields = _parsed(name, text)
        for _, kind in fields:
            _learn_within(kind)
        made.register({name: (constants, fields)})
    return True


def _learn_within(kind: Any) -> None:
    from rosbags.interfaces import Nodetype

    node, value = kind
    if node == Nodetype.NAME:
        _learn(value)
    elif node != Nodetype.BASE:
        _learn_within(value[0])


@functools.cache
def _texts() -> dict[str, str]:
    """All of our types, of both kinds."""
    return {**dict(definitions()), **dict(definitions(ROS2_DEFINITIONS))}


def _parsed(name: str, text: str) -> Any:
    from rosbags.typesys import get_types_from_msg

    # The parser has names of its own for a service's parts: ours count.
    (fields,) = get_types_from_msg(text, name).values()
    return fields


@functools.cache
def parsed_definitions(folder: Path = DEFINITIONS) -> dict[str, Any]:
    """Our types and their fields, as rosbags describes them."""
    return {name: _parsed(name, text) for name, text in definitions(folder)}


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
    ours = _ros2_names()
    return name in ours or f"{name}_Request" in ours


@functools.cache
def _ros2_names() -> frozenset[str]:
    return frozenset(name for name, _ in definitions(ROS2_DEFINITIONS))


def type_name(name: str) -> str:
    """The ROS 2 name of a message type: ``geometry_msgs/Twist`` is ``geometry_msgs/msg/Twist``."""
    package, _, rest = name.partition("/")
    return name if "/" in rest else f"{package}/msg/{rest}"


def service_name(name: str) -> str:
    """The ROS 2 name of a service type: ``std_srvs/Empty`` is ``std_srvs/srv/Empty``."""
    package, _, rest = name.partition("/")
    return name if "/" in rest else f"{package}/srv/{rest}"


def message_class(name: str) -> Any:
    """The class of a message type; a dataclass with one field for each of the message's.

    Raises:
        UnknownNameError: There is no such type.
    """
    full = type_name(name)
    types = loaded().types
    if full not in types and not _learn(full):
        raise UnknownNameError("message type", name, store().types, code=MESSAGE_TYPE_UNKNOWN)
    return types[full]


def service_classes(name: str) -> tuple[Any, Any]:
    """The request's and the response's class of a service type ``pkg/srv/Name`` or ``pkg/Name``.

    Raises:
        UnknownNameError: There is no such type.
    """
    full = service_name(name)
    if not _learn(f"{full}_Request"):
        known = [key.removesuffix("_Request") for key in store().types if key.endswith("_Request")]
        raise UnknownNameError("service type", name, known, code=MESSAGE_TYPE_UNKNOWN)
    return message_class(f"{full}_Request"), message_class(f"{full}_Response")
