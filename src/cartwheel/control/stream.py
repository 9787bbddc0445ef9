"""Streams a topic's messages to clients."""

from __future__ import annotations

import threading
from typing import Any

from cartwheel.control.parameters import Parameters
from cartwheel.control.protocol import Connection, pack
from cartwheel.control.types import packed_types
from cartwheel.graph import Mailbox, TopicInfo
from cartwheel.interfaces import RunningSession

_LOOK = 0.2
"""Interval of the checks whether the client is still connected, s."""
_QUEUE = 200
_LARGE = {"sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/PointCloud2"}
_LARGE_QUEUE = 5
"""Default queue of unread messages per client; the oldest are dropped and counted."""
_MOST, _MOST_LARGE = 10_000, 100
"""Maximum queue lengths that a client can request."""
_BATCH = 1 << 18
"""Maximum bytes per send."""


class Streams:
    """Serves all subscriptions, each on its connection's thread.

    Args:
        session: The session.
        closed: Ends all streams when set.
    """

    def __init__(self, session: RunningSession, closed: threading.Event) -> None:
        self._session = session
        self._closed = closed

    def serve(self, client: Connection, topic: TopicInfo, parameters: Parameters) -> None:
        """Sends a topic's messages until the client disconnects or the simulation ends.

        A frame's header contains the message's simulation time and the number of messages dropped
        so far.

        Raises:
            CartwheelError: The parameters are invalid; nothing was sent.
            OSError: The client disconnected, or did not read for `protocol.SEND_SECONDS`.
        """
        with_data = parameters.flag("data", default=True)
        large = with_data and topic.type in _LARGE
        usual, most = (_LARGE_QUEUE, _MOST_LARGE) if large else (_QUEUE, _MOST)
        box = Mailbox(parameters.whole("queue", usual, 1, most))
        simulation = self._session.simulation

        def put(message: Any) -> None:
            # On the simulation's thread, because the message's time is known only there.
            box.put((simulation.time_ns, message if with_data else None))

        subscription = self._session.graph.subscribe(
            topic.name, put, type_name=topic.type, node="cartwheel topic", anytime=True
        )
        subscription.dropped = lambda: box.dropped
        try:
            types = packed_types(topic.type)
            client.send({"ok": {"topic": topic.name, "type": topic.type, "types": types}})
            while not self._closed.is_set():
                first = box.get(_LOOK)
                if first is not None:
                    self._send(client, [first, *box.drain()], box.dropped)
                elif client.has_ended():
                    return
        finally:
            subscription.close()

    def _send(self, client: Connection, items: list[Any], dropped: int) -> None:
        batch: list[bytes] = []
        size = 0
        for time_ns, message in items:
            data = b"" if message is None else self._session.graph.cdr.encode(message)
            batch.append(pack({"time_ns": time_ns, "dropped": dropped}, data))
            size += len(batch[-1])
            if size > _BATCH:
                client.send_packed(b"".join(batch))
                batch, size = [], 0
        if batch:
            client.send_packed(b"".join(batch))
