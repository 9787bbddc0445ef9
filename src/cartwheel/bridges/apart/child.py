"""The program of a bridge's process."""

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
from cartwheel.bridges.apart.ring import RingFiles, RingReader
from cartwheel.codes.wires import BRIDGE_FAULT

WIRES = {
    "ros1": "Ros1Wire",
    "ros2": "Ros2Wire",
    "foxglove": "FoxgloveWire",
    "recording": "RecordingWire",
}
"""The classes of `wires`, by kind."""


class Wire(Protocol):
    """A bridge in this process."""

    def open(self, options: dict[str, Any]) -> Any:
        """Makes it; tells what it is."""

    def close(self) -> Any:
        """Ends it; tells what became of it."""


def main(kind: str, patient: str, link_file: str, ring_files: str) -> None:
    """Runs a bridge until the simulation's process says so, or has ended.

    Args:
        kind: One of `WIRES`.
        patient: Not empty where nothing may be lost.
        link_file: Number of the link's socket.
        ring_files: Of the ring's reader.
    """
    # They may be sent to all of a service's processes. The simulation's hears of them, and its end
    # is heard here: until then there may be something to be written.
    # A handler, since a program that a bridge starts would inherit an ignored signal.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: None)
    over = threading.Event()

    def fault(error: Exception) -> None:
        link.tell(
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
        # What the simulation had handed on before it ended, in whatever way, is still there.
        reader.read_all()
        wire.close()
    except Exception:  # noqa: BLE001 - nobody is left to be told
        traceback.print_exc()
    os._exit(0)
