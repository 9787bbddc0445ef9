"""The bridges as their processes run them."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from cartwheel.bridges.apart.link import Link
from cartwheel.bridges.apart.remote_graph import ANSWER, RemoteGraph
from cartwheel.errors import Diagnostic, RecordingError

_FRESH = 0.05
"""s for which parameters that were asked for are taken for those of now."""


class Ros1Wire:
    """See `Ros1Bridge`."""

    def __init__(self, graph: RemoteGraph, link: Link) -> None:
        from cartwheel.bridges.ros1 import Ros1Bridge

        self._made = Ros1Bridge
        self._graph = graph
        self._link = link
        self._bridge: Ros1Bridge | None = None

    def open(self, options: dict[str, Any]) -> Any:
        """Makes it; its name, its master's URI and its own."""
        link, graph = self._link, self._graph
        self._bridge = bridge = self._made(
            graph,
            **options,
            report=lambda diagnostic: link.tell("report", diagnostic),
            time_ns=lambda: graph.time_ns,
            on_end=lambda reason: link.tell("ended", reason),
        )

        def start() -> bool:
            bridge.start()
            return bridge.has_own_master

        link.handle("start", lambda: graph.run(start))
        link.handle("log", _logger(graph, bridge.log))
        return bridge.name, bridge.master_uri, bridge.uri

    def close(self) -> None:
        """Ends it."""
        if self._bridge is not None:
            self._bridge.close()


class Ros2Wire:
    """See `Ros2Bridge`."""

    def __init__(self, graph: RemoteGraph, link: Link) -> None:
        from cartwheel.bridges.ros2 import Ros2Bridge

        self._made = Ros2Bridge
        self._graph = graph
        self._link = link
        self._bridge: Ros2Bridge | None = None

    def open(self, options: dict[str, Any]) -> Any:
        """Makes it; its name and its middleware's description."""
        from cartwheel.bridges.ros2 import Parameter

        link, graph = self._link, self._graph
        values = _Values(link, graph)
        described = options.pop("parameters")
        parameters = [
            Parameter(
                name=name,
                description=description,
                get=lambda name=name: values.get(name),  # type: ignore[misc]
                set=(lambda value, name=name: values.set(name, value)) if settable else None,  # type: ignore[misc]
            )
            for name, description, settable in described
        ]
        self._bridge = bridge = self._made(
            graph,
            **options,
            parameters=parameters,
            report=lambda diagnostic: link.tell("report", diagnostic),
            time_ns=lambda: graph.time_ns,
        )

        def make_way(last: str) -> None:
            bridge.make_way(last, lambda topics: link.tell("taken_by_others", topics))

        link.handle("start", lambda: graph.run(bridge.start))
        link.handle("log", _logger(graph, bridge.log))
        link.handle("make_way", make_way)
        return bridge.name, bridge.description

    def close(self) -> None:
        """Ends it."""
        if self._bridge is not None:
            self._bridge.close()


class _Values:
    """The node's parameters, which the simulation's process has; all are asked for at once."""

    def __init__(self, link: Link, graph: RemoteGraph) -> None:
        self._link = link
        self._graph = graph
        self._values: dict[str, Any] = {}
        self._since = 0.0
        self._lock = threading.Lock()

    def get(self, name: str) -> Any:
        with self._lock:
            if time.monotonic() - self._since > _FRESH:
                time_ns, self._values = self._link.call("values").result(ANSWER)
                self._graph.saw(time_ns)
                self._since = time.monotonic()
            return self._values[name]

    def set(self, name: str, value: Any) -> None:
        self._link.call("set_value", name, value).result(ANSWER)
        self._since = 0.0


class FoxgloveWire:
    """See `FoxgloveBridge`."""

    def __init__(self, graph: RemoteGraph, link: Link) -> None:
        from cartwheel.bridges.foxglove import FoxgloveBridge

        self._made = FoxgloveBridge
        self._graph = graph
        self._link = link
        self._bridge: FoxgloveBridge | None = None

    def open(self, options: dict[str, Any]) -> None:
        """Makes it."""
        link, graph = self._link, self._graph
        self._bridge = bridge = self._made(
            graph,
            **options,
            controls=_Controls(link, graph),
            assets=lambda uri: link.call("asset", uri).result(ANSWER),
            report=lambda diagnostic: link.tell("report", diagnostic),
        )

        def start() -> str:
            bridge.start()
            return bridge.url

        link.handle("start", lambda: graph.run(start))
        link.handle("log", _logger(graph, bridge.log))

    def close(self) -> None:
        """Ends it."""
        if self._bridge is not None:
            self._bridge.close()


class _Controls:
    """Time in the simulation's process; see `Controls`."""

    def __init__(self, link: Link, graph: RemoteGraph) -> None:
        self._link = link
        self._graph = graph

    @property
    def time_ns(self) -> int:
        """That of the message that has just come."""
        return self._graph.time_ns

    def state(self) -> Any:
        """How it goes now."""
        return self._link.call("state").result(ANSWER)

    def pause(self) -> None:
        """Holds it."""
        self._link.call("pause").result(ANSWER)

    def resume(self) -> None:
        """Lets it go on."""
        self._link.call("resume").result(ANSWER)

    def set_speed(self, speed: float | None) -> None:
        """Sets the wanted real-time factor."""
        self._link.call("set_speed", speed).result(ANSWER)

    def seek(self, time_ns: int) -> None:
        """Jumps."""
        self._link.call("seek", time_ns).result(ANSWER)


class RecordingWire:
    """See `Recorder`."""

    def __init__(self, graph: RemoteGraph, link: Link) -> None:
        from cartwheel.bridges.recording import Recorder

        self._made = Recorder
        self._graph = graph
        self._link = link
        self._recorder: Recorder | None = None

    def open(self, options: dict[str, Any]) -> None:
        """Makes it."""
        link, graph = self._link, self._graph

        def failed(error: RecordingError) -> None:
            link.tell("failed", error)

        self._recorder = recorder = self._made(
            graph,
            Path(options.pop("path")),
            **options,
            time_ns=lambda: graph.time_ns,
            report=lambda diagnostic: link.tell("report", diagnostic),
            on_failure=failed,
        )
        link.handle("start", lambda: graph.run(recorder.start))

    def close(self) -> Any:
        """Ends it; a `Summary`."""
        recorder, self._recorder = self._recorder, None
        return None if recorder is None else self._graph.run(recorder.close).result()


def _logger(
    graph: RemoteGraph, log: Callable[[Diagnostic], None]
) -> Callable[[Diagnostic, int], None]:
    """Takes what is to be said on ``/rosout``, with the simulation time of then."""

    def take(diagnostic: Diagnostic, time_ns: int) -> None:
        graph.saw(time_ns)
        log(diagnostic)

    return take
