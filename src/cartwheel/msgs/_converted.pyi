"""Types of fields that also accept other values, which are converted when a message is published.

Only type checkers read them: a message contains what was assigned until it is published.
"""

from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

T = TypeVar("T")
Number = TypeVar("Number", bound=np.generic)

class Array(Generic[Number]):
    """An array of numbers, to which lists, tuples and other numbers can be assigned."""

    def __get__(self, message: Any, owner: Any = None, /) -> NDArray[Number]: ...
    def __set__(self, message: Any, value: ArrayLike, /) -> None: ...

class List(Generic[T]):
    """A list of texts or messages, to which tuples can be assigned."""

    def __get__(self, message: Any, owner: Any = None, /) -> list[T]: ...
    def __set__(self, message: Any, value: list[T] | tuple[T, ...], /) -> None: ...

class Time(Generic[T]):
    """A time or duration, to which seconds can be assigned."""

    def __get__(self, message: Any, owner: Any = None, /) -> T: ...
    def __set__(self, message: Any, value: T | float, /) -> None: ...
