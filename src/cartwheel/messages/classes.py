"""Classes of messages. They behave like the dataclasses of rosbags, but are created in C.

Creating a message takes a third of the time, and Python's garbage collector does not visit them:
messages contain no references to themselves.
"""

from __future__ import annotations

import dataclasses
import keyword
from typing import Any

import msgspec

FILLER = "structure_needs_at_least_one_member"
"""Byte that ROS 2 adds to a message without fields. Its value has no meaning."""


class Classes(dict[str, Any]):
    """The classes of a typestore by type. They are converted when they are first looked up.

    Args:
        classes: The classes of rosbags.
        module: Name of the module in which `pickle` finds the classes by their names.
    """

    def __init__(self, classes: dict[str, Any], *, module: str) -> None:
        super().__init__(classes)
        self._module = module
        self._converted: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        made = self._converted.get(name)
        if made is None:
            made = _convert(super().__getitem__(name), self._module)
            # If another thread has just converted it, its class is used.
            made = self._converted.setdefault(name, made)
        return made

    def pop(self, name: str, *default: Any) -> Any:
        """Removes a type, which may then be defined anew."""
        self._converted.pop(name, None)
        return super().pop(name, *default)


def _convert(given: Any, module: str) -> Any:
    """Creates the class of a type from a dataclass of rosbags, with its constants.

    Types with fields that are named after Python keywords keep their dataclass, whose constructor
    accepts these names.
    """
    fields = {
        field.name: field
        for field in dataclasses.fields(given)
        # Constants and the type have values, and so has the field of a type without fields.
        if field.default is dataclasses.MISSING or field.name == FILLER
    }
    # rosbags appends "_" to the names of keywords.
    if any(keyword.iskeyword(name.removesuffix("_")) for name in fields):
        return given
    kept = {
        name: value
        for name, value in vars(given).items()
        if name not in _OWN and name not in fields and not callable(value)
    }
    return msgspec.defstruct(
        given.__name__,
        [(name, Any, 0) if name == FILLER else (name, Any) for name in fields],
        # The functions of the module `dataclasses`, such as `replace`, support the class.
        namespace={**kept, "__dataclass_fields__": fields},
        module=module,
        gc=False,
    )


_OWN = frozenset({"__annotations__", "__dict__", "__module__", "__weakref__", "__hash__"})
"""Attributes that each class has of its own."""
