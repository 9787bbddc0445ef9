"""Will messages, as in MQTT: published when a client disconnects for any reason."""

from __future__ import annotations

from typing import Any

from cartwheel.codes.command import CONTROL_LIMIT
from cartwheel.control.parameters import Parameters
from cartwheel.errors import ControlError
from cartwheel.graph import Graph, resolve_name
from cartwheel.messages import from_dict, type_name

MOST = 16
"""Maximum number of topics with a will message per connection."""


class Wills:
    """The will messages of a connection, one per topic.

    Args:
        graph: The graph to publish on.
    """

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._messages: dict[str, tuple[str, Any]] = {}

    def take(self, parameters: Parameters) -> None:
        """Reads `at_end` of a "publish" request: a message replaces the topic's message, null
        withdraws it.

        Raises:
            CartwheelError: The message does not match the type, or there are too many.
        """
        name = resolve_name(parameters.text("topic"))
        content = parameters.value("at_end")
        if content is None:
            self._messages.pop(name, None)
            return
        wanted = type_name(parameters.text("type"))
        self._graph.types.named(wanted)
        message = from_dict(wanted, content)
        if name not in self._messages and len(self._messages) >= MOST:
            raise ControlError(
                f"a connection can register will messages for at most {MOST} topics",
                code=CONTROL_LIMIT,
                values={"most": MOST},
            )
        self._messages[name] = (wanted, message)

    def execute(self) -> None:
        """Publishes the messages after the connection ended."""
        known = {topic.name for topic in self._graph.topics()}
        for name, (wanted, message) in self._messages.items():
            if name in known:
                self._graph.publish(name, wanted, message)
        self._messages.clear()
