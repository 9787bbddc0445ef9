"""Parameters by name, as ROS 1's parameter server keeps them."""

from __future__ import annotations

import copy
import threading
from typing import Any, Protocol

from cartwheel.graph.names import resolve_name


class ParameterServer(Protocol):
    """External storage of parameters: a ROS master."""

    def get(self, name: str) -> Any:
        """Value, mapping for a namespace, or None. Callable on any thread."""

    def set(self, name: str, value: Any) -> None:
        """Sets a value. Callable on any thread."""


class Parameters:
    """A tree of values. A name refers to a value, or to the mapping of all names below it.

    Args:
        server: External storage. None stores the tree in this process.
    """

    def __init__(self, server: ParameterServer | None = None) -> None:
        self.server = server
        self._lock = threading.Lock()
        self.tree: dict[str, Any] = {}
        """The tree of this process; empty if the values are stored externally."""

    def get(self, name: str, default: Any = None) -> Any:
        """Value of a name, mapping for a namespace, or `default` if the name does not exist.

        ``/`` returns the mapping of all parameters.
        """
        path = resolve_name(name) if name.strip("/") else "/"
        if self.server is not None:
            value = self.server.get(path)
            return default if value is None else value
        with self._lock:
            node: Any = self.tree
            for part in path.split("/")[1:] if path != "/" else ():
                if not isinstance(node, dict) or part not in node:
                    return default
                node = node[part]
            return copy.deepcopy(node)

    def search(self, name: str, namespace: str = "") -> Any:
        """Value in the innermost namespace with the name, from `namespace` outwards, or None."""
        parts = [part for part in namespace.split("/") if part]
        for count in range(len(parts), -1, -1):
            value = self.get("/" + "/".join([*parts[:count], name]))
            if value is not None:
                return value
        return None

    def set(self, name: str, value: Any) -> None:
        """Sets a value, or replaces a whole namespace by a mapping."""
        path = resolve_name(name)
        if self.server is not None:
            self.server.set(path, value)
            return
        with self._lock:
            *parents, last = path.split("/")[1:]
            node = self.tree
            for part in parents:
                below = node.get(part)
                if not isinstance(below, dict):
                    below = node[part] = {}
                node = below
            node[last] = value
