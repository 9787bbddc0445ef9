"""The last messages of a world, in memory, until a test fails."""

from __future__ import annotations

import threading
from collections import Counter, deque
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cartwheel.bridges.mirror import offered_by_others
from cartwheel.bridges.recording.encoding import codec
from cartwheel.bridges.recording.patterns import Patterns
from cartwheel.bridges.recording.writing import open_writer
from cartwheel.gazebo.robot_states import hold_states
from cartwheel.graph import TopicInfo
from cartwheel.graph.topic import Subscription

if TYPE_CHECKING:
    from cartwheel.api import World

_NODE = "cartwheel test"
_LARGE = frozenset({"Image", "CompressedImage", "PointCloud", "PointCloud2"})
"""Types of messages that are not recorded, because sensors would take most of the time."""
_MOST = 500_000
"""Maximum number of messages."""

Item = tuple[int, str, str, bool, Any]
"""Time in ns, topic, type, whether it is latched, and the message."""


class Recent:
    """Keeps the messages of the last seconds, without serialising them.

    Args:
        world: The world.
        seconds: Simulation time, s; None for the whole run.
        topics: Patterns of topics; empty for all topics without large messages.
    """

    def __init__(self, world: World, seconds: float | None, topics: tuple[str, ...] = ()) -> None:
        self._world = world
        self._simulation = world.session.simulation
        self._graph = world.session.graph
        self._window = None if seconds is None else int(seconds * 1e9)
        self._patterns = Patterns(topics)
        self._all = not topics
        self._items: deque[Item] = deque(maxlen=_MOST)
        self._subscriptions: dict[str, tuple[str, Subscription]] = {}
        self._latched: dict[str, Item] = {}
        self.latest: dict[str, tuple[int, Any]] = {}
        """Time in ns and message by topic."""
        self._surveyor: int | None = None
        self._due = False
        # The test may have robots with the same frames, which concerns only the recording.
        self._release = hold_states(world.session, reports=False)
        self._graph.on_change.append(self._changed)
        self._survey()

    def close(self) -> None:
        """Ends all subscriptions. A closed world has ended them."""
        if self._simulation.closed:
            return
        if self._changed in self._graph.on_change:
            self._graph.on_change.remove(self._changed)
        for _, subscription in self._subscriptions.values():
            subscription.close()
        self._subscriptions.clear()
        self._release()

    def _changed(self) -> None:
        """Called on any thread, with the graph locked."""
        if threading.get_ident() != self._surveyor and not self._due:
            self._due = True
            self._graph.post(self._survey)

    def _survey(self) -> None:
        self._due = False
        self._surveyor = threading.get_ident()
        try:
            offered = offered_by_others(self._graph, _NODE)
            for name, (kind, subscription) in list(self._subscriptions.items()):
                if name not in offered or offered[name].type != kind:
                    del self._subscriptions[name]
                    subscription.close()
            for name, info in offered.items():
                if name not in self._subscriptions and self._wanted(info):
                    self._subscriptions[name] = (info.type, self._subscribe(info))
        finally:
            self._surveyor = None

    def _wanted(self, info: TopicInfo) -> bool:
        if self._all and info.type.rpartition("/")[2] in _LARGE:
            return False
        return self._patterns.match(info.name)

    def _subscribe(self, info: TopicInfo) -> Subscription:
        name, kind, latched = info.name, info.type, info.qos == "latched"
        items, latest, simulation, window = self._items, self.latest, self._simulation, self._window

        def take(message: Any) -> None:
            now = simulation.time_ns
            if items and now < items[-1][0]:
                items.clear()  # a recording must be in the order of time, which was reset
            item = (now, name, kind, latched, message)
            items.append(item)
            latest[name] = (now, message)
            if latched:
                self._latched[name] = item
            if window is not None:
                while items[0][0] < now - window:
                    items.popleft()

        return self._graph.subscribe(name, take, type_name=kind, node=_NODE)

    def is_latched(self, topic: str) -> bool:
        """Whether the messages of a topic are latched."""
        return topic in self._latched

    def write(self, path: Path) -> int:
        """Writes the messages to an MCAP file; returns their number.

        Raises:
            RecordingError: The file cannot be written.
        """
        if not self._simulation.closed:
            self._world.session.update_robots()
            self._survey()
            self._simulation.drain()
        items = sorted(self._items, key=lambda item: item[0])
        start = items[0][0] if items else self._simulation.time_ns
        first = [(start, *item[1:]) for item in self._latched.values()]
        later = [item for item in items if not item[3] or item[0] > start]
        path.parent.mkdir(parents=True, exist_ok=True)
        made = codec("ros2")
        writer = open_writer(path, "ros2", overwrite=True, notes=self._world.session.notes)
        channels: dict[str, int] = {}
        counts: Counter[str] = Counter()
        for time_ns, topic, kind, latched, message in (*first, *later):
            if topic not in channels:
                channels[topic] = writer.add(topic, kind, latched=latched)
            data = made.encode(message, counts[topic])
            writer.write([channels[topic]], [time_ns], [data])
            counts[topic] += 1
            if topic.endswith("robot_description"):
                name = f"{topic.strip('/').replace('/', '.')}.xml"
                writer.attach(name, "application/xml", message.data.encode(), time_ns)
        writer.close()
        return len(first) + len(later)
