"""Transforms that never change, together on ``/tf_static``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from cartwheel.graph.graph import Graph, Publisher
from cartwheel.messages import message_class

TOPIC = "/tf_static"


class StaticTransforms:
    """Keeps those of all robots and publishes them as one latched message.

    A topic's latched message is its last one, so nobody may publish there alone. Source:
    tf2_ros, ``StaticTransformBroadcaster``. For the owner's thread.
    """

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._publisher: Publisher | None = None
        """None while no robot has any."""
        self._by_owner: dict[object, Sequence[Any]] = {}

    @classmethod
    def of(cls, graph: Graph) -> StaticTransforms:
        """The one of a graph, made when first asked for."""
        if graph.static_transforms is None:
            graph.static_transforms = cls(graph)
        found: StaticTransforms = graph.static_transforms
        return found

    def put(self, owner: object, transforms: Sequence[Any]) -> None:
        """Publishes ``TransformStamped`` of an owner, in place of those it had."""
        self._by_owner[owner] = transforms
        self._publish()

    def remove(self, owner: object) -> None:
        """The owner's transforms hold no longer."""
        if self._by_owner.pop(owner, None) is not None:
            self._publish()

    def _publish(self) -> None:
        # A frame has one parent, told once, even where two know of it.
        by_child: dict[str, Any] = {}
        for sent in self._by_owner.values():
            for transform in sent:
                by_child.setdefault(transform.child_frame_id, transform)
        every = list(by_child.values())
        if self._publisher is None:
            self._publisher = self._graph.advertise(TOPIC, "tf2_msgs/msg/TFMessage", qos="latched")
        self._publisher.publish(message_class("tf2_msgs/msg/TFMessage")(every))
        if not every:
            self._publisher.close()
            self._publisher = None
