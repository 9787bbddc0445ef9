"""The page of the running simulation, opened as Gazebo's client opens its window."""

from __future__ import annotations

import contextlib
import os
import socket
import time
import webbrowser
from collections.abc import Sequence
from urllib.parse import urlsplit

from cartwheel.cli import interrupts
from cartwheel.cli.commands.desktop import has_display
from cartwheel.cli.commands.gazebo_arguments import parse_client
from cartwheel.cli.console import note, paint, say
from cartwheel.control import ControlClient, Running, find, running
from cartwheel.errors import ControlError

PATIENCE = 60.0
"""s to wait for a simulation that is about to start."""
_ALONE = 4.0
"""s after which a simulation that is no part of our ROS will do."""
_TELL = 3.0


def show(words: Sequence[str]) -> None:
    """Opens the page in a browser, or tells its address, until the simulation ends.

    Raises:
        CartwheelError: No simulation runs, or it has no page.
    """
    arguments = parse_client(words)
    if arguments.tell():
        return
    with contextlib.suppress(interrupts.Interrupted):  # The way to end it.
        _stay(wait_for_simulation(os.environ.get("ROS_MASTER_URI")))


def wait_for_simulation(master: str | None, *, patience: float = PATIENCE) -> Running:
    """The simulation to show: the newest of this ROS, or the only one where none is.

    Args:
        master: Its URI; None without ROS.
        patience: s to wait for one.

    Raises:
        ControlError: There is none, or there are several and none is of this ROS.
    """
    if master is None:
        return find()
    began = time.monotonic()
    told = False
    while True:
        ours = [entry for entry in running() if is_same(entry.ros_master, master)]
        if ours:
            return ours[-1]
        waited = time.monotonic() - began
        if waited > _ALONE:
            try:
                return find()
            except ControlError:
                if running() or waited > patience:
                    raise
        if waited > _TELL and not told:
            told = True
            note("waiting for a simulation: none runs yet")
        time.sleep(0.05)


def is_same(uri: str | None, other: str) -> bool:
    """Whether two URIs mean the same ROS master; one computer has several names."""
    return uri is not None and _place(uri) == _place(other)


def _place(uri: str) -> tuple[str, int | None]:
    parts = urlsplit(uri)
    host = parts.hostname or ""
    local = host.startswith("127.") or host in ("localhost", "::1", socket.gethostname())
    return "localhost" if local else host, parts.port


def _open(url: str) -> bool:
    """Whether a browser was there to be opened."""
    try:
        return webbrowser.open(url)
    except webbrowser.Error:
        return False


def _stay(simulation: Running) -> None:
    with ControlClient(simulation) as client:
        url = client.request("page")["url"]
        opened = has_display() and _open(url)
        what = "shown in the browser" if opened else "the page is at"
        say(f"{what}  {paint(url, 'bold', 'cyan')}")
        client.wait_for_end()
