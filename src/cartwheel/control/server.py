"""The server side of the control socket."""

from __future__ import annotations

import contextlib
import logging
import os
import threading
import time
from dataclasses import dataclass, field, replace
from typing import Any

from cartwheel.codes.command import CONTROL_LIMIT
from cartwheel.control import registry
from cartwheel.control.faults import refusal
from cartwheel.control.operations import Load, Operations, PageOffer
from cartwheel.control.parameters import Parameters
from cartwheel.control.protocol import Connection, Frame
from cartwheel.control.registry import Running
from cartwheel.control.stream import Streams
from cartwheel.control.wills import Wills
from cartwheel.errors import CartwheelError, ControlError
from cartwheel.forks import keep_socket
from cartwheel.graph import resolve_name
from cartwheel.interfaces import RunningSession

MAX_CLIENTS = 64
"""Maximum number of clients. A new client replaces the client that has been silent longest."""

_log = logging.getLogger(__name__)


@dataclass(slots=True)
class _Use:
    """The activity of a client."""

    busy: bool = False
    """Whether a request or subscription is in progress."""
    asked: bool = False
    since: float = field(default_factory=time.monotonic)

    @property
    def rank(self) -> tuple[bool, float]:
        """Sort key for eviction: first clients without any request, then the longest silent."""
        return self.asked, self.since


class ControlServer:
    """Gives other processes of the same user access to a session; starts at once.

    Each client has a thread that handles its requests one by one. A slow, silent or faulty client
    only uses this thread and a bounded queue. Clients that send no requests or do not read the
    responses cannot block other clients.

    Args:
        session: The session.
        title: A short description of what is simulated.
        load: Reads the file of a ``spawn`` request.
        world: Name of the world by which commands select the session; None for the world's own.
        ros: Whether the session will register at a ROS 1 master; see `announce_ros`.

    Raises:
        ControlError: The socket cannot be created.
    """

    def __init__(
        self,
        session: RunningSession,
        *,
        title: str,
        load: Load,
        world: str | None = None,
        ros: bool = False,
    ) -> None:
        self._session = session
        self._operations = Operations(session, load)
        self._closed = threading.Event()
        self._streams = Streams(session, self._closed)
        self._lock = threading.Lock()
        self._clients: dict[Connection, _Use] = {}
        self._socket, path = registry.listen()
        keep_socket(self._socket)
        self.entry = Running(
            pid=os.getpid(),
            title=title,
            world=session.simulation.world.name if world is None else world,
            ros_master="" if ros else None,
            path=path,
        )
        registry.announce(self.entry)
        self._thread = threading.Thread(target=self._accept, name="control", daemon=True)
        self._thread.start()

    def announce(self, *, url: str | None, port: int | None) -> None:
        """Publishes the location of the web viewer."""
        self._announce(replace(self.entry, url=url, port=port))

    def announce_ros(self, master: str) -> None:
        """Publishes the ROS 1 master where the simulation is registered."""
        self._announce(replace(self.entry, ros_master=master))

    def _announce(self, entry: Running) -> None:
        self.entry = entry
        if not self._closed.is_set():
            registry.announce(self.entry)

    def offer_page(self, offer: PageOffer | None) -> None:
        """Sets the web viewer, or None; clients that request it earlier wait for this call."""
        self._operations.offer_page(offer)

    def close(self) -> None:
        """Disconnects all clients and removes the socket."""
        if self._closed.is_set():
            return
        self._closed.set()
        registry.withdraw(self.entry.path)
        Connection(self._socket).close()
        with self._lock:
            clients = list(self._clients)
        for client in clients:
            client.close()

    def _accept(self) -> None:
        while not self._closed.is_set():
            try:
                sock, _ = self._socket.accept()
            except OSError:
                if self._closed.wait(0.05):
                    return
                continue  # Possibly out of file descriptors, which may be freed later.
            keep_socket(sock)
            client = Connection(sock)
            if not self._admit(client):
                client.refuse(
                    ControlError(
                        "too many clients are connected to the simulation", code=CONTROL_LIMIT
                    )
                )
                continue
            if self._closed.is_set():
                client.close()
                continue
            threading.Thread(
                target=self._serve, args=(client,), name="control-client", daemon=True
            ).start()

    def _admit(self, client: Connection) -> bool:
        """Makes room for a client if necessary; returns whether there is room."""
        with self._lock:
            if len(self._clients) >= MAX_CLIENTS:
                idle = [one for one, use in self._clients.items() if not use.busy]
                if not idle:
                    return False
                given_up = min(idle, key=lambda one: self._clients[one].rank)
                del self._clients[given_up]
                # This also ends its thread, which waits for a request.
                given_up.close()
            self._clients[client] = _Use()
        return True

    def _note(self, client: Connection, *, busy: bool) -> None:
        with self._lock:
            use = self._clients.get(client)
            if use is not None:
                use.busy, use.asked, use.since = busy, True, time.monotonic()

    def _serve(self, client: Connection) -> None:
        wills = Wills(self._session.graph)
        try:
            while (frame := client.receive()) is not None and not self._closed.is_set():
                self._note(client, busy=True)
                if frame.header.get("request") == "subscribe":
                    if self._stream(client, frame):
                        return
                else:
                    client.send(self._answer(frame, wills))
                self._note(client, busy=False)
        except ControlError as error:
            # The stream is not in sync any more, so nothing else can be read.
            with contextlib.suppress(OSError):
                client.send(refusal(error))
        except OSError:
            pass  # The client has disconnected or is too slow to receive an error.
        finally:
            client.close()
            self._execute(wills)
            with self._lock:
                self._clients.pop(client, None)

    def _execute(self, wills: Wills) -> None:
        if self._closed.is_set():
            return
        try:
            wills.execute()
        except CartwheelError as error:
            self._session.simulation.report(
                replace(
                    error.diagnostic("warning"),
                    message=f"a client's will message cannot be published: {error.message}",
                )
            )

    def _stream(self, client: Connection, frame: Frame) -> bool:
        """Serves a subscription until it ends; returns whether the request was a subscription."""
        try:
            parameters = _parameters(frame)
            topic = self._session.graph.topic(resolve_name(parameters.text("topic")))
            self._streams.serve(client, topic, parameters)
        except CartwheelError as error:
            client.send(refusal(error))
            return False
        return True

    def _answer(self, frame: Frame, wills: Wills) -> dict[str, Any]:
        try:
            name = Parameters(frame.header).text("request")
            parameters = _parameters(frame)
            if name == "publish" and "at_end" in parameters:
                # Register the will message first, so that no message can move a robot that nothing
                # stops.
                wills.take(parameters)
            answer = self._operations.run(name, parameters, frame.payload)
        except CartwheelError as error:
            return refusal(error)
        except Exception as error:  # noqa: BLE001 - a fault of ours must not end the simulation
            _log.debug("a request failed", exc_info=True)
            return refusal(error)
        return {"ok": answer}


def _parameters(frame: Frame) -> Parameters:
    return Parameters(frame.header.get("parameters", {}))
