"""Ports that are taken, and by whom."""

from __future__ import annotations

import errno

from cartwheel.control import running
from cartwheel.errors import CartwheelError, ControlError
from cartwheel.gate.listening import bound

_NEAR = 50


def refuse_taken(host: str, port: int) -> None:
    """Says who has a port before anything else is done.

    Raises:
        CartwheelError: The port cannot be listened on.
    """
    problem = _problem(host, port)
    if problem is None:
        return
    if problem.errno not in (errno.EADDRINUSE, None):
        raise CartwheelError(f"the viewer cannot listen on {host}:{port}: {problem.strerror}")
    free = next((p for p in range(port + 1, min(port + _NEAR, 65536)) if not _problem(host, p)), 0)
    other = f"Use another one: --port {free}"
    for entry in running():
        if entry.port == port:
            raise CartwheelError(
                f"port {port} is used by simulation {entry.pid} ({entry.title})",
                hint=f"{other}; or end that one: kill {entry.pid}",
            )
    raise CartwheelError(f"port {port} is used by another program", hint=f"{other}.")


def free_port(host: str, port: int) -> int:
    """The first port from `port` on that can be listened on.

    Raises:
        ControlError: There is none near.
    """
    for candidate in range(port, min(port + _NEAR, 65536)):
        if not _problem(host, candidate):
            return candidate
    raise ControlError(f"the ports {port} to {port + _NEAR - 1} of {host} are all taken")


def _problem(host: str, port: int) -> OSError | None:
    try:
        with bound(host, port):
            return None
    except OSError as error:
        return error
