"""Functions that create messages of one type, in which the same fields are set each time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from cartwheel.messages.convert import from_dict
from cartwheel.messages.fields import fields
from cartwheel.messages.store import message_class

Maker = Callable[[Sequence[float]], Any]
"""Creates a message from the values of its fields."""


def maker(type_name: str, names: Sequence[str]) -> Maker:
    """Returns a function that creates messages, as `from_dict` does, but faster.

    All other fields have their default values. They are the same objects in all messages.

    Args:
        type_name: ``pkg/msg/Name``.
        names: Fields that are numbers, such as ``linear.x``.

    Raises:
        GraphError: The type does not have a field, or it cannot be a number.
        UnknownNameError: The type does not exist.
    """
    paths = [name.split(".") for name in names]
    template = from_dict(type_name, _tree(paths, [0.0] * len(names)))
    places = _tree(paths, range(len(names)))
    if _are_floats(type_name, places):
        return _maker(type_name, places, template)
    return lambda values: from_dict(type_name, _tree(paths, values))


def _tree(paths: Sequence[Sequence[str]], values: Sequence[Any]) -> dict[str, Any]:
    tree: dict[str, Any] = {}
    for (*parents, last), value in zip(paths, values, strict=True):
        inside = tree
        for parent in parents:
            inside = inside.setdefault(parent, {})
        inside[last] = value
    return tree


def _are_floats(type_name: str, places: dict[str, Any]) -> bool:
    """Whether the fields have these names in the class, and need no conversion."""
    known = {field.name: field for field in fields(type_name) if not field.array}
    for name, place in places.items():
        field = known.get(name)
        if field is None:
            return False
        if isinstance(place, dict):
            if field.kind != "message" or not _are_floats(field.type, place):
                return False
        elif field.kind != "float":
            return False
    return True


def _maker(type_name: str, places: dict[str, Any], template: Any) -> Maker:
    make = message_class(type_name)
    # The name of each field, which values set it, and how.
    constant: dict[str, Any] = {}
    given: list[tuple[str, int]] = []
    nested: list[tuple[str, Maker]] = []
    for field in fields(type_name):
        place, value = places.get(field.name), getattr(template, field.name)
        if place is None:
            constant[field.name] = value
        elif isinstance(place, dict):
            nested.append((field.name, _maker(field.type, place, value)))
        else:
            given.append((field.name, place))

    def message(values: Sequence[float]) -> Any:
        found = constant.copy()
        for name, index in given:
            found[name] = values[index]
        for name, made in nested:
            found[name] = made(values)
        return make(**found)

    return message
