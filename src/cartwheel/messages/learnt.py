"""Types that Cartwheel does not contain, after they were found or received.

The classes of messages are shared by the whole process, like those of the built-in types: encoders,
decoders and callers know types by name. A name therefore has one meaning per process, and a second
meaning is an error. Each simulation decides by itself which types it can see; see `TypeLibrary`.
"""

from __future__ import annotations

import functools
import keyword
import math
import re
from collections.abc import Callable, Iterable, Iterator
from typing import Any, Literal

from cartwheel.codes.graph import MESSAGE_TYPE_IN_USE
from cartwheel.errors import GraphError, Origin
from cartwheel.messages.definition import (
    RECORDING,
    TIMES,
    DefinedConstant,
    DefinedField,
    Definition,
)
from cartwheel.messages.store import is_bundled, learning, loaded, message_class

_by_name: dict[str, Definition] = {}
"""All types in the order in which they were registered. Nothing is ever removed or replaced."""


def learnt(name: str) -> Definition | None:
    """The definition of a registered type."""
    return _by_name.get(name)


def learnt_since(count: int) -> list[Definition]:
    """All registered types except the first ones."""
    with learning:
        return list(_by_name.values())[count:] if len(_by_name) > count else []


def register(definitions: Iterable[Definition]) -> None:
    """Registers types. Nested types come before the types that contain them.

    Raises:
        GraphError: A name is registered with different fields.
    """
    with learning:
        new = [each for each in definitions if not _is_known(each)]
        made = loaded()
        for each in new:
            constants, fields = each.fielddefs()
            odd = [one for one in constants if _is_odd(one)]
            # rosbags writes constants into Python code, where infinity and NaN have no literal.
            made.register({each.name: ([one for one in constants if one not in odd], fields)})
            made.fielddefs[each.name] = (constants, made.fielddefs[each.name][1])
            made.types.state_defaults(
                each.name, {field.name: field.default for field in each.fields}
            )
            for name, _, value in odd:
                setattr(made.types[each.name], name, value)
            _accept_keywords(made.types[each.name], [field.name for field in each.fields])
            _by_name[each.name] = each


def _is_odd(constant: tuple[str, str, Any]) -> bool:
    """Whether a constant is a floating-point number without a literal in Python."""
    _, kind, value = constant
    return kind.startswith("float") and not math.isfinite(value)


def _is_known(one: Definition) -> bool:
    if is_bundled(one.name):
        return True
    known = _by_name.get(one.name)
    if known is None:
        return False
    if known.same_as(one):
        return True
    raise GraphError(
        f"the definition of {one.name} differs from the one in {known.origin.file}, which this "
        "process already uses",
        code=MESSAGE_TYPE_IN_USE,
        origin=one.origin,
        hint="If the definition was edited, start a new process. If two workspaces define the "
        "type differently, use a separate process for each.",
        values={"type": one.name, "file": one.origin.file, "other": known.origin.file},
    )


def needed(name: str) -> Iterator[Definition]:
    """The registered definitions of a type and its nested types, nested ones first.

    Args:
        name: A message type, or a service or action, whose parts are included.
    """
    made: dict[str, Definition] = {}
    stack = [(each, False) for each in parts_of(name) if each in _by_name]
    while stack:
        each, done = stack.pop()
        if done:
            made.setdefault(each, _by_name[each])
        elif each not in made:
            stack.append((each, True))
            stack += [(used.type, False) for used in _by_name[each].uses if used.type in _by_name]
    yield from made.values()


def text_with_nested(
    full: str, version: Literal[1, 2], made: Any, title: Callable[[str], str]
) -> str:
    """The definition of a registered type with all nested types, as in recordings.

    Args:
        full: The type.
        version: The version of ROS.
        made: The typestore of that version, with the built-in types.
        title: Returns a type's name for its heading.
    """
    texts: dict[str, str] = {}
    waiting = [full]
    while waiting:
        name = waiting.pop()
        if name in texts or (version == 1 and name in TIMES.values()):
            continue
        known = learnt(name)
        if known is not None:
            texts[name] = known.written(version)
            waiting += [used.type for used in reversed(known.uses)]
        else:
            nested: dict[str, tuple[str, str]] = {}
            if version == 2:
                message_class(name)
            texts[name], _ = made.gendefhash(name, nested, version)
            texts.update({each: text for each, (text, _) in nested.items() if each not in texts})
    line = "=" * 80
    return texts.pop(full) + "".join(
        f"{line}\nMSG: {title(name)}\n{text}" for name, text in texts.items()
    )


def parts_of(name: str) -> list[str]:
    """The message types of a message, service or action type, or of a part of one."""
    if _PART.search(name):
        return [name]
    if "/srv/" in name:
        return [f"{name}_Request", f"{name}_Response"]
    if "/action/" in name:
        package, _, last = name.split("/")
        return [
            *(f"{name}_{part}" for part in ACTION_PARTS),
            *(f"{package}/msg/{last}{part}" for part in ROS1_ACTION_PARTS),
        ]
    return [name]


ACTION_PARTS = (
    "Goal",
    "Result",
    "Feedback",
    "SendGoal_Request",
    "SendGoal_Response",
    "GetResult_Request",
    "GetResult_Response",
    "FeedbackMessage",
)
_PART = re.compile(rf"/srv/\w+_(Request|Response)\Z|/action/\w+_({'|'.join(ACTION_PARTS)})\Z")
ROS1_ACTION_PARTS = (
    "Goal",
    "Result",
    "Feedback",
    "ActionGoal",
    "ActionResult",
    "ActionFeedback",
    "Action",
)


def recorded(name: str, fielddefs: Any) -> Definition:
    """The definition of a type that a recording or a client describes in the form of rosbags."""
    from rosbags.interfaces import Nodetype

    constants, described = fielddefs
    fields = []
    for field, (node, value) in described:
        array = node in (Nodetype.ARRAY, Nodetype.SEQUENCE)
        (inner, about), size = value if array else ((node, value), 0)
        fields.append(
            DefinedField(
                name=field,
                type=about if inner == Nodetype.NAME else about[0],
                line=0,
                longest=0 if inner == Nodetype.NAME else about[1],
                array=array,
                length=size if node == Nodetype.ARRAY else None,
                most=size if node == Nodetype.SEQUENCE else 0,
            )
        )
    made = Definition(
        name=name,
        dialect="ros2",
        text="",
        origin=Origin(file=RECORDING),
        constants=tuple(
            DefinedConstant(type=kind, name=constant, value=value, text=str(value))
            for constant, kind, value in constants
        ),
        fields=tuple(fields),
    )
    text = "".join(f"{line}\n" for line in made.lines(2))
    return Definition(
        name=name,
        dialect="ros2",
        text=text,
        origin=made.origin,
        constants=made.constants,
        fields=made.fields,
    )


def _accept_keywords(made: Any, names: list[str]) -> None:
    """Lets fields have the names of Python keywords. rosbags appends ``_`` to their names."""
    words = {name: f"{name}_" for name in names if keyword.iskeyword(name)}
    if not words:
        return
    create = made.__init__

    @functools.wraps(create)
    def init(self: Any, *values: Any, **named: Any) -> None:
        create(self, *values, **{words.get(name, name): value for name, value in named.items()})

    made.__init__ = init
    for name, attribute in words.items():
        setattr(made, name, _alias(attribute))


def _alias(attribute: str) -> property:
    return property(
        lambda self: getattr(self, attribute),
        lambda self, value: setattr(self, attribute, value),
    )
