"""A topic on Foxglove, subscribed to in the graph while a client subscribes to it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph, BridgedSubscription
from cartwheel.bridges.foxglove.forms import encoding_of, packed, schema_of
from cartwheel.codes.wires import PUBLISHED_TOO_FAST
from cartwheel.errors import Diagnostic
from cartwheel.graph import Mailbox, TopicInfo

READER = "foxglove"
"""Node name of the bridge in the graph."""
_LARGE = {"sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/PointCloud2"}
_WAITING, _LARGE_WAITING = 200, 5
"""Maximum number of queued messages between the simulation's and the bridge's threads."""


class Publication:
    """A channel. Its methods run on the bridge's thread, except for `_take`.

    Args:
        graph: Graph with the topic.
        info: Description of the topic.
        context: foxglove's context of the server.
        time_ns: Simulation time.
        wake: Makes the bridge call `send` soon. Callable on any thread.
        warn: Receives warnings.
    """

    def __init__(
        self,
        graph: BridgedGraph,
        info: TopicInfo,
        *,
        context: Any,
        time_ns: Callable[[], int],
        wake: Callable[[], None],
        warn: Callable[[Diagnostic], None],
    ) -> None:
        import foxglove

        self.info = info
        self._graph = graph
        self._time_ns = time_ns
        self._wake = wake
        self._warn = warn
        self._encoding = encoding_of(info.type)
        self.channel = foxglove.Channel(
            info.name,
            message_encoding=self._encoding,
            schema=schema_of(info.type, self._encoding),
            context=context,
        )
        self.latched = info.qos == "latched"
        size = _LARGE_WAITING if info.type in _LARGE else _WAITING
        self._box = Mailbox(size)
        self._subscription: BridgedSubscription | None = None
        self._readers = 0
        self._last: tuple[int, bytes] | None = None
        self._warned = False

    def join(self) -> None:
        """Called when a client subscribes."""
        self._readers += 1
        if self._subscription is None:
            self._subscription = self._graph.subscribe(
                self.info.name, self._take, type_name=self.info.type, node=READER
            )
            self._subscription.dropped = lambda: self._box.dropped
        elif self.latched and self._last is not None:
            time_ns, data = self._last
            self.channel.log(data, log_time=time_ns)

    def leave(self) -> None:
        """Called when a client unsubscribes."""
        self._readers = max(0, self._readers - 1)
        if not self._readers:
            self._end()

    def send(self) -> None:
        """Sends the queued messages."""
        for time_ns, message in self._box.drain():
            if not self._readers:
                return
            data = packed(self._graph, message, self._encoding)
            if self.latched:
                self._last = (time_ns, data)
            self.channel.log(data, log_time=time_ns)
        if self._box.dropped and not self._warned:
            self._warned = True
            self._warn(
                PUBLISHED_TOO_FAST.diagnostic(
                    f"{self.info.name} is published faster than it can be sent, so messages are "
                    "dropped",
                    values={"topic": self.info.name},
                )
            )

    def close(self) -> None:
        """Closes the channel."""
        self._end()
        self.channel.close()

    def _end(self) -> None:
        if self._subscription is not None:
            self._subscription.close()
            self._subscription = None
        self._last = None
        self._box.drain()

    def _take(self, message: Any) -> None:
        """Called on the simulation's thread."""
        self._box.put((self._time_ns(), message))
        self._wake()
