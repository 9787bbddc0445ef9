"""Bridges as they run in their processes."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any, Protocol

from cartwheel.bridges.apart.link import Link
from cartwheel.bridges.apart.remote_graph import RemoteGraph
from cartwheel.errors import Diagnostic, RecordingError

_FRESH, _STALE = 0.05, 1.0
"""Age in s at which parameter values are refreshed in the background, and at which reads wait."""


class _Bridge(Protocol):
    """Interface that all bridges share."""

    def close(self) -> None:
        """Closes the bridge."""

    def log(self, diagnostic: Diagnostic) -> None:
        """Logs a diagnostic on ``/rosout``."""


class _BridgeWire:
    """A bridge in this process.

    Args:
        graph: Graph of the simulation.
        link: Link to the simulation's process.
    """

    def __init__(self, graph: RemoteGraph, link: Link) -> None:
        self._graph = graph
        self._link = link
        self._bridge: _Bridge | None = None

    def close(self) -> None:
        """Closes the bridge."""
        if self._bridge is not None:
            self._bridge.close()

    def _offer(self, bridge: _Bridge, start: Callable[[], Any]) -> None:
        """Lets the simulation's process start the bridge and log on its ``/rosout``."""
        self._bridge = bridge
        self._link.handle("start", lambda: self._graph.run(start))
        self._link.handle("log", self._log)

    def _log(self, diagnostic: Diagnostic, time_ns: int) -> None:
        assert self._bridge is not None
        self._graph.time_ns = time_ns
        self._bridge.log(diagnostic)

    def _report(self, diagnostic: Diagnostic) -> None:
        self._link.notify("report", diagnostic)

    def _time_ns(self) -> int:
        return self._graph.time_ns


class Ros1Wire(_BridgeWire):
    """See `Ros1Bridge`."""

    def __init__(self, graph: RemoteGraph, link: Link) -> None:
        super().__init__(graph, link)
        from cartwheel.bridges.ros1 import Ros1Bridge

        self._made = Ros1Bridge

    def open(self, options: dict[str, Any]) -> Any:
        """Creates the bridge. Returns its name, the master's URI, and its own URI."""
        bridge = self._made(
            self._graph,
            **options,
            report=self._report,
            time_ns=self._time_ns,
            on_end=lambda diagnostic: self._link.notify("ended", diagnostic),
        )

        def start() -> tuple[bool, tuple[int, ...]]:
            bridge.start()
            return bridge.has_own_master, bridge.open_ports

        self._offer(bridge, start)
        return bridge.name, bridge.master_uri, bridge.uri


class Ros2Wire(_BridgeWire):
    """See `Ros2Bridge`."""

    def __init__(self, graph: RemoteGraph, link: Link) -> None:
        super().__init__(graph, link)
        from cartwheel.bridges.ros2 import Ros2Bridge

        self._made = Ros2Bridge

    def open(self, options: dict[str, Any]) -> Any:
        """Creates the bridge. Returns its name and a description of its middleware."""
        from cartwheel.bridges.ros2 import Parameter

        values = _Values(self._link, self._graph)
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
        bridge = self._made(
            self._graph,
            **options,
            parameters=parameters,
            report=self._report,
            time_ns=self._time_ns,
        )

        def make_way(last: str) -> None:
            bridge.make_way(last, lambda topics: self._link.notify("taken_by_others", topics))

        self._offer(bridge, bridge.start)
        self._link.handle("make_way", make_way)
        return bridge.name, bridge.description


class _Values:
    """Cache of the node's parameters, which the simulation's process stores.

    The bridge reads them regularly, and fetches all values with one request. It does not wait
    for the response, because it could not send or receive messages meanwhile. On a busy computer a
    response takes as long as several images.
    """

    def __init__(self, link: Link, graph: RemoteGraph) -> None:
        self._link = link
        self._graph = graph
        self._values: dict[str, Any] = {}
        self._since = -math.inf
        self._asked: Future[Any] | None = None
        """A pending request that was made after the last change in this process."""
        self._lock = threading.Lock()
        """Held only briefly. Responses arrive on the link's thread."""

    def get(self, name: str) -> Any:
        age = time.monotonic() - self._since
        if age > _STALE:
            self._take(self._link.ask("values"))
        elif age > _FRESH and self._asked is None:
            self._asked = asked = self._link.call("values")
            asked.add_done_callback(self._answered)
        return self._values[name]

    def set(self, name: str, value: Any) -> None:
        self._link.ask("set_value", name, value)
        with self._lock:
            self._asked, self._since = None, -math.inf

    def _answered(self, asked: Future[Any]) -> None:
        """Handles a response on the link's thread. A failed request is repeated later."""
        with self._lock:
            if self._asked is asked:
                self._asked = None
                if asked.exception() is None:
                    self._take(asked.result())

    def _take(self, answer: tuple[int, dict[str, Any]]) -> None:
        self._graph.time_ns, self._values = answer
        self._since = time.monotonic()


class FoxgloveWire(_BridgeWire):
    """See `FoxgloveBridge`."""

    def __init__(self, graph: RemoteGraph, link: Link) -> None:
        super().__init__(graph, link)
        from cartwheel.bridges.foxglove import FoxgloveBridge

        self._made = FoxgloveBridge

    def open(self, options: dict[str, Any]) -> None:
        """Creates the bridge."""
        bridge = self._made(
            self._graph,
            **options,
            controls=_Controls(self._link, self._graph),
            assets=lambda uri: self._link.ask("asset", uri),
            report=self._report,
        )

        def start() -> str:
            bridge.start()
            return bridge.url

        self._offer(bridge, start)


class _Controls:
    """Controls for time in the simulation's process; see `Controls`."""

    def __init__(self, link: Link, graph: RemoteGraph) -> None:
        self._link = link
        self._graph = graph

    @property
    def time_ns(self) -> int:
        """Time of the message that was just received."""
        return self._graph.time_ns

    def state(self) -> Any:
        """Current state."""
        return self._link.ask("state")

    def pause(self) -> None:
        """Pauses the simulation."""
        self._link.ask("pause")

    def resume(self) -> None:
        """Resumes the simulation."""
        self._link.ask("resume")

    def set_speed(self, speed: float | None) -> None:
        """Sets the target real-time factor."""
        self._link.ask("set_speed", speed)

    def seek(self, time_ns: int) -> None:
        """Jumps to a time."""
        self._link.ask("seek", time_ns)


class RecordingWire:
    """See `Recorder`."""

    def __init__(self, graph: RemoteGraph, link: Link) -> None:
        from cartwheel.bridges.recording import Recorder
        from cartwheel.messages.store import loaded

        # Loading takes 0.3 s of CPU time, while the simulation's process builds the world.
        loaded()
        self._made = Recorder
        self._graph = graph
        self._link = link
        self._recorder: Recorder | None = None

    def open(self, options: dict[str, Any]) -> None:
        """Creates the recorder."""
        link, graph = self._link, self._graph

        def failed(error: RecordingError) -> None:
            link.notify("failed", error)

        self._recorder = recorder = self._made(
            graph,
            Path(options.pop("path")),
            **options,
            time_ns=lambda: graph.time_ns,
            report=lambda diagnostic: link.notify("report", diagnostic),
            on_failure=failed,
        )
        link.handle("start", lambda: graph.run(recorder.start))
        link.handle("update", lambda: graph.run(recorder.update))

    def close(self) -> Any:
        """Closes the recorder. Returns a `Summary`."""
        recorder, self._recorder = self._recorder, None
        return None if recorder is None else self._graph.run(recorder.close).result()
