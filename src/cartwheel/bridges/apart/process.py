"""A bridge process, seen from the simulation's process."""

from __future__ import annotations

import contextlib
import json
import socket
import sys
from collections.abc import Callable, Mapping
from subprocess import DEVNULL, Popen, TimeoutExpired
from typing import Any

from cartwheel.bridges.apart.host import GraphHost
from cartwheel.bridges.apart.link import Handler, Link
from cartwheel.bridges.apart.ring import RingWriter
from cartwheel.bridges.apart.ring_files import RingFiles
from cartwheel.codes.wires import BRIDGE_ENDED, BRIDGE_FAULT, BRIDGE_SLOW
from cartwheel.errors import CartwheelError, ControlError, Diagnostic
from cartwheel.forks import keep_socket
from cartwheel.graph import Graph
from cartwheel.options import caller
from cartwheel.reporting import Reporter

_START = 60.0
"""Timeout in s for the process to start and to connect."""
_END = 2.0
"""Timeout in s for the process to close its connections."""
_PROGRAM = """
import json, sys
sys.path[:] = json.loads(sys.argv[1])
from cartwheel.bridges.apart.child import main
main(*sys.argv[2:])
"""
_MOST_WARNINGS = 500

Report = Callable[[Diagnostic], None]


class BridgeProcess:
    """Starts a bridge process. It starts up while the simulation reads its files.

    Args:
        kind: Kind of bridge: a key of `child.WIRES`.
        title: Name of the bridge for the user.
        patient: Whether the simulation waits for a slow bridge, instead of dropping messages.
    """

    def __init__(self, kind: str, title: str, *, patient: bool = False) -> None:
        self.title = title
        self._patient = patient
        self._link: Link | None = None
        self._host: GraphHost | None = None
        self._report: Report = lambda _: None
        self._warn = Reporter(self._pass_on, _MOST_WARNINGS, title=title)
        self._closing = False
        self.on_lost: Callable[[], None] = lambda: None
        """Called on a separate thread when the process has exited unexpectedly."""
        self._own, theirs = socket.socketpair()
        keep_socket(self._own)
        self._files, their_files = RingFiles.pair()
        patience = "patient" if patient else ""
        self._process = Popen(  # noqa: S603 - runs Python with this package
            [
                *(sys.executable, "-c", _PROGRAM, json.dumps(sys.path)),
                *(kind, patience, caller().value, str(theirs.fileno()), str(their_files)),
            ],
            pass_fds=[theirs.fileno(), *their_files.numbers],
            stdin=DEVNULL,
            # Cartwheel handles Ctrl-C in a terminal.
            start_new_session=True,
        )
        theirs.close()
        their_files.close()

    @property
    def pid(self) -> int:
        """Process ID."""
        return self._process.pid

    @property
    def written(self) -> int:
        """Bytes of messages sent so far."""
        return self._ring.written

    def open(
        self,
        graph: Graph,
        options: Mapping[str, Any],
        *,
        time_ns: Callable[[], int],
        echo: bool,
        report: Report,
        handlers: Mapping[str, tuple[Handler, bool]],
    ) -> Any:
        """Creates the bridge.

        Args:
            graph: Graph of the simulation.
            options: Options of the bridge.
            time_ns: Returns the simulation time. Callable on any thread.
            echo: Whether the bridge receives the messages that it publishes.
            report: Receives diagnostics for the user, on any thread.
            handlers: Additional functions that the bridge may call, by name, and whether each may
                be slow.

        Returns:
            Description of the bridge.

        Raises:
            CartwheelError: The bridge cannot be created.
        """
        self._report = report
        self._ring = RingWriter(self._files)
        self._link = Link(self._own, name=self.title, on_end=self._ended, on_fault=self._fault)
        self._host = GraphHost(
            graph,
            self._link,
            self._ring,
            time_ns=time_ns,
            patient=self._patient,
            echo=echo,
            title=self.title,
            report=report,
        )
        self._link.handle("report", report)
        for name, (handler, threaded) in handlers.items():
            self._link.handle(name, handler, threaded=threaded)
        self._link.start()
        return self.call("open", dict(options))

    def call(self, name: str, *arguments: Any, timeout: float | None = _START) -> Any:
        """Calls a function in the bridge process, and returns its result.

        Raises:
            CartwheelError: The bridge refused, or its process has exited.
        """
        assert self._link is not None
        try:
            return self._link.call(name, *arguments).result(timeout)
        except TimeoutError:
            raise CartwheelError(
                f"the process for {self.title} did not respond within {timeout:g} s",
                code=BRIDGE_SLOW,
                values={"bridge": self.title, "seconds": timeout},
            ) from None
        except ControlError as error:
            if error.code is not BRIDGE_ENDED:
                raise  # Errors of the bridge itself, such as a port in use.
            raise ControlError(
                self._death, code=BRIDGE_ENDED, values={"bridge": self.title}
            ) from None

    def notify(self, name: str, *arguments: Any) -> None:
        """Calls a function in the bridge process without waiting for a result."""
        if self._link is not None:
            self._link.notify(name, *arguments)

    def leave_graph(self) -> None:
        """Stops sending messages. Callable on any thread."""
        if self._host is not None:
            self._host.close()

    def close(self) -> None:
        """Stops the process. Returns at once if the bridge has no remaining work."""
        if self._closing:
            return
        self._closing = True
        self.leave_graph()
        if self._link is None:
            self._process.kill()
            self._own.close()
            self._files.close()
        else:
            with contextlib.suppress(Exception):
                self.call("close", self.written, timeout=_END)
            self._link.close()
            self._ring.close()
        try:
            self._process.wait(_END)
        except TimeoutExpired:
            self._process.kill()

    @property
    def _death(self) -> str:
        return f"the process for {self.title} has exited"

    def _ended(self) -> None:
        """Called on the link's thread."""
        if self._closing:
            return
        self.leave_graph()
        self._ring.close()
        self._report(BRIDGE_ENDED.diagnostic(self._death, values={"bridge": self.title}))
        self.on_lost()

    def _pass_on(self, diagnostic: Diagnostic) -> None:
        self._report(diagnostic)

    def _fault(self, error: Exception) -> None:
        if isinstance(error, CartwheelError):
            diagnostic = error.diagnostic("warning")
        else:
            diagnostic = BRIDGE_FAULT.because("unexpected error in the bridge", error)
        self._warn(diagnostic)
