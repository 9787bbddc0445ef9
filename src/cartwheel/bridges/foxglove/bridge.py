"""Foxglove server for a simulation."""

from __future__ import annotations

import logging
import queue
import re
import socket
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph, BridgedSubscription
from cartwheel.bridges.foxglove.clients import Clients
from cartwheel.bridges.foxglove.controls import Controls
from cartwheel.bridges.foxglove.incoming import ENCODINGS, Incoming, offered
from cartwheel.bridges.foxglove.listener import Listener, playback_state
from cartwheel.bridges.foxglove.log import TOPIC as LOG
from cartwheel.bridges.foxglove.log import Log
from cartwheel.bridges.foxglove.publication import READER, Publication
from cartwheel.bridges.foxglove.values import PAUSED, SPEED, Values
from cartwheel.bridges.mirror import offered_by_others
from cartwheel.budget import Budget
from cartwheel.codes.wires import (
    BRIDGE_FAULT,
    FOXGLOVE_NOT_STARTED,
    PACKAGE_MISSING,
    SLOW_SUBSCRIBER,
    TYPE_UNSUPPORTED,
)
from cartwheel.errors import CartwheelError, Diagnostic, Reporter
from cartwheel.gate.access import Access, refused_page
from cartwheel.gate.gate import Gate
from cartwheel.gate.listening import hidden_host, listen
from cartwheel.graph import Service, TopicInfo

PORT = 8765
"""Default port of Foxglove."""
APPS = ("https://app.foxglove.dev", "https://studio.foxglove.dev", "file://")
"""Origins of Foxglove clients: Foxglove in the browser at its new and its old address, and the
desktop programs of Foxglove and Lichtblick, which run Chromium with local files."""
BACKLOG = 256
"""Maximum number of queued messages per client. When full, the oldest is dropped."""
_CHANGES = 64
"""Maximum number of channels that are opened and closed at a time. The library disconnects
every client for which more than `BACKLOG` notifications of such changes are queued."""
_PAUSE = 0.1
"""Interval in s at which the graph is checked."""
_STATUSES, _STATUS_RATE = 32, 5.0
"""Maximum number of warnings for clients in a burst, and per s, as they count as notifications."""
_TIME_RATE = 10.0
"""Minimum rate in Hz of wall time at which clients receive the time."""
_FINE_TIME_RATE = 50.0
"""Maximum rate in Hz of wall time, while clients receive messages."""
_STRING = "std_msgs/msg/String"
_TOLD = 500
_SLOW = logging.getLogger("foxglove.websocket.connected_client.send_lossy")
_FULL = re.compile(r"client (\S+) full")

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
        self._publications: dict[str, Publication] = {}
        self._by_channel: dict[int, Publication | Log] = {}
        self._services: dict[str, Service] = {}
        self._descriptions: dict[str, str] = {}
        self._watched: dict[str, BridgedSubscription] = {}
        self._jobs: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self._pending: set[str] = set()
        self._surveying = False
        self._surveyed = 0.0
        """Time of the last survey of the graph; monotonic, in s."""
        self._warn = Reporter(self._show, _TOLD)
        self._statuses = Budget(_STATUSES, _STATUS_RATE)
        self._told_ns = -1
        self._fine_due = 0.0
        self._log: Log | None = None
        self._shown: tuple[bool, float | None] | None = None
        """Whether time is paused, and its speed, as last sent to clients."""
        self._closed = False
        self._incoming = Incoming(graph, self._warn)
        self._values = Values(
            graph, controls=controls, descriptions=self._descriptions, tell=self._warn
        )
        self._slow = _Slow(lambda client: self._jobs.put(lambda: self._warn_of_slow(client)))
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
            self._access.host, self._port, title="the Foxglove server", option="--foxglove-port"
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
        _SLOW.setLevel(logging.INFO)
        _SLOW.addHandler(self._slow)
        self._context = foxglove.Context()
        listener = Listener(
            incoming=self._incoming,
            values=self._values,
            controls=self._controls,
            subscribed=self._subscribed,
            tell=self._warn,
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
        self._by_channel[self._log.channel.id()] = self._log
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
        _SLOW.removeHandler(self._slow)
        if self._changed in self._graph.on_change:
            self._graph.on_change.remove(self._changed)
        self._jobs.put(None)
        if self._thread.is_alive():
            self._thread.join(timeout=5.0)
        for subscription in self._watched.values():
            subscription.close()
        for publication in self._publications.values():
            publication.close()
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
            publication = self._by_channel.get(channel)
            if publication is not None:
                (publication.join if joins else publication.leave)()

        self._jobs.put(note)

    def _wake(self, topic: str) -> None:
        """Called on the simulation's thread."""
        if topic not in self._pending:
            self._pending.add(topic)
            self._jobs.put(lambda: self._send(topic))

    # -- on the bridge's thread

    def _run(self) -> None:
        due = time.monotonic()
        while not self._closed:
            try:
                job = self._jobs.get(timeout=max(0.0, due - time.monotonic()))
            except queue.Empty:
                job = self._tell_time
                due = time.monotonic() + 1.0 / _TIME_RATE
            if job is None:
                return
            try:
                job()
            except CartwheelError as error:
                self._warn(error.diagnostic("warning"))
            except Exception as error:  # noqa: BLE001 - one error must not stop the others
                self._warn(BRIDGE_FAULT.because("unexpected error in the bridge", error))

    def _tell_time(self) -> None:
        state = self._controls.state()
        self._told_ns = state.time_ns
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
        publication = self._publications.get(topic)
        if publication is not None:
            self._tell_fine_time()
            publication.send()

    def _tell_fine_time(self) -> None:
        """Sends the time before messages, because some clients use it as the time of a message.

        The timestamps in messages lag behind it. Clients treat a step back as a jump, and clear
        their display.
        """
        time_ns, now = self._controls.time_ns, time.monotonic()
        if time_ns > self._told_ns and now >= self._fine_due:
            self._told_ns, self._fine_due = time_ns, now + 1.0 / _FINE_TIME_RATE
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
        """Makes the server offer what the graph offers, a limited number of changes at a time."""
        self._surveying = False
        self._surveyed = time.monotonic()
        topics = offered_by_others(self._graph, READER)
        topics.pop(LOG, None)  # The bridge provides this topic itself.
        services = {service.name: service for service in self._graph.services()}
        self._mirror_topics(topics)
        self._mirror_descriptions(topics)
        self._mirror_services(services)
        self._tell_connections(topics, services)

    def _mirror_topics(self, topics: dict[str, TopicInfo]) -> None:
        changes = 0
        for name, publication in list(self._publications.items()):
            if name in topics and topics[name].type == publication.info.type:
                publication.latched = topics[name].qos == "latched"
            elif changes < _CHANGES:
                changes += 1
                del self._publications[name]
                del self._by_channel[publication.channel.id()]
                publication.close()
        for name, info in topics.items():
            if name not in self._publications and changes < _CHANGES:
                changes += 1
                publication = Publication(
                    self._graph,
                    info,
                    context=self._context,
                    time_ns=lambda: self._controls.time_ns,
                    wake=lambda name=name: self._wake(name),  # type: ignore[misc]
                    tell=self._warn,
                )
                self._publications[name] = publication
                self._by_channel[publication.channel.id()] = publication
        if changes == _CHANGES:
            # More changes may remain.
            self._changed()

    def _mirror_descriptions(self, topics: dict[str, TopicInfo]) -> None:
        described = {
            name
            for name, info in topics.items()
            if info.type == _STRING and name.endswith("robot_description") and info.publishers
        }
        for name in set(self._watched) - described:
            self._watched.pop(name).close()
            self._descriptions.pop(name, None)
        for name in described - set(self._watched):
            self._watched[name] = self._graph.subscribe(name, self._describer(name), node=READER)

    def _describer(self, name: str) -> Callable[[Any], None]:
        def take(message: Any) -> None:
            self._descriptions[name] = message.data
            self._jobs.put(lambda: self._server.publish_parameter_values(self._values.get([name])))

        return take

    def _mirror_services(self, services: dict[str, Service]) -> None:
        gone = [name for name, one in self._services.items() if services.get(name) is not one]
        if gone:
            self._server.remove_services(gone)
            for name in gone:
                del self._services[name]
        made = []
        for name, service in services.items():
            if name not in self._services:
                try:
                    made.append(offered(self._graph, service, self._warn))
                except CartwheelError as error:
                    self._warn(
                        TYPE_UNSUPPORTED.because(
                            f"service {name} is not available to Foxglove",
                            error,
                            values={"service": name},
                        )
                    )
                self._services[name] = service
        if made:
            self._server.add_services(made)

    def _tell_connections(self, topics: dict[str, TopicInfo], services: dict[str, Service]) -> None:
        import foxglove

        graph = foxglove.ConnectionGraph()
        for info in topics.values():
            if info.publishers:
                graph.set_published_topic(info.name, sorted(set(info.publishers)))
            if info.subscribers:
                graph.set_subscribed_topic(info.name, sorted(set(info.subscribers)))
        for service in services.values():
            graph.set_advertised_service(service.name, [service.node])
        self._server.publish_connection_graph(graph)

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


class _Slow(logging.Handler):
    """Detects slow clients in the library's log, because the library offers no other notification.

    Args:
        slow: Called with the address of a slow client, on any thread.
    """

    def __init__(self, slow: Callable[[str], None]) -> None:
        super().__init__(logging.INFO)
        self._slow = slow

    def emit(self, record: logging.LogRecord) -> None:
        found = _FULL.search(record.getMessage())
        if found:
            self._slow(found[1])


def require() -> None:
    """Checks that the package foxglove-sdk is installed.

    Raises:
        CartwheelError: The package is not installed.
    """
    try:
        import foxglove  # noqa: F401
    except ImportError as error:
        raise CartwheelError(
            f"--foxglove requires the package foxglove-sdk: {error}",
            code=PACKAGE_MISSING,
            hint='pip install "cartwheel[foxglove]"',
            values={"package": "foxglove-sdk", "extra": "foxglove"},
        ) from None
