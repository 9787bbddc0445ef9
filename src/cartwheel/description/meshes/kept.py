"""A cache that is limited by the memory of its values, instead of their number."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

K = TypeVar("K", bound=Hashable)
V = TypeVar("V")
_ENTRY = 1000
"""Memory that is counted for a key and the objects around a value, bytes."""


class Kept(Generic[K, V]):
    """Stores values until they need too much memory; then the least recently used are removed.

    A scenery has thousands of small meshes, each of which is needed several times during a load. A
    limited number of them would be computed again each time. Several threads can use the cache.

    Args:
        most: Maximum memory of the values, bytes. The newest value may exceed it.
        size: The memory of a value, bytes.
    """

    def __init__(self, most: int, size: Callable[[V], int]) -> None:
        self._most = most
        self._size = size
        self._values: OrderedDict[K, tuple[V, int]] = OrderedDict()
        self._used = 0
        self._lock = threading.Lock()

    def get(self, key: K, make: Callable[[], V]) -> V:
        """The value of a key.

        Args:
            key: The key.
            make: Creates the value if it is not stored. Its errors are raised, and not stored.
        """
        with self._lock:
            if key in self._values:
                self._values.move_to_end(key)
                return self._values[key][0]
        value = make()
        size = self._size(value) + _ENTRY
        with self._lock:
            _, replaced = self._values.pop(key, (value, 0))
            self._values[key] = value, size
            self._used += size - replaced
            while self._used > self._most and len(self._values) > 1:
                _, (_, removed) = self._values.popitem(last=False)
                self._used -= removed
        return value

    def clear(self) -> None:
        """Removes all values."""
        with self._lock:
            self._values.clear()
            self._used = 0
