"""Checks whether ports are in use, and by which process."""

from __future__ import annotations

import errno

from cartwheel.codes.command import PORT_TAKEN
from cartwheel.codes.wires import ADDRESS_UNAVAILABLE
from cartwheel.control import running
from cartwheel.errors import CartwheelError, ControlError
from cartwheel.gate.listening import bound
from cartwheel.options import PORT

_NEAR = 50


def refuse_taken(host: str, port: int) -> None:
    """Raises an early error if a port is in use.

    Raises:
        CartwheelError: The port is not available.
    """
    problem = _problem(host, port)
    if problem is None:
        return
    if problem.errno not in (errno.EADDRINUSE, None):
        raise CartwheelError(
            f"the web interface cannot listen on {host}:{port}: {problem.strerror}",
            code=ADDRESS_UNAVAILABLE,
            values={"host": host, "port": port},
        )
    free = next((p for p in range(port + 1, min(port + _NEAR, 65536)) if not _problem(host, p)), 0)
    other = f"Use a different port: {PORT.given(free)}"
    for entry in running():
        if entry.port == port:
            raise CartwheelError(
                f"port {port} is in use by simulation {entry.pid} ({entry.title})",
                code=PORT_TAKEN,
                hint=f"{other}. Or stop that simulation: kill {entry.pid}",
                values={"port": port, "pid": entry.pid},
            )
    raise CartwheelError(
        f"port {port} is in use by another program",
        code=PORT_TAKEN,
        hint=f"{other}.",
        values={"port": port},
    )


def free_port(host: str, port: int) -> int:
    """The first available port from `port` on.

    Raises:
        ControlError: No port nearby is available.
    """
    for candidate in range(port, min(port + _NEAR, 65536)):
        if not _problem(host, candidate):
            return candidate
    raise ControlError(
        f"all ports from {port} to {port + _NEAR - 1} on {host} are in use",
        code=PORT_TAKEN,
        values={"port": port},
    )


def _problem(host: str, port: int) -> OSError | None:
    try:
        with bound(host, port):
            return None
    except OSError as error:
        return error
