"""ROS 2 message classes: those of rosbags, and those from Cartwheel's definitions.

Most definitions are identical in ROS 1 and ROS 2. The ROS 1 bridge reads the same files into a
separate store, where the types have the md5 sums that ROS 1 nodes expect. Types that exist only
in ROS 2 are in a separate folder, which the ROS 1 store does not read. Some packages contain
different types of the same names in ROS 1 and ROS 2. Here, the ROS 2 types are in a separate
package, and so are types from older ROS 2 releases.
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable, Iterable, Iterator
from contextvars import ContextVar, Token
from pathlib import Path
from typing import Any, Protocol

from cartwheel.codes.graph import MESSAGE_TYPE_UNKNOWN
from cartwheel.errors import UnknownNameError
from cartwheel.messages.classes import Classes
from cartwheel.options import PACKAGE_PATH

DEFINITIONS = Path(__file__).parent / "definitions"
"""Contains ``<package>/msg/<Name>.msg`` and ``<package>/srv/<Name>.srv``."""
ROS2_DEFINITIONS = Path(__file__).parent / "definitions_ros2"
"""Definitions of types that ROS 1 does not have, in the same layout."""

SEPARATOR = "---\n"
"""Separates the parts of a service or action definition."""

TWIN = "_ros2"
"""Suffix of a ROS 2 package whose name ROS 1 uses for different types."""
FIRST = "_v1"
"""Suffix of a package with the first version of ROS 2 types that have two versions."""

_GOAL_ID = "unique_identifier_msgs/UUID goal_id\n"


learning = threading.RLock()
"""Held while types are registered."""


class Finder(Protocol):
    """Finds types that Cartwheel does not contain; see `TypeLibrary`."""

    def find(self, name: str) -> bool:
        """Registers a type. Returns False if it does not exist."""


_finder: ContextVar[Finder | None] = ContextVar("finder", default=None)


class finding_with:  # noqa: N801 - used as a function
    """Lets `message_class` find further types during the block, in this thread.

    Args:
        finder: Finds the types.
    """

    __slots__ = ("_finder", "_token")

    def __init__(self, finder: Finder) -> None:
        self._finder = finder

    def __enter__(self) -> None:
        self._token: Token[Finder | None] = _finder.set(self._finder)

    def __exit__(self, *_: object) -> None:
        _finder.reset(self._token)


find_with: Callable[[Finder], object] = _finder.set
"""Changes the finder within a block of `finding_with`, which is faster than another block."""


def _find(name: str) -> bool:
    finder = _finder.get()
    return finder is not None and finder.find(name)


@functools.cache
def loaded() -> Any:
    """The typestore, which contains at least the types that have been used so far."""
    # Importing rosbags takes as long as running a typical command, and many commands use no
    # messages.
    from rosbags.typesys import Stores, get_typestore

    # rosbags shares its table of types between stores, so read it before types are added.
    _of_rosbags()
    made = get_typestore(Stores.ROS2_JAZZY)
    made.types = Classes(made.types, made.fielddefs, module=__name__)
    return made


@functools.cache
def store() -> Any:
    """The complete typestore: Jazzy's types and all of Cartwheel's. It takes half a second."""
    made = loaded()
    with learning:
        ours = parsed_definitions() | parsed_definitions(ROS2_DEFINITIONS)
        made.register({name: ours[name] for name in ours if name not in made.fielddefs})
    return made


def _learn(name: str) -> bool:
    """Loads one of Cartwheel's types and its nested types. Returns False if it does not exist."""
    made = loaded()
    with learning:
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


def exists(name: str) -> bool:
    """Whether a message type ``pkg/msg/Name`` or a part of a service or action exists."""
    return name in loaded().fielddefs or name in _texts()


def type_names() -> list[str]:
    """Names of all message types, and of all parts of services and actions, sorted."""
    return sorted({*loaded().fielddefs, *_texts()})


def fields_of(name: str) -> Any:
    """The fields of a message type that exists, in the form of rosbags."""
    _learn(name)
    return loaded().fielddefs[name][1]


def _learn_within(kind: Any) -> None:
    from rosbags.interfaces import Nodetype

    node, value = kind
    if node == Nodetype.NAME:
        _learn(value)
    elif node != Nodetype.BASE:
        _learn_within(value[0])


@functools.cache
def _texts() -> dict[str, str]:
    """Definitions of all of Cartwheel's types, including those that exist only in ROS 2."""
    return {**dict(definitions()), **dict(definitions(ROS2_DEFINITIONS))}


def _parsed(name: str, text: str) -> Any:
    from rosbags.typesys import get_types_from_msg

    # The parser renames the parts of a service, so keep the original name.
    (fields,) = get_types_from_msg(text, name).values()
    return fields


@functools.cache
def parsed_definitions(folder: Path = DEFINITIONS) -> dict[str, Any]:
    """Cartwheel's types and their fields, in the form of rosbags."""
    return {name: _parsed(name, text) for name, text in definitions(folder)}


def definitions(folder: Path = DEFINITIONS) -> Iterator[tuple[str, str]]:
    """Cartwheel's types with their definitions: messages, and the parts of services and actions.

    A service ``pkg/srv/Name`` consists of ``pkg/srv/Name_Request`` and ``…_Response``. An
    action ``pkg/action/Name`` consists of the parts that ROS 2 generates from it.
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
    goal, result, feedback = text.split(SEPARATOR)
    yield f"{name}_Goal", goal
    yield f"{name}_Result", result
    yield f"{name}_Feedback", feedback
    yield from action_parts(name)


def action_parts(name: str) -> Iterator[tuple[str, str]]:
    """The parts that ROS 2 generates for an action. Source: rosidl's design article on actions."""
    yield f"{name}_SendGoal_Request", f"{_GOAL_ID}{name}_Goal goal\n"
    yield f"{name}_SendGoal_Response", "bool accepted\nbuiltin_interfaces/Time stamp\n"
    yield f"{name}_GetResult_Request", _GOAL_ID
    yield f"{name}_GetResult_Response", f"int8 status\n{name}_Result result\n"
    yield f"{name}_FeedbackMessage", f"{_GOAL_ID}{name}_Feedback feedback\n"


def is_bundled(name: str) -> bool:
    """Whether Cartwheel contains a message type, or this part of a service or action."""
    return name in _texts() or name in _of_rosbags()


@functools.cache
def _of_rosbags() -> frozenset[str]:
    from rosbags.typesys import Stores, get_typestore

    return frozenset(get_typestore(Stores.ROS2_JAZZY).fielddefs)


def is_ros2_only(name: str) -> bool:
    """Whether a message or service type exists only in ROS 2."""
    ours = _ros2_names()
    return name in ours or f"{name}_Request" in ours


@functools.cache
def _ros2_names() -> frozenset[str]:
    return frozenset(name for name, _ in definitions(ROS2_DEFINITIONS))


def type_name(name: str) -> str:
    """ROS 2 name of a message type: ``geometry_msgs/Twist`` is ``geometry_msgs/msg/Twist``."""
    package, _, rest = name.partition("/")
    return name if "/" in rest else f"{package}/msg/{rest}"


def service_name(name: str) -> str:
    """ROS 2 name of a service type: ``std_srvs/Empty`` is ``std_srvs/srv/Empty``."""
    package, _, rest = name.partition("/")
    return name if "/" in rest else f"{package}/srv/{rest}"


def message_class(name: str) -> Any:
    """Class of a message type: a dataclass with the message's fields.

    Raises:
        UnknownNameError: The type does not exist.
    """
    full = type_name(name)
    types = loaded().types
    if full not in types and not _learn(full) and not _find(full):
        raise unknown_type("message type", name, type_names())
    return types[full]


def unknown_type(kind: str, name: str, known: Iterable[str]) -> UnknownNameError:
    """The error for a type that does not exist, which may be in a package that was not found.

    Args:
        kind: Such as ``service type``.
        name: Name of the type, or of a part of it.
        known: Names of types of this kind.
    """
    known = list(known)
    whole, _, part = name.rpartition("_")
    if "/action/" in name and part in ("Goal", "Result", "Feedback"):
        kind, name = "action type", whole
    error = UnknownNameError(kind, name, known, code=MESSAGE_TYPE_UNKNOWN)
    package = name.partition("/")[0]
    if not error.values["meant"] and package not in {each.partition("/")[0] for each in known}:
        error.hint = (
            f'If the package "{package}" is in your workspace, source the workspace, or add the '
            f"folder of the package: {PACKAGE_PATH.given('FOLDER')}."
        )
        error.values = {**error.values, "package": package}
    return error


def __getattr__(name: str) -> Any:
    """Class of a message type by its name in Python, such as ``std_msgs__msg__Header``.

    `pickle` finds the classes here.
    """
    if "__" not in name.strip("_"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        return message_class(name.replace("__", "/"))
    except UnknownNameError as error:
        raise AttributeError(error.message) from error


def service_classes(name: str) -> tuple[Any, Any]:
    """Request and response classes of a service type ``pkg/srv/Name`` or ``pkg/Name``.

    Raises:
        UnknownNameError: The type does not exist.
    """
    full = service_name(name)
    if not _learn(f"{full}_Request") and not _find(f"{full}_Request"):
        known = [key.removesuffix("_Request") for key in type_names() if key.endswith("_Request")]
        raise unknown_type("service type", name, known)
    return message_class(f"{full}_Request"), message_class(f"{full}_Response")
