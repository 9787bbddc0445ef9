"""Decoding of recorded messages, whose types may be defined by the recording."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

from rosbags.interfaces import Nodetype

from cartwheel.bridges.recording.reading import RecordedTopic
from cartwheel.codes.recording import RECORDED_TYPE_UNUSABLE
from cartwheel.errors import CartwheelError, RecordingError, Value
from cartwheel.messages import decode_cdr
from cartwheel.messages.classes import FILLER
from cartwheel.messages.learnt import learnt, recorded, register
from cartwheel.messages.ros1 import decode_ros1, ros1_type
from cartwheel.messages.ros1.types import ros1_store
from cartwheel.messages.ros2.types import twin_name
from cartwheel.messages.store import exists, fields_of

_LONGEST = 1 << 20
"""Maximum length in characters of a definition with all nested types."""
_LONGEST_ARRAY = 10_000
"""Maximum length of a fixed array of strings or messages."""
_MOST_NUMBERS = 1 << 30
"""Maximum length of a fixed array of numbers."""
_NO_CODE = re.compile(r'"(?:[^"\\]|\\(?:.|\Z))*(?:"|\Z)|//[^\n]*|/\*.*?(?:\*/|\Z)', re.DOTALL)
"""Strings and comments in IDL. An unterminated one extends to the end of the text. Otherwise the
search would run to the end of the text for each unterminated start."""
Decode = Callable[[bytes], Any]


def decoder(topic: RecordedTopic) -> Decode:
    """Returns the decoder for a topic. A type that is still unknown is registered.

    Raises:
        RecordingError: The topic does not contain ROS messages, or its type has the name but not
            the fields of a known type.
    """
    if topic.encoding not in ("cdr", "ros1"):
        stated = topic.encoding or "unknown"
        message = f"the messages on {topic.name} are not ROS messages (encoding: {stated})"
        raise _unusable(topic, "encoding", message, encoding=topic.encoding)
    kind = topic.type
    try:
        _learn(topic)
        if topic.encoding == "ros1":
            known = ros1_type(kind)
            if topic.md5 not in ("", "*", known.md5):
                raise _other_fields(topic, kind)
            return lambda data: decode_ros1(data, kind)
        kind = _in_graph(kind, topic)
        if not exists(kind):
            message = f"has the type {kind}, which is unknown and not defined in the recording"
            raise _unusable(topic, "unknown", f"{topic.name} {message}", type=kind)
    except (RecordingError, MemoryError):
        raise
    except CartwheelError as error:
        message = f"the type of {topic.name} cannot be used: {error.message}"
        raise _unusable(topic, error.code.number, message, **error.values) from error
    except Exception as error:  # rosbags compiles definitions, and detects errors only then
        message = f"the type definition of {topic.name} cannot be used: {error}"
        raise _unusable(topic, "definition", message) from error
    return lambda data: decode_cdr(data, kind)


def _learn(topic: RecordedTopic) -> None:
    if not topic.definition or topic.schema not in ("ros1msg", "ros2msg", "ros2idl"):
        return
    types = _parsed(topic)
    for name, (_, fields) in types.items():
        _check_names(topic, name, fields)
        _check_arrays(topic, name, fields)
    ordered = _nested_first(topic, types)
    _check_complete(topic, types)
    if topic.encoding == "cdr":
        for name, (_, fields) in types.items():
            if exists(twin_name(name)):
                continue
            if exists(name) and _plain(_known_fields(name)) != _plain(fields):
                raise _other_fields(topic, name)
    new = [name for name in ordered if not exists(name)]
    if topic.encoding == "ros1":
        known = ros1_store().fielddefs
        known.update({name: fields for name, fields in types.items() if name not in known})
    register(recorded(name, types[name]) for name in new)


def _known_fields(name: str) -> Any:
    """The fields of a known type, with the types as in its definition."""
    known = learnt(name)
    return fields_of(name) if known is None else known.fielddefs(hashed=True)[1]


def _nested_first(topic: RecordedTopic, types: dict[str, Any]) -> list[str]:
    """The names of types in an order in which nested types come first.

    Raises:
        RecordingError: A type contains itself.
    """
    ordered: list[str] = []
    left = dict(types)
    while left:
        flat = [
            name
            for name, (_, fields) in left.items()
            if not any(used in left for _, used in _elements(fields))
        ]
        if not flat:
            message = f"{topic.name}: the type {min(left)} contains itself"
            raise _unusable(topic, "recursive", message, type=min(left))
        ordered += flat
        for name in flat:
            del left[name]
    return ordered


def _in_graph(kind: str, topic: RecordedTopic) -> str:
    """The graph's name of a ROS 2 type whose name may have a different meaning in ROS 1."""
    twin = twin_name(kind)
    if not exists(twin):
        return kind
    stated = _parsed(topic).get(kind) if topic.definition else None
    if stated is None or _plain(stated[1]) == _plain(fields_of(twin)):
        return twin
    if exists(kind) and _plain(stated[1]) == _plain(fields_of(kind)):
        return kind
    raise _other_fields(topic, kind)


def _parsed(topic: RecordedTopic) -> dict[str, Any]:
    from rosbags.typesys import get_types_from_idl, get_types_from_msg

    text, subject = topic.definition, f"the type definition of {topic.name}"
    if len(text) > _LONGEST:
        message = f"{subject} has {len(text)} characters; the limit is {_LONGEST}"
        raise _unusable(topic, "length", message)
    if topic.schema == "ros2idl" and _has_nested_parentheses(text):
        raise _unusable(topic, "parentheses", f"{subject} contains nested parentheses")
    try:
        if topic.schema == "ros2idl":
            return dict(get_types_from_idl(text))
        return dict(get_types_from_msg(text, topic.type))
    except Exception as error:  # Any error of the parser. Its text contains the whole definition.
        raise _unusable(topic, "definition", f"{subject} cannot be parsed") from error


def _has_nested_parentheses(idl: str) -> bool:
    """Whether the text contains nested parentheses. Each level makes parsing 70 times slower.

    ROS does not write nested parentheses.
    """
    depth = 0
    for sign in re.findall(r"[()]", _NO_CODE.sub("", idl)):
        depth += 1 if sign == "(" else -1
        if depth > 1:
            return True
    return False


def _check_names(topic: RecordedTopic, name: str, fields: Any) -> None:
    """Rejects invalid names, because rosbags generates Python code that contains them."""
    words = [*name.split("/"), *(field[0] for field in fields)]
    if not all(word.isidentifier() for word in words):
        message = f"{topic.name}: {name} is not a valid type name, or has an invalid field name"
        raise _unusable(topic, "name", message, type=name)


def _check_arrays(topic: RecordedTopic, name: str, fields: Any) -> None:
    """Rejects long fixed arrays, as rosbags generates code per string or message in them."""
    for field, (kind, inner) in fields:
        if kind != Nodetype.ARRAY:
            continue
        (element, about), size = inner
        is_plain = element == Nodetype.BASE and "string" not in about[0]
        most = _MOST_NUMBERS if is_plain else _LONGEST_ARRAY
        if not 0 <= size <= most:
            message = f"the length of {name}.{field} must be between 0 and {most} (got {size})"
            raise _unusable(topic, "size", f"{topic.name}: {message}", type=name, field=field)


def _check_complete(topic: RecordedTopic, types: dict[str, Any]) -> None:
    """Rejects fields with undefined types, before the other types are registered."""
    for name, (_, fields) in types.items():
        for _, used in _elements(fields):
            if used in types:
                continue
            if not exists(used):
                message = f"{name} has a field of type {used}, which is not defined"
                raise _unusable(topic, "unknown", f"{topic.name}: {message}", type=used)
            fields_of(used)  # A type is registered after those of its fields.


def _elements(fields: Any) -> Iterator[tuple[int, Any]]:
    """Kinds and names of the types of fields and array elements."""
    for _, (kind, about) in fields:
        found = about[0] if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE) else (kind, about)
        if found[0] == Nodetype.NAME:
            yield found


def _plain(fields: Any) -> Any:
    """Fields as nested lists, since parsers differ in tuples, lists and empty types."""
    found = [_nested(field) for field in fields]
    return [field for field in found if field[0] != FILLER]


def _nested(value: Any) -> Any:
    return [_nested(item) for item in value] if isinstance(value, list | tuple) else value


def _other_fields(topic: RecordedTopic, kind: str) -> RecordingError:
    return RecordingError(
        f"the recorded definition of {kind} on {topic.name} has different fields from the known "
        "definition",
        code=RECORDED_TYPE_UNUSABLE,
        hint="The recording was made with a different version of this type.",
        values={"topic": topic.name, "type": kind, "why": "fields"},
    )


def _unusable(topic: RecordedTopic, why: str, message: str, /, **values: Value) -> RecordingError:
    values.update(topic=topic.name, why=why)
    return RecordingError(message, code=RECORDED_TYPE_UNUSABLE, values=values)
