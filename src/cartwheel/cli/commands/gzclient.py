"""Opens the web viewer of the running simulation, as Gazebo's client opens its window."""

from __future__ import annotations

import contextlib
import functools
import os
import time
import webbrowser
from collections.abc import Sequence
from urllib.parse import urlsplit

from cartwheel.bridges.ros1.address import MASTER_URI, is_local
from cartwheel.cli import interrupts
from cartwheel.cli.commands.desktop import has_display
from cartwheel.cli.commands.gazebo_arguments import parse_client
from cartwheel.cli.console import note, paint, say
from cartwheel.codes.command import SIMULATION_AMBIGUOUS, SIMULATION_ENDED, SIMULATION_NOT_RUNNING
from cartwheel.control import ControlClient, Running, find, running
from cartwheel.control.registry import VARIABLE
from cartwheel.errors import ControlError

_TELL = 1.0
"""Waiting time after which the user is informed, s."""
_LOOKS = 0.1
"""Interval of checks, s."""
_BROWSER = 60.0
"""Maximum time for an opened browser to connect, s."""


def show(words: Sequence[str]) -> None:
    """Opens the web viewer in a browser, or prints its URL, until the simulation ends.

    Raises:
        CartwheelError: No simulation is running, or it has no web viewer.
    """
    arguments = parse_client(words)
    if arguments.tell():
        return
    special = dict(word.split(":=", 1) for word in arguments.ros)
    master = special.get("__master") or os.environ.get("ROS_MASTER_URI")
    simulation = find() if os.environ.get(VARIABLE) else wait_for_simulation(master or None)
    with contextlib.suppress(interrupts.Interrupted):  # The normal way to end it.
        _stay(simulation)


def wait_for_simulation(master: str | None) -> Running:
    """The simulation to show: the newest on a ROS master, which this function waits for.

    Args:
        master: URI of the master. None uses a running simulation on the default master or without
            ROS, without waiting.

    Raises:
        ControlError: There is no such simulation (without waiting), or several; or the parent
            process has ended.
    """
    began, parent, reported = time.monotonic(), os.getppid(), False
    while True:
        known = running()
        ours = [entry for entry in known if is_same(entry.ros_master, master or MASTER_URI)]
        if ours:
            return ours[-1]
        if master is None and not any(entry.ros_master == "" for entry in known):
            return _without_ros(known)
        if os.getppid() != parent:
            raise ControlError("the parent process has exited", code=SIMULATION_ENDED)
        if time.monotonic() - began > _TELL and not reported:
            reported = True
            note(f"waiting for a simulation that uses the ROS master {master or MASTER_URI}")
            if known:
                hint = f"set {VARIABLE}=PID to show one of them"
                note(f"other simulations are running; {hint}\n{_listing(known)}")
        time.sleep(_LOOKS)


def _without_ros(known: Sequence[Running]) -> Running:
    """The only simulation without ROS."""
    found = [entry for entry in known if entry.ros_master is None]
    if len(found) == 1:
        return found[0]
    if not known:
        raise ControlError(
            "no simulation is running",
            code=SIMULATION_NOT_RUNNING,
            hint="Start one with: cartwheel run",
        )
    problem = (
        f"{len(found)} simulations without ROS are running"
        if found
        else f"no running simulation uses the ROS master {MASTER_URI} or runs without ROS"
    )
    raise ControlError(
        problem,
        code=SIMULATION_AMBIGUOUS if found else SIMULATION_NOT_RUNNING,
        hint=f"Select one with {VARIABLE}=PID. Running simulations:\n{_listing(known)}",
    )


def _listing(known: Sequence[Running]) -> str:
    return "\n".join(
        f"    {entry}{f', ROS master {entry.ros_master}' if entry.ros_master else ''}"
        for entry in known
    )


def is_same(uri: str | None, other: str) -> bool:
    """Whether two URIs refer to the same ROS master; a computer may have several names."""
    return bool(uri) and uri is not None and _place(uri) == _place(other)


@functools.cache
def _place(uri: str) -> tuple[str, int | None]:
    try:
        parts = urlsplit(uri)
        host, port = parts.hostname or "", parts.port
        return "localhost" if is_local(host) else host, port
    except ValueError:
        return uri, None


def _open(url: str) -> bool:
    """Whether a program to open the URL was found."""
    try:
        return webbrowser.open(url)
    except webbrowser.Error:
        return False


def _stay(simulation: Running) -> None:
    with ControlClient(simulation) as client:
        page = client.request("page")
        say(f"web interface: {paint(page['url'], 'bold', 'cyan')}")
        if has_display() and _open(page["url"]):
            with contextlib.suppress(ControlError):  # it has ended, as seen below
                _look_for_browser(client, page["browsers"])
        client.wait_for_end()


def _look_for_browser(client: ControlClient, before: int) -> None:
    """Reports whether a browser has connected: a started program may show nothing."""
    deadline = time.monotonic() + _BROWSER
    while time.monotonic() < deadline:
        if client.request("page")["browsers"] > before:
            say("the simulation is shown in the browser")
            return
        time.sleep(_LOOKS)
    note("no browser has opened the web interface")
