"""The times after which the velocity commands of a simulation expire."""

from __future__ import annotations

import math
from collections.abc import Sequence


class CommandTimeouts:
    """The times after which velocity commands expire, by the nodes that receive them."""

    def __init__(self) -> None:
        self._by_node: dict[str, float] = {}

    def set(self, node: str, timeout: float) -> None:
        """Sets the time after which the commands of a node expire, s."""
        self._by_node[node] = timeout

    def shortest(self, nodes: Sequence[str]) -> float:
        """The shortest time of these nodes, such as the subscribers of a topic, s; infinite if
        their commands do not expire.
        """
        return min((self._by_node.get(node, math.inf) for node in nodes), default=math.inf)
