"""The encoded form of saved objects: plain data without references to a simulation."""

from __future__ import annotations

import enum
import importlib
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any


class Kind(enum.IntEnum):
    """Kind of a saved object, which decides how it is restored."""

    OBJECT = 0
    """An object with attributes."""
    LIST = 1
    DICT = 2
    SET = 3
    DEQUE = 4
    BYTES = 5
    """A bytearray."""
    ARRAY = 6
    """A NumPy array that owns its memory, or an array that is not part of the simulation."""
    MESSAGE = 7
    RANDOM = 8
    """A random generator of NumPy or of Python."""
    VALUE = 9
    """A frozen dataclass."""
    FUNCTION = 10
    """A function that is defined within another one, with its variables."""
    ADAPTED = 11
    """An object of which an `Adapter` saves a part."""
    DECLARED = 12
    """A component of which its own `save` saves a part."""
    PICKLED = 13


@dataclass(slots=True)
class Node:
    """A saved object with an identity."""

    kind: Kind
    cls: Constant
    content: Any = None
    attributes: dict[str, Any] | None = None
    """Attributes of an object, or of an instance of a subclass of a container."""


@dataclass(frozen=True, slots=True)
class Constant:
    """A class, a function or an enum member, by its name."""

    module: str
    name: str

    def find(self) -> Any:
        """Returns the constant.

        Raises:
            LookupError: It does not exist in this process.
        """
        try:
            found = sys.modules.get(self.module) or importlib.import_module(self.module)
            for part in self.name.split("."):
                found = getattr(found, part)
        except (ImportError, AttributeError) as error:
            raise LookupError(f"{self.module}.{self.name}") from error
        return found


@dataclass(frozen=True, slots=True)
class Ref:
    """A reference to a node."""

    index: int


@dataclass(frozen=True, slots=True)
class Left:
    """A value that is not saved: what the world has in the same place is kept.

    Its index is that of the value in `Originals`.
    """

    index: int


@dataclass(frozen=True, slots=True)
class Items:
    """A tuple or frozenset with items that are not plain."""

    items: list[Any]
    cls: Constant | None = None
    """Its class; None for a tuple."""


@dataclass(frozen=True, slots=True)
class Method:
    """A method of an object."""

    owner: Any
    name: str


@dataclass(frozen=True, slots=True)
class Partial:
    """A call of `functools.partial`."""

    function: Any
    arguments: Any
    keywords: Any


@dataclass(frozen=True, slots=True)
class View:
    """A view of a part of an array."""

    array: Any
    dtype: Any
    shape: tuple[int, ...]
    strides: tuple[int, ...]
    offset: int

    def equals(self, value: Any, array: Any) -> bool:
        """Whether a value is this view of an array."""
        layout = (self.shape, self.strides, self.dtype)
        if id(getattr(value, "base", None)) != id(array):
            return False
        if (value.shape, value.strides, value.dtype) != layout:
            return False
        start: int = array.__array_interface__["data"][0] + self.offset
        return bool(value.__array_interface__["data"][0] == start)


class Sentinel(enum.Enum):
    """Values without content."""

    BOUND = enum.auto()
    """A view of MuJoCo's memory, which a handle obtains when the world is compiled."""
    MISSING = enum.auto()
    """There is no value in the same place."""
    UNSET = enum.auto()
    """The variable of a function has no value yet."""


@dataclass(frozen=True, slots=True)
class Adapter:
    """Saves a part of an object that is otherwise part of the world's structure.

    Args:
        get: Returns the part.
        put: Sets the part to a restored value.
    """

    get: Callable[[Any], Any]
    put: Callable[[Any, Any], None]


@dataclass(slots=True)
class Originals:
    """The objects from which a state was saved, for its restoration in the same world."""

    objects: Sequence[Any]
    left: Sequence[Any]
