"""Subscriptions of a recorder."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph, BridgedSubscription
from cartwheel.graph import TakeValues, TopicInfo

READER = "recorder"
"""Node name of the recorder in the graph."""
_STRING = "std_msgs/msg/String"


class Tap:
    """Subscription of one topic.

    Args:
        info: The topic.
        number: Number of the topic and its type.
    """

    def __init__(self, info: TopicInfo, number: int) -> None:
        self.number = number
        self.type = info.type
        self.latched = info.qos == "latched"
        self.topic = info.name
        self.describes = self.type == _STRING and self.topic.endswith("robot_description")
        """Whether the messages are also stored as attachments."""
        self.last: Any = None
        """The last message of a latched topic."""
        self._subscription: BridgedSubscription | None = None

    def open(
        self, graph: BridgedGraph, take: Callable[[Any], None], take_values: TakeValues | None
    ) -> None:
        """Subscribes.

        Args:
            graph: Graph with the topic.
            take: Receives each message.
            take_values: Receives the values of each message instead; see `Graph.subscribe`.
        """
        self._subscription = graph.subscribe(
            self.topic, take, type_name=self.type, node=READER, take_values=take_values
        )

    def close(self) -> None:
        """Unsubscribes."""
        if self._subscription is not None:
            self._subscription.close()
            self._subscription = None
