"""Parameters by name, as ROS 1's parameter server keeps them."""

from __future__ import annotations

import copy
import threading
from typing import Any, Protocol

from cartwheel.graph.names import resolve_name


class ParameterServer(Protocol):
    """Where parameters are kept when it is not this process: a ROS master."""

    def get(self, name: str) -> Any:
        """The value, a mapping for a namespace, or None; from any thread."""

    def set(self, name: str, value: Any) -> None:
        """Stores a value; from any thread."""


class Parameters:
    """A tree of values; a name stands for a value or for the mapping of all names below it.

    Args:
        server: Where they really are; a tree of this process while it is None.
    """

    def __init__(self, server: ParameterServer | None = None) -> None:
        self.server = server
        self._lock = threading.Lock()
        self._tree: dict[str, Any] = {}

    def get(self, name: str, default: Any = None) -> Any:
        """The value of a global name, a mapping for a namespace; `default` where there is none.

        ``/`` is the mapping of all.
        """
        path = resolve_name(name) if name.strip("/") else "/"
        if self.server is not None:
            value = self.server.get(path)
            return default if value is None else value
        with self._lock:
            node: Any = self._tree
            for part in path.split("/")[1:] if path != "/" else ():
                if not isinstance(node, dict) or part not in node:
                    return default
                node = node[part]
            return copy.deepcopy(node)

    def search(self, name: str, namespace: str = "") -> Any:
        """The value in the innermost namespace that has one, from `namespace` outwards; or None."""
        parts = [part for part in namespace.split("/") if part]
        for count in range(len(parts), -1, -1):
            value = self.get("/" + "/".join([*parts[:count], name]))
            if value is not None:
                return value
        return None

    def set(self, name: str, value: Any) -> None:
        """Stores a value, or a mapping as a whole namespace."""
        path = resolve_name(name)
        if self.server is not None:
            self.server.set(path, value)
            return
        with self._lock:
            *parents, last = path.split("/")[1:]
            node = self._tree
            for part in parents:
                below = node.get(part)
                if not isinstance(below, dict):
                    below = node[part] = {}
                node = below
            node[last] = value
