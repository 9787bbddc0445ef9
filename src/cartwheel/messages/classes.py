"""Classes of messages. They behave like the dataclasses of rosbags, but are created in C.

Creating a message takes a third of the time, and Python's garbage collector does not visit them:
messages contain no references to themselves.
"""

from __future__ import annotations

import dataclasses
import functools
import keyword
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import msgspec
import numpy as np

from cartwheel.messages.defaults import STATED
from cartwheel.messages.field import Field, empty, field_of
from cartwheel.messages.singles import rounding

FILLER = "structure_needs_at_least_one_member"
"""Byte that ROS 2 adds to a message without fields. Its value has no meaning."""


class Classes(dict[str, Any]):
    """The classes of a typestore by type. They are converted when they are first looked up.

    Args:
        classes: The classes of rosbags.
        definitions: Constants and fields by type, in the form of rosbags.
        module: Name of the module in which `pickle` finds the classes by their names.
    """

    def __init__(
        self, classes: dict[str, Any], definitions: Mapping[str, Any], *, module: str
    ) -> None:
        super().__init__(classes)
        self._definitions = definitions
        self._module = module
        self._converted: dict[str, Any] = {}
        self._stated: dict[str, Mapping[str, Any]] = dict(STATED)

    def __getitem__(self, name: str) -> Any:
        made = self._converted.get(name)
        if made is None:
            made = _convert(super().__getitem__(name), self._module, self._fields(name), self.empty)
            # If another thread has just converted it, its class is used.
            made = self._converted.setdefault(name, made)
        return made

    def state_defaults(self, name: str, defaults: Mapping[str, Any]) -> None:
        """Sets the default values that a definition states, before the class is looked up."""
        self._stated[name] = defaults

    def empty(self, name: str) -> Any:
        """Creates a message whose fields have their default values."""
        made = self[name]
        if issubclass(made, msgspec.Struct):
            return made()
        return made(*(empty(field, self.empty) for field in self._fields(name)))

    def _fields(self, name: str) -> list[Field]:
        stated = self._stated.get(name, {})
        return [
            dataclasses.replace(field_of(field, described), default=stated.get(field))
            for field, described in self._definitions[name][1]
        ]

    def pop(self, name: str, *default: Any) -> Any:
        """Removes a type, which may then be defined again."""
        self._converted.pop(name, None)
        return super().pop(name, *default)


def _convert(
    given: Any, module: str, described: Sequence[Field], make: Callable[[str], Any]
) -> Any:
    """Creates the class of a type from a dataclass of rosbags, with its constants.

    Fields that are omitted when a message is created have their default values, as in ROS 2.

    Types with fields that are named after Python keywords keep their dataclass, whose constructor
    accepts these names and requires all fields.
    """
    fields = {
        field.name: field
        for field in dataclasses.fields(given)
        # Constants and the type have values, and so has the field of a type without fields.
        if field.default is dataclasses.MISSING or field.name == FILLER
    }
    # rosbags appends "_" to the names of keywords.
    if any(keyword.iskeyword(name.removesuffix("_")) for name in fields):
        given.__eq__, given.__repr__ = _equal, _shown
        return given
    kept = {
        name: value
        for name, value in vars(given).items()
        if name not in _OWN and name not in fields and not callable(value)
    }
    singles = [field.name for field in described if field.type == "float32" and not field.array]
    values = (0,) if FILLER in fields else (_default(field, make) for field in described)
    return msgspec.defstruct(
        given.__name__,
        [(name, Any, value) for name, value in zip(fields, values, strict=True)],
        # The functions of the module `dataclasses`, such as `replace`, support the class.
        namespace={
            **kept,
            "__dataclass_fields__": fields,
            "__eq__": _equal,
            "__ne__": _different,
            "__repr__": _shown,
            **({"__post_init__": rounding(singles)} if singles else {}),
        },
        module=module,
        eq=False,
        gc=False,
    )


def _equal(self: Any, other: Any) -> Any:
    """Whether two messages have equal fields. Arrays are equal if their shapes and values are.

    Values that are not a number (NaN) are equal.
    """
    if type(self) is not type(other):
        return NotImplemented
    names = self.__dataclass_fields__
    return all(_alike(getattr(self, name), getattr(other, name)) for name in names)


def _shown(self: Any) -> str:
    """A message as Python code, with the name of its class in `cartwheel.msgs`."""
    names = (name for name in self.__dataclass_fields__ if name != FILLER)
    fields = ", ".join(f"{name}={getattr(self, name)!r}" for name in names)
    return f"{self.__msgtype__.rpartition('/')[2]}({fields})"


def _different(self: Any, other: Any) -> Any:
    """Python derives it only for classes without a comparison of their own in C."""
    if type(self) is not type(other):
        return NotImplemented
    return not _equal(self, other)


def _alike(one: Any, other: Any) -> bool:
    if one is other:
        return True
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return np.array_equal(one, other) or (
            _has_nan(one) and _has_nan(other) and np.array_equal(one, other, equal_nan=True)
        )
    return bool(one == other) or (_is_nan(one) and _is_nan(other))


def _has_nan(value: Any) -> bool:
    array = np.asarray(value)
    return array.dtype.kind == "f" and bool(np.isnan(array).any())


def _is_nan(value: Any) -> bool:
    return isinstance(value, float) and math.isnan(value)


def _default(field: Field, make: Callable[[str], Any]) -> Any:
    """The default value of a field for msgspec. Mutable values are created for each message."""
    if field.array or field.kind == "message":
        return msgspec.field(default_factory=functools.partial(empty, field, make))
    return empty(field, make)


_OWN = frozenset({"__annotations__", "__dict__", "__module__", "__weakref__", "__hash__"})
"""Attributes that each class has of its own."""
