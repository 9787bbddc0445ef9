"""Functions that create messages of one type, in which the same fields are set each time."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

from cartwheel.codes.graph import FIELD_UNKNOWN
from cartwheel.errors import GraphError
from cartwheel.messages.convert import from_dict
from cartwheel.messages.field import Field
from cartwheel.messages.fields import fields
from cartwheel.messages.forms import Form

Maker = Callable[[Sequence[float]], Any]
"""Creates a message from the values of its fields."""
MOST_ELEMENTS = 10_000
"""Maximum number of elements of an array."""
_PART = re.compile(r"([A-Za-z_]\w*)((?:\[\d+\])*)")
_INDEX = re.compile(r"\d+")
_FIRST = re.compile(r"\[:(\d+)\]")


def maker(type_name: str, names: Sequence[str]) -> Maker:
    """Returns a function that creates messages, as `from_dict` does, but faster.

    All other fields have their default values. They are the same objects in all messages.

    Args:
        type_name: ``pkg/msg/Name``.
        names: Fields that are numbers, such as ``linear.x`` or ``data[2]``. An array is as long as
            its highest index requires, and other numbers in it are 0.

    Raises:
        GraphError: The type does not have a field, or it cannot be a number.
        UnknownNameError: The type does not exist.
    """
    paths = [_path(name) for name in names]
    template = from_dict(type_name, _filled(type_name, _tree(paths, [0.0] * len(names))))
    places = _tree(paths, range(len(names)))
    if _are_floats(type_name, places):
        return Form(template, *names).message
    return lambda values: from_dict(type_name, _filled(type_name, _tree(paths, values)))


def expanded(name: str) -> list[str]:
    """The fields that a name stands for: ``data[:2]`` is ``data[0]`` and ``data[1]``.

    Raises:
        GraphError: The array is too long or empty.
    """
    match = _FIRST.search(name)
    if match is None:
        return [name]
    count = int(match[1])
    if not 0 < count <= MOST_ELEMENTS:
        raise _no_field(name, f"an array must have 1 to {MOST_ELEMENTS} elements")
    start, end = match.span()
    return [
        each for index in range(count) for each in expanded(f"{name[:start]}[{index}]{name[end:]}")
    ]


def _path(name: str) -> list[str | int]:
    """The names and indices of a field, from the outside to the inside."""
    path: list[str | int] = []
    for part in name.split("."):
        match = _PART.fullmatch(part)
        if match is None:
            raise _no_field(name, "it is not the name of a field")
        path += [match[1], *map(int, _INDEX.findall(match[2]))]
    for each in path:
        if isinstance(each, int) and each >= MOST_ELEMENTS:
            raise _no_field(name, f"the highest index is {MOST_ELEMENTS - 1}")
    return path


def _no_field(name: str, why: str) -> GraphError:
    return GraphError(
        f'"{name}" cannot be set: {why}', code=FIELD_UNKNOWN, values={"field": name},
        hint="Examples are linear.x, data[2] and data[:3].",
    )  # fmt: skip


def _tree(paths: Sequence[Sequence[str | int]], values: Sequence[Any]) -> dict[str | int, Any]:
    """Values by the names and indices of their paths."""
    tree: dict[str | int, Any] = {}
    for (*parents, last), value in zip(paths, values, strict=True):
        inside = tree
        for parent in parents:
            inside = inside.setdefault(parent, {})
        inside[last] = value
    return tree


def _filled(type_name: str, tree: dict[str | int, Any]) -> dict[str, Any]:
    """The mapping of a message, with arrays as lists."""
    known = {field.name: field for field in fields(type_name)}
    made: dict[str, Any] = {}
    for key, value in tree.items():
        name = str(key)
        field = known.get(name)
        if field is None:
            made[name] = value  # `from_dict` reports it
        elif field.array:
            if not isinstance(value, dict) or not all(isinstance(each, int) for each in value):
                raise _no_field(name, f"it is an array ({field.described})")
            count = field.length or max(value) + 1
            if max(value) >= count:
                raise _no_field(f"{name}[{max(value)}]", f"its type is {field.described}")
            nested = field.kind == "message"
            items = [value.get(index, {} if nested else 0) for index in range(count)]
            made[name] = [_inner(field, each) for each in items] if nested else items
        else:
            made[name] = _inner(field, value)
    return made


def _inner(field: Field, value: Any) -> Any:
    """The mapping of a nested message, or the value itself."""
    nested = field.kind == "message" and isinstance(value, dict)
    return _filled(field.type, value) if nested else value


def _are_floats(type_name: str, places: dict[str | int, Any]) -> bool:
    """Whether the fields have these names in the class, and need no conversion."""
    known = {field.name: field for field in fields(type_name) if not field.array}
    for name, place in places.items():
        field = known.get(str(name))
        if field is None:
            return False
        if isinstance(place, dict):
            if field.kind != "message" or not _are_floats(field.type, place):
                return False
        elif field.kind != "float":
            return False
    return True
