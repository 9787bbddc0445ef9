"""Subscriptions of a recorder."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph, BridgedSubscription
from cartwheel.graph import TopicInfo

READER = "recorder"
"""Node name of the recorder in the graph."""
_STRING = "std_msgs/msg/String"


class Tap:
    """Subscription of one topic.

    Args:
        graph: Graph with the topic.
        info: The topic.
        take: Receives the tap and each message.
    """

    def __init__(
        self, graph: BridgedGraph, info: TopicInfo, take: Callable[[Tap, Any], None]
    ) -> None:
        self.type = info.type
        self.latched = info.qos == "latched"
        self.topic = info.name
        self.key = f"{self.topic} {self.type}"
        """Identifies the channel in the file."""
        self.describes = self.type == _STRING and self.topic.endswith("robot_description")
        """Whether the messages are also stored as attachments."""
        self.last: Any = None
        """The last message of a latched topic."""
        self._subscription: BridgedSubscription = graph.subscribe(
            info.name, functools.partial(take, self), type_name=info.type, node=READER
        )

    def close(self) -> None:
        """Unsubscribes."""
        self._subscription.close()
