"""The latest message on a topic."""

from __future__ import annotations

from typing import Any

from cartwheel.graph import Graph


class Tap:
    """Keeps the latest message on a topic and counts all messages.

    Args:
        graph: The graph.
        topic: Topic name.
    """

    def __init__(self, graph: Graph, topic: str) -> None:
        self.topic = topic
        self.newest: Any = None
        self.count = 0
        self._subscription = graph.subscribe(topic, self._take, node="viewer", anytime=True)

    def _take(self, message: Any) -> None:
        self.newest = message
        self.count += 1

    def close(self) -> None:
        """Closes the subscription."""
        self._subscription.close()
