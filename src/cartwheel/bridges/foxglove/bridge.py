"""Foxglove server for a simulation."""

from __future__ import annotations

import logging
import queue
import socket
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph
from cartwheel.bridges.foxglove.clients import Clients
from cartwheel.bridges.foxglove.controls import Controls
from cartwheel.bridges.foxglove.incoming import ENCODINGS, Incoming
from cartwheel.bridges.foxglove.listener import Listener, playback_state
from cartwheel.bridges.foxglove.log import Log
from cartwheel.bridges.foxglove.mirror import Mirror
from cartwheel.bridges.foxglove.slow import SlowClients
from cartwheel.bridges.foxglove.values import PAUSED, SPEED, Values
from cartwheel.budget import Budget
from cartwheel.codes.wires import (
    BRIDGE_FAULT,
    FOXGLOVE_NOT_STARTED,
    PACKAGE_MISSING,
    SLOW_SUBSCRIBER,
)
from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.gate.access import Access, refused_page
from cartwheel.gate.gate import Gate
from cartwheel.gate.listening import hidden_host, listen
from cartwheel.options import FOXGLOVE, FOXGLOVE_PORT
from cartwheel.reporting import Reporter

PORT = 8765
"""Default port of Foxglove."""
APPS = ("https://app.foxglove.dev", "https://studio.foxglove.dev", "file://")
"""Origins of Foxglove clients: Foxglove in the browser at its new and its old address, and the
desktop programs of Foxglove and Lichtblick, which run Chromium with local files."""
BACKLOG = 256
"""Maximum number of queued messages per client. When full, the oldest is dropped."""
_PAUSE = 0.1
"""Interval in s at which the graph is checked."""
_STATUSES, _STATUS_RATE = 32, 5.0
"""Maximum number of warnings for clients in a burst, and per s, as they count as notifications."""
_TIME_RATE = 10.0
"""Minimum rate in Hz of wall time at which clients receive the time."""
_FINE_TIME_RATE = 50.0
"""Maximum rate in Hz of wall time, while clients receive messages."""
_SHOWN = 500
"""Maximum number of different warnings; see `Once`."""

Report = Callable[[Diagnostic], None]
Assets = Callable[[str], bytes | None]


class FoxgloveBridge:
    """Offers the topics, services and parameters of a graph on a Foxglove server.

    The bridge subscribes to a topic only while a client does. One thread packs and sends; the
    simulation's thread only queues its messages. A client that receives nothing costs memory, up
    to its backlog, and has no effect on anything else.

    Args:
        graph: Graph of the simulation.
        name: Server name for clients to display.
        access: Access rules. None allows all users of this computer.
        port: Port to listen on. 0 chooses a free port.
        controls: Controls of simulation time.
        assets: Returns the content of a mesh or texture by its URI, or None if it does not exist.
        time_range: Start and end in ns of a run with an end, which clients may pause and resume.
        report: Receives diagnostics for the user, on any thread.

    Raises:
        CartwheelError: The package foxglove-sdk is not installed.
    """

    def __init__(
        self,
        graph: BridgedGraph,
        *,
        name: str,
        controls: Controls,
        access: Access | None = None,
        port: int = PORT,
        assets: Assets = lambda _: None,
        time_range: tuple[int, int] | None = None,
        report: Report = lambda _: None,
    ) -> None:
        require()
        self._graph = graph
        self._name, self._port = name, port
        self._access = access or Access(host="127.0.0.1")
        self._listener: socket.socket | None = None
        self._gate: Gate | None = None
        self._controls = controls
        self._assets = assets
        self._time_range = time_range
        self._report = report
        self._server: Any = None
        self._context: Any = None
        self._jobs: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self._pending: set[str] = set()
        self._surveying = False
        self._surveyed = 0.0
        """Time of the last survey of the graph; monotonic, in s."""
        self._warn = Reporter(self._show, _SHOWN)
        self._statuses = Budget(_STATUSES, _STATUS_RATE)
        self._sent_ns = -1
        self._fine_due = 0.0
        self._log: Log | None = None
        self._shown: tuple[bool, float | None] | None = None
        """Whether time is paused, and its speed, as last sent to clients."""
        self._closed = False
        self._incoming = Incoming(graph, self._warn)
        self._offers = Mirror(
            graph,
            time_ns=lambda: self._controls.time_ns,
            wake=self._wake,
            again=self._changed,
            described=self._described,
            warn=self._warn,
        )
        self._values = Values(
            graph, controls=controls, descriptions=self._offers.descriptions, warn=self._warn
        )
        self._slow = SlowClients(lambda client: self._jobs.put(lambda: self._warn_of_slow(client)))
        self._thread = threading.Thread(target=self._run, name="foxglove", daemon=True)

    @property
    def port(self) -> int:
        """Port of the server, after `start`."""
        assert self._listener is not None
        return int(self._listener.getsockname()[1])

    @property
    def url(self) -> str:
        """URL for clients, after `start`."""
        return self._access.url("ws", self.port)

    def start(self) -> None:
        """Starts to listen.

        Raises:
            CartwheelError: The address is not available.
        """
        import foxglove
        from foxglove.websocket import Capability

        self._listener = listen(
            self._access.host, self._port, title="the Foxglove server", option=FOXGLOVE_PORT
        )
        hidden = hidden_host()
        capabilities = [
            Capability.ClientPublish,
            Capability.Parameters,
            Capability.Services,
            Capability.ConnectionGraph,
            Capability.Time,
        ]
        if self._time_range is not None:
            capabilities.append(Capability.PlaybackControl)
        # Its messages about disconnected clients are not for the terminal.
        logging.getLogger("foxglove").addHandler(logging.NullHandler())
        self._slow.start()
        self._context = foxglove.Context()
        listener = Listener(
            incoming=self._incoming,
            values=self._values,
            controls=self._controls,
            subscribed=self._subscribed,
            warn=self._warn,
        )
        try:
            self._server = foxglove.start_server(
                name=self._name,
                host=hidden,
                port=0,
                capabilities=capabilities,
                server_listener=listener,
                supported_encodings=ENCODINGS,
                asset_handler=self._assets,
                context=self._context,
                playback_time_range=self._time_range,
                message_backlog_size=BACKLOG,
            )
        except Exception as error:  # any error of the library
            self._listener.close()
            raise CartwheelError(
                f"the Foxglove server cannot start: {error}", code=FOXGLOVE_NOT_STARTED
            ) from error
        self._log = Log(context=self._context, time_ns=lambda: self._controls.time_ns)
        self._offers.start(self._server, self._context, self._log)
        self._mirror()
        self._graph.on_change.append(self._changed)
        self._thread.start()
        self._gate = Gate(
            self._listener,
            self._access,
            (hidden, int(self._server.port)),
            apps=APPS,
            refused=lambda origin: self._report(refused_page("the Foxglove server", origin)),
            client=Clients(self._warn).join,
        )
        self._gate.start()

    def close(self) -> None:
        """Disconnects all clients."""
        if self._closed:
            return
        self._closed = True
        self._slow.stop()
        if self._changed in self._graph.on_change:
            self._graph.on_change.remove(self._changed)
        self._jobs.put(None)
        if self._thread.is_alive():
            self._thread.join(timeout=5.0)
        self._offers.close()
        if self._log is not None:
            self._log.close()
        if self._server is not None:
            # Stop the server first, so that its closing messages still pass the gate.
            self._server.stop()
        if self._gate is not None:
            self._gate.close()

    def log(self, diagnostic: Diagnostic) -> None:
        """Logs a diagnostic on ``/rosout``. Callable on any thread."""
        self._jobs.put(lambda: self._log.write(diagnostic) if self._log else None)

    # -- from other threads

    def _changed(self) -> None:
        """Called with the graph locked."""
        if not self._surveying:
            self._surveying = True
            self._jobs.put(self._survey)

    def _subscribed(self, channel: int, joins: bool) -> None:
        """Called on a thread of the server."""

        def note() -> None:
            publication = self._offers.by_channel.get(channel)
            if publication is not None:
                (publication.join if joins else publication.leave)()

        self._jobs.put(note)

    def _wake(self, topic: str) -> None:
        """Called on the simulation's thread."""
        if topic not in self._pending:
            self._pending.add(topic)
            self._jobs.put(lambda: self._send(topic))

    def _described(self, topic: str) -> None:
        """Called on the simulation's thread with the topic of a new robot description."""
        self._jobs.put(lambda: self._server.publish_parameter_values(self._values.get([topic])))

    # -- on the bridge's thread

    def _run(self) -> None:
        due = time.monotonic()
        while not self._closed:
            try:
                job = self._jobs.get(timeout=max(0.0, due - time.monotonic()))
            except queue.Empty:
                job = self._send_time
                due = time.monotonic() + 1.0 / _TIME_RATE
            if job is None:
                return
            try:
                job()
            except CartwheelError as error:
                self._warn(error.diagnostic("warning"))
            except Exception as error:  # noqa: BLE001 - one error must not stop the others
                self._warn(BRIDGE_FAULT.because("unexpected error in the bridge", error))

    def _send_time(self) -> None:
        state = self._controls.state()
        self._sent_ns = state.time_ns
        self._server.broadcast_time(state.time_ns)
        # Other clients also pause time or set its speed, which must be displayed.
        shown = (state.paused, state.speed)
        if shown != self._shown:
            self._shown = shown
            self._server.publish_parameter_values(self._values.get([PAUSED, SPEED]))
            if self._time_range is not None:
                self._server.broadcast_playback_state(playback_state(state, request_id=None))

    def _send(self, topic: str) -> None:
        self._pending.discard(topic)
        publication = self._offers.publications.get(topic)
        if publication is not None:
            self._send_fine_time()
            publication.send()

    def _send_fine_time(self) -> None:
        """Sends the time before messages, because some clients use it as the time of a message.

        The timestamps in messages lag behind it. Clients treat a step back as a jump, and clear
        their display.
        """
        time_ns, now = self._controls.time_ns, time.monotonic()
        if time_ns > self._sent_ns and now >= self._fine_due:
            self._sent_ns, self._fine_due = time_ns, now + 1.0 / _FINE_TIME_RATE
            self._server.broadcast_time(time_ns)

    def _survey(self) -> None:
        """Updates the channels now, or shortly after the last update."""
        left = self._surveyed + _PAUSE - time.monotonic()
        if left > 0:
            timer = threading.Timer(left, lambda: self._jobs.put(self._mirror))
            timer.daemon = True
            timer.start()
        else:
            self._mirror()

    def _mirror(self) -> None:
        self._surveying = False
        self._surveyed = time.monotonic()
        self._offers.update()

    def _warn_of_slow(self, client: str) -> None:
        # The server sees only the gate's end of the connection.
        port = client.rpartition(":")[2]
        known = self._gate.peer(int(port)) if self._gate is not None and port.isdigit() else None
        self._warn(
            SLOW_SUBSCRIBER.diagnostic(
                f"client {known or client} is too slow, so messages to this client are dropped",
                values={"peer": known or client},
            )
        )

    def _show(self, diagnostic: Diagnostic) -> None:
        """Reports a diagnostic to the user and, at a limited rate, to clients."""
        self._report(replace(diagnostic, message=f"Foxglove: {diagnostic.message}"))
        if self._server is not None and not self._closed and self._statuses.take():
            from foxglove import StatusLevel

            self._server.publish_status(diagnostic.text, StatusLevel.Warning)


def require() -> None:
    """Checks that the package foxglove-sdk is installed.

    Raises:
        CartwheelError: The package is not installed.
    """
    try:
        import foxglove  # noqa: F401
    except ImportError as error:
        raise CartwheelError(
            f"{FOXGLOVE} requires the package foxglove-sdk: {error}",
            code=PACKAGE_MISSING,
            hint='pip install "cartwheel[foxglove]"',
            values={"package": "foxglove-sdk", "extra": "foxglove"},
        ) from None
