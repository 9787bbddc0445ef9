"""Pauses, steps and sets the speed of a running simulation."""

from __future__ import annotations

import os
from typing import Any

from cartwheel.cli.commands.clients import connect
from cartwheel.cli.console import paint, say
from cartwheel.control import ControlClient, running
from cartwheel.control.registry import VARIABLE, Running


def ask(sim: str | None, request: str, **parameters: Any) -> None:
    """Sends a request and prints the resulting time and state."""
    with connect(sim) as client:
        answer = client.request(request, **parameters)
    say(f"{answer['state']} at {answer['time']:.3f} s")


def print_status(sim: str | None) -> None:
    """Prints the simulation's state; of all simulations if several run and none is selected."""
    known = running()
    if sim is None and len(known) > 1 and VARIABLE not in os.environ:
        for entry in known:
            _print_one(entry)
            say()
        return
    with connect(sim) as client:
        _print_client(client)


def _print_one(entry: Running) -> None:
    with ControlClient(entry) as client:
        _print_client(client)


def _print_client(client: ControlClient) -> None:
    entry, status = client.simulation, client.request("status")
    speed = "max" if status["speed"] is None else f"{status['speed']:g}"
    selected = f", --sim {entry.selector}" if entry.has_siblings else ""
    rows = [
        ("simulation", f"{entry.title} (process {entry.pid}{selected})"),
        ("viewer", entry.url or "none"),
        ("world", status["world"]),
        ("models", ", ".join(status["models"]) or "none"),
        ("state", status["state"]),
        ("time", f"{status['time']:.3f} s in steps of {status['step'] * 1000:g} ms"),
        ("speed", f"{speed}, measured {status['real_time_factor']:.2f}"),
    ]
    if status["warnings"]:
        rows.append(("warnings", str(status["warnings"])))
    width = max(len(name) for name, _ in rows)
    for name, value in rows:
        say(f"{paint(name.ljust(width), 'dim')}  {value}")
