"""Static transforms, published together on ``/tf_static``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from cartwheel.messages import message_class

if TYPE_CHECKING:
    from cartwheel.graph.graph import Graph
    from cartwheel.graph.topic import Publisher

TOPIC = "/tf_static"


class StaticTransforms:
    """Publishes the static transforms of all robots as one latched message.

    A latched topic keeps only its last message, so nothing else may publish on the topic.
    Call it on the owner's thread. Source: tf2_ros, ``StaticTransformBroadcaster``.
    """

    def __init__(self, graph: Graph) -> None:
        self._graph: Graph | None = graph
        self._publisher: Publisher | None = None
        """None while no robot has static transforms."""
        self._by_owner: dict[object, Sequence[Any]] = {}

    def put(self, owner: object, transforms: Sequence[Any]) -> None:
        """Publishes an owner's ``TransformStamped`` messages, and removes its previous ones."""
        self._by_owner[owner] = transforms
        self._publish()

    def remove(self, owner: object) -> None:
        """Removes an owner's transforms."""
        if self._by_owner.pop(owner, None) is not None:
            self._publish()

    def forget(self) -> None:
        """Forgets all transforms and the graph, which is closing."""
        self._by_owner.clear()
        self._publisher = self._graph = None

    def _publish(self) -> None:
        if self._graph is None:
            return
        # Each frame has one parent, so it is published once even if two owners contain it.
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
