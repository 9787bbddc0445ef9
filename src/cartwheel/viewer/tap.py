"""The newest message of a topic."""

from __future__ import annotations

from typing import Any

from cartwheel.graph import Graph


class Tap:
    """Keeps the newest message of a topic and counts them all.

    Args:
        graph: To subscribe to.
        topic: Its name.
    """

    def __init__(self, graph: Graph, topic: str) -> None:
        self.topic = topic
        self.newest: Any = None
        self.count = 0
        self._subscription = graph.subscribe(topic, self._take, node="viewer")

    def _take(self, message: Any) -> None:
        self.newest = message
        self.count += 1

    def close(self) -> None:
        """Ends the subscription."""
        self._subscription.close()
