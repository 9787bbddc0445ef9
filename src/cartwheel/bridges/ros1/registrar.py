"""Keeps the master told what this node offers, also the next master where one is restarted."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from cartwheel.bridges.ros1.master import Call, MasterParameters, call_all
from cartwheel.bridges.ros1.rpc import Peer, RpcError, UnreachableError

_INTERVAL = 1.0
"""s between two looks at the master."""
_FAREWELL = 0.2
"""s that the master has for our farewell."""


@dataclass(frozen=True, slots=True)
class Entry:
    """Something of this node that the master knows or shall know."""

    kind: Literal["Publisher", "Subscriber", "Service"]
    name: str
    type: str


class Registrar:
    """Registers, on a thread of its own.

    Args:
        master_uri: Where the master is.
        node: Our name.
        uri: Of our XML-RPC interface.
        service_uri: Of our services.
        parameters: What is to be set.
        survey: Brings this node up to date with the graph and returns what it offers now.
        on_publishers: Gets the publishers of a topic that was subscribed to.
        on_lost: Told why the master does not answer; it may bring one back.
        on_found: Told when one answers again.
        on_taken: Told who took our name.
        on_fault: Told of what went wrong here.
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
        """Registrations without an answer: a master that was frozen may still carry them out."""
        self._wanted: list[Entry] = []
        self._thread = threading.Thread(target=self._run, name="ros1 registrar", daemon=True)

    def start(self) -> None:
        """Begins."""
        self._event.set()
        self._thread.start()

    def wake(self) -> None:
        """Something has changed; from any thread, and at once."""
        self._event.set()

    def stop(self) -> None:
        """Takes everything back from the master; soon, whatever the master does."""
        self._stopped = True
        self._event.set()
        free = self._exclusive.acquire(timeout=_FAREWELL)
        try:
            entries = list(self._registered | self._doubtful)
            if entries and not self._lost:
                calls = [self._unregister(entry) for entry in entries]
                call_all(Peer(self._master_uri, timeout=_FAREWELL), calls)
        except RpcError:
            pass  # Whoever comes after us has a master to clean up.
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
                except Exception as error:  # noqa: BLE001 - the next change may go well
                    self._on_fault(error)

    def _look(self) -> None:
        """Whether the master still knows us, or another of our name."""
        try:
            known = self._peer.call("lookupNode", self._node, self._node)
        except UnreachableError:
            raise
        except RpcError:
            known = None
        if not isinstance(known, str):
            # Not an address: no other node took the name.
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
        """Makes what is registered what is wanted, in one call."""
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
