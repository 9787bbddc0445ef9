"""Topics whose messages pass through functions before they reach the subscribers."""

from __future__ import annotations

from cartwheel.graph.graph import Graph
from cartwheel.graph.topic import Filter


class Interception:
    """Passes all messages of a topic through a function, whoever publishes them.

    Several interceptions of a topic apply in the order in which they were made. Subscribers of a
    latched topic that subscribe later receive the original message.

    Args:
        graph: The graph.
        name: Topic.
        function: Receives each message on the owner's thread, and a function that passes a message
            on to the subscribers, now or later.

    Raises:
        UnknownNameError: No such topic exists.
    """

    def __init__(self, graph: Graph, name: str, function: Filter) -> None:
        self._graph = graph
        self.topic = graph.topic(name).name
        self._function = function
        graph.set_filters(self.topic, lambda filters: (*filters, function))

    def close(self) -> None:
        """Ends it. Messages that are passed on later are still delivered."""
        function = self._function
        self._graph.set_filters(
            self.topic, lambda filters: tuple(each for each in filters if each is not function)
        )
