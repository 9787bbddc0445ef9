"""Main program of a bridge process."""

from __future__ import annotations

import gc
import importlib
import os
import signal
import socket
import threading
import traceback
from typing import Any, Protocol

from cartwheel.bridges.apart.link import Link
from cartwheel.bridges.apart.remote_graph import RemoteGraph
from cartwheel.bridges.apart.ring import RingReader
from cartwheel.bridges.apart.ring_files import RingFiles
from cartwheel.codes.wires import BRIDGE_FAULT
from cartwheel.options import Caller, set_caller

WIRES = {
    "ros1": "Ros1Wire",
    "ros2": "Ros2Wire",
    "foxglove": "FoxgloveWire",
    "recording": "RecordingWire",
}
"""Class names in `wires`, by kind."""


class Wire(Protocol):
    """A bridge in this process."""

    def open(self, options: dict[str, Any]) -> Any:
        """Creates the bridge, and returns its description."""

    def close(self) -> Any:
        """Closes the bridge, and returns its results."""


def main(kind: str, patient: str, caller: str, link_file: str, ring_files: str) -> None:
    """Runs a bridge until the simulation's process stops it, or exits.

    Args:
        kind: Key of `WIRES`.
        patient: Non-empty if no message may be dropped.
        caller: Value of the `Caller` of the simulation's process.
        link_file: File descriptor of the link's socket.
        ring_files: File descriptors of the ring's reader.
    """
    set_caller(Caller(caller))
    # A service manager may send these signals to all of its processes. The simulation's process
    # handles them, and this process ends after the simulation, when all messages are written.
    # A handler, because programs that a bridge starts would inherit ignored signals.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: None)
    over = threading.Event()

    def fault(error: Exception) -> None:
        link.notify(
            "report",
            BRIDGE_FAULT.because("unexpected error in the bridge", error),
        )

    link = Link(socket.socket(fileno=int(link_file)), name="link", on_end=over.set, on_fault=fault)
    graph = RemoteGraph(link, on_fault=fault)
    reader = RingReader(
        RingFiles.of(ring_files),
        patient=bool(patient),
        take=graph.take,
        on_fault=fault,
    )
    module = importlib.import_module("cartwheel.bridges.apart.wires")
    wire: Wire = getattr(module, WIRES[kind])(graph, link)

    def begin(options: dict[str, Any]) -> Any:
        graph.begin()
        reader.start()
        return wire.open(options)

    def close(written: int) -> Any:
        reader.read_to(written)
        return wire.close()

    link.handle("open", begin, threaded=True)
    link.handle("close", close, threaded=True)
    gc.collect()
    gc.freeze()
    link.start()
    over.wait()
    try:
        # Messages that the simulation sent before it ended are still in the ring.
        reader.read_all()
        wire.close()
    except Exception:  # noqa: BLE001 - nothing is left to report to
        traceback.print_exc()
    os._exit(0)
