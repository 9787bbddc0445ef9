"""What is published when a client goes away, in whatever manner: a robot must not drive on."""

from __future__ import annotations

from typing import Any

from cartwheel.codes.command import CONTROL_LIMIT
from cartwheel.control.parameters import Parameters
from cartwheel.errors import ControlError
from cartwheel.graph import Graph, resolve_name
from cartwheel.messages import from_dict, type_name

MOST = 16
"""Topics for which one connection may leave a message."""


class Wills:
    """The last messages of one connection, one for each topic.

    Args:
        graph: To publish on.
    """

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._messages: dict[str, tuple[str, Any]] = {}

    def take(self, parameters: Parameters) -> None:
        """Reads `at_end` of a "publish": a message replaces that of its topic, null withdraws it.

        Raises:
            CartwheelError: It is not a message of the type, or there are too many.
        """
        name = resolve_name(parameters.text("topic"))
        content = parameters.value("at_end")
        if content is None:
            self._messages.pop(name, None)
            return
        wanted = type_name(parameters.text("type"))
        message = from_dict(wanted, content)
        if name not in self._messages and len(self._messages) >= MOST:
            raise ControlError(
                f"one connection may register final messages for at most {MOST} topics",
                code=CONTROL_LIMIT,
                values={"most": MOST},
            )
        self._messages[name] = (wanted, message)

    def execute(self) -> None:
        """Publishes them; the connection has ended."""
        known = {topic.name for topic in self._graph.topics()}
        for name, (wanted, message) in self._messages.items():
            if name in known:
                self._graph.publish(name, wanted, message)
        self._messages.clear()
