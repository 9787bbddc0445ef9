"""Standard endpoints for those nodes of the graph that appear as separate ROS 2 nodes."""

from __future__ import annotations

from cartwheel.bridges import rosout
from cartwheel.bridges.mirror import Closable
from cartwheel.bridges.ros2 import parameters
from cartwheel.bridges.ros2.middleware import Middleware, publisher
from cartwheel.bridges.ros2.services import Services
from cartwheel.bridges.ros2.type_descriptions import TYPE, get_type_description


class OwnNode:
    """Standard endpoints of a node: log, parameter events, and type descriptions.

    Nothing is published on the topics. Used on the loop's thread.

    Args:
        middleware: Middleware to advertise the topics on.
        offers: Offers services.
        name: Full name of the node, with namespace.
    """

    def __init__(self, middleware: Middleware, offers: Services, name: str) -> None:
        self._parts: list[Closable] = [
            middleware.publish(publisher(topic, kind, node=name))
            for topic, kind in ((rosout.TOPIC, rosout.TYPE), (parameters.EVENTS, parameters.EVENT))
        ]
        self._parts.append(
            offers.offer(f"{name}/get_type_description", TYPE, get_type_description, node=name)
        )

    def close(self) -> None:
        """Removes the endpoints."""
        for part in self._parts:
            part.close()
