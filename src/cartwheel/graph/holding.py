"""Topics whose messages from other threads wait, so that they take effect at a chosen time."""

from __future__ import annotations

from cartwheel.graph.graph import Graph
from cartwheel.graph.topic import Callback, deliver_changed


def hold_back(graph: Graph, name: str, take: Callback) -> Callback:
    """Passes messages of `Graph.publish` on a topic to a function, instead of the subscribers.

    Args:
        graph: The graph.
        name: Topic.
        take: Receives the messages, on any thread.

    Returns:
        A function that delivers a message to the subscribers. Call it on the owner's thread.

    Raises:
        UnknownNameError: No such topic exists.
    """
    name = graph.topic(name).name
    topic = graph._topics[name]
    topic.take = take
    return lambda message: deliver_changed(topic, message, graph.cdr)


def let_pass(graph: Graph, name: str) -> None:
    """Ends `hold_back`."""
    if name in graph._topics:
        graph._topics[name].take = None
