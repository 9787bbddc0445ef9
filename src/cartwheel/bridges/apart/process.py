"""A process for one bridge, seen from the simulation's."""

from __future__ import annotations

import contextlib
import json
import socket
import subprocess
import sys
from collections.abc import Callable, Mapping
from typing import Any

from cartwheel.bridges.apart.host import GraphHost
from cartwheel.bridges.apart.link import Handler, Link
from cartwheel.bridges.apart.ring import RingFiles, RingWriter
from cartwheel.codes.wires import BRIDGE_ENDED, BRIDGE_FAULT, BRIDGE_SLOW
from cartwheel.errors import CartwheelError, ControlError, Diagnostic, Reporter
from cartwheel.graph import Graph

_START = 60.0
"""s that the process may take to come up, and to join others."""
_END = 2.0
"""s that it may take to say farewell."""
_PROGRAM = """
import json, sys
sys.path[:] = json.loads(sys.argv[1])
from cartwheel.bridges.apart.child import main
main(*sys.argv[2:])
"""
_TOLD = 500

Report = Callable[[Diagnostic], None]


class BridgeProcess:
    """Comes up while the simulation still reads its files.

    Args:
        kind: Which bridge: one of `child.WIRES`.
        title: As the user knows it.
        patient: Nothing may be lost: the simulation waits where the bridge is slow.
    """

    def __init__(self, kind: str, title: str, *, patient: bool = False) -> None:
        self.title = title
        self._patient = patient
        self._link: Link | None = None
        self._host: GraphHost | None = None
        self._report: Report = lambda _: None
        self._warn = Reporter(self._pass_on, _TOLD, title=title)
        self._closing = False
        self.on_lost: Callable[[], None] = lambda: None
        """Told when the process has ended by itself; on another thread."""
        self._own, theirs = socket.socketpair()
        self._files, their_files = RingFiles.pair()
        patience = "patient" if patient else ""
        self._process = subprocess.Popen(  # noqa: S603 - this very program
            [
                *(sys.executable, "-c", _PROGRAM, json.dumps(sys.path)),
                *(kind, patience, str(theirs.fileno()), str(their_files)),
            ],
            pass_fds=[theirs.fileno(), *their_files.numbers],
            stdin=subprocess.DEVNULL,
            # Ctrl-C in a terminal is for us.
            start_new_session=True,
        )
        theirs.close()
        their_files.close()

    @property
    def pid(self) -> int:
        """Of the process."""
        return self._process.pid

    @property
    def written(self) -> int:
        """Bytes of messages that were handed on so far."""
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
        """Makes the bridge.

        Args:
            graph: Of the simulation.
            options: Of the bridge.
            time_ns: Tells simulation time; on any thread.
            echo: Whether the bridge hears what it has published itself.
            report: Takes what the user should know, from any thread.
            handlers: What else it may call, by name, and whether that may take long.

        Returns:
            What the bridge tells of itself.

        Raises:
            CartwheelError: There can be no such bridge.
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
        """Has the bridge do something, and waits for what it gives.

        Raises:
            CartwheelError: The bridge refused, or is not there.
        """
        assert self._link is not None
        try:
            return self._link.call(name, *arguments).result(timeout)
        except TimeoutError:
            raise CartwheelError(
                f"{self.title} did not respond within {timeout:g} s",
                code=BRIDGE_SLOW,
                values={"bridge": self.title, "seconds": timeout},
            ) from None
        except ControlError as error:
            if error.code is not BRIDGE_ENDED:
                raise  # What the bridge says itself, such as a port that is in use.
            raise ControlError(
                self._death, code=BRIDGE_ENDED, values={"bridge": self.title}
            ) from None

    def tell(self, name: str, *arguments: Any) -> None:
        """Has the bridge do something."""
        if self._link is not None:
            self._link.tell(name, *arguments)

    def leave_graph(self) -> None:
        """Hands no messages on from now on; from any thread."""
        if self._host is not None:
            self._host.close()

    def close(self) -> None:
        """Ends it; takes no longer than an instant where the bridge has nothing left to do."""
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
        except subprocess.TimeoutExpired:
            self._process.kill()

    @property
    def _death(self) -> str:
        return f"the process that runs {self.title} has exited"

    def _ended(self) -> None:
        """On the link's thread."""
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
