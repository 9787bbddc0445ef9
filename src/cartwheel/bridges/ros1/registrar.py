"""Registers the node's topics and services with the master, and again if the master restarts."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from cartwheel.bridges.ros1.master import Call, MasterParameters, call_all
from cartwheel.bridges.ros1.rpc import Peer, RpcError, UnreachableError

_INTERVAL = 1.0
"""Interval in s at which the master is checked."""
_FAREWELL = 0.2
"""Timeout in s for unregistering."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A registration of this node with the master."""

    kind: Literal["Publisher", "Subscriber", "Service"]
    name: str
    type: str


class Registrar:
    """Registers the node on a separate thread.

    Args:
        master_uri: URI of the master.
        node: Name of the node.
        uri: URI of the node's XML-RPC interface.
        service_uri: URI of the node's services.
        parameters: Parameters to set on the master.
        survey: Updates the node from the graph, and returns its current registrations.
        on_publishers: Called with the publishers of a subscribed topic.
        on_lost: Called with the reason when the master does not respond. It may restart the
            master.
        on_found: Called when a master responds again.
        on_taken: Called with the node that has taken this node's name.
        on_fault: Called with unexpected errors.
    """

    def __init__(
        self,
        *,
        master_uri: str,
        node: str,
        uri: str,
        service_uri: str,
        parameters: MasterParameters,
        survey: Callable[[], list[Entry]],
        on_publishers: Callable[[str, list[str]], None],
        on_lost: Callable[[str], None],
        on_found: Callable[[], None],
        on_taken: Callable[[str], None],
        on_fault: Callable[[Exception], None],
    ) -> None:
        self._master_uri = master_uri
        self._peer = Peer(master_uri)
        self._node = node
        self._uri = uri
        self._service_uri = service_uri
        self._parameters = parameters
        self._survey = survey
        self._on_publishers = on_publishers
        self._on_lost = on_lost
        self._on_found = on_found
        self._on_taken = on_taken
        self._on_fault = on_fault
        self._event = threading.Event()
        self._exclusive = threading.Lock()
        self._stopped = False
        self._lost = False
        self._registered: dict[Entry, None] = {}
        self._doubtful: dict[Entry, None] = {}
        """Registrations without a response, which a frozen master may still execute later."""
        self._wanted: list[Entry] = []
        self._thread = threading.Thread(target=self._run, name="ros1 registrar", daemon=True)

    def start(self) -> None:
        """Starts the thread."""
        self._event.set()
        self._thread.start()

    def wake(self) -> None:
        """Requests an update. Returns at once. Callable on any thread."""
        self._event.set()

    def stop(self) -> None:
        """Unregisters everything soon, even if the master does not respond."""
        self._stopped = True
        self._event.set()
        free = self._exclusive.acquire(timeout=_FAREWELL)
        try:
            entries = list(self._registered | self._doubtful)
            if entries and not self._lost:
                calls = [self._unregister(entry) for entry in entries]
                call_all(Peer(self._master_uri, timeout=_FAREWELL), calls)
        except RpcError:
            pass  # The next node with this name will clean up the registrations.
        finally:
            if free:
                self._exclusive.release()

    def _run(self) -> None:
        while not self._stopped:
            changed = self._event.wait(_INTERVAL)
            self._event.clear()
            with self._exclusive:
                if self._stopped:
                    return
                try:
                    if changed:
                        self._wanted = self._survey()
                    if not changed or self._lost:
                        self._look()
                    if not self._lost:
                        self._match()
                except UnreachableError as error:
                    self._lose(error)
                except Exception as error:  # noqa: BLE001 - the next update may succeed
                    self._on_fault(error)

    def _look(self) -> None:
        """Checks whether the master still has this node, or a different node with its name."""
        try:
            known = self._peer.call("lookupNode", self._node, self._node)
        except UnreachableError:
            raise
        except RpcError:
            known = None
        if not isinstance(known, str):
            # The value is not an address, so no different node has taken the name.
            known = None
        self._parameters.reachable = True
        if known is None and self._registered:
            self._registered.clear()
            self._parameters.remember()
        if self._lost or (known is None and self._wanted):
            was_lost, self._lost = self._lost, False
            if was_lost or known is None:
                self._on_found()
        if known is not None and known != self._uri:
            self._stopped = True
            self._on_taken(str(known))

    def _lose(self, error: UnreachableError) -> None:
        if not self._lost and not self._stopped:
            self._lost = True
            self._parameters.reachable = False
        self._on_lost(str(error))

    def _match(self) -> None:
        """Updates the registrations on the master in one call."""
        if self._stopped:
            return
        wanted = dict.fromkeys(self._wanted)
        gone = [entry for entry in self._registered | self._doubtful if entry not in wanted]
        new = [entry for entry in wanted if entry not in self._registered]
        values = self._parameters.take()
        if not (gone or new or values):
            return
        calls: list[Call] = [
            ("setParam", (self._node, name, value)) for name, value in values.items()
        ]
        calls += [self._unregister(entry) for entry in gone]
        calls += [self._register(entry) for entry in new]
        self._doubtful.update(dict.fromkeys(new))
        answers = call_all(self._peer, calls)
        self._doubtful.clear()
        self._parameters.sent(values)
        for entry in gone:
            self._registered.pop(entry, None)
        for entry, answer in zip(new, answers[len(calls) - len(new) :], strict=True):
            self._registered[entry] = None
            if entry.kind == "Subscriber" and isinstance(answer, list):
                self._on_publishers(entry.name, [str(uri) for uri in answer])

    def _register(self, entry: Entry) -> Call:
        second = self._service_uri if entry.kind == "Service" else entry.type
        return f"register{entry.kind}", (self._node, entry.name, second, self._uri)

    def _unregister(self, entry: Entry) -> Call:
        last = self._service_uri if entry.kind == "Service" else self._uri
        arguments: tuple[Any, ...] = (self._node, entry.name, last)
        return f"unregister{entry.kind}", arguments
