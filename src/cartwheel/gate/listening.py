"""Sockets to listen on, and addresses that nobody can guess."""

from __future__ import annotations

import ipaddress
import socket

from cartwheel.codes.wires import ADDRESS_UNAVAILABLE
from cartwheel.errors import ControlError

BACKLOG = 128
"""Connections that the system holds until they are accepted."""


def resolve(host: str, port: int) -> tuple[socket.AddressFamily, tuple[str, int]]:
    """The address that a name stands for; IPv4 first, as ``localhost`` is both.

    Args:
        host: Name or address; empty for all of this computer's.
        port: 0 to 65535.

    Raises:
        OSError: The name is unknown, or the port out of range.
    """
    if not 0 <= port <= 65535:
        raise OSError(f"port {port} is not between 0 and 65535")
    name = host or "0.0.0.0"  # noqa: S104 - the user's own words
    found = socket.getaddrinfo(
        # As bytes: for a text Python loads its tables of other alphabets, which takes ms.
        name.encode() if name.isascii() else name,
        port,
        type=socket.SOCK_STREAM,
        flags=socket.AI_PASSIVE,
    )
    family, _, _, _, address = min(found, key=lambda each: each[0] != socket.AF_INET)
    return family, (str(address[0]), port)


def listen(host: str, port: int, *, title: str, option: str) -> socket.socket:
    """A socket that listens, and does not block.

    Args:
        host: Name or address; empty for all of this computer's.
        port: 0 takes any that is free.
        title: Of the server, for the error.
        option: Of the command line that chooses the port.

    Raises:
        ControlError: The address cannot be had.
    """
    try:
        made = bound(host, port)
    except (OSError, UnicodeError) as error:
        raise ControlError(
            f"{title} cannot listen on {host}:{port}: {error}",
            code=ADDRESS_UNAVAILABLE,
            hint=f"Another program may be using the port. Choose a different port with {option}.",
            values={"server": title, "host": host, "port": port},
        ) from error
    made.setblocking(False)
    return made


def bound(host: str, port: int) -> socket.socket:
    """A socket that listens.

    Raises:
        OSError: The address cannot be had.
    """
    family, address = resolve(host, port)
    return socket.create_server(
        address,
        family=family,
        backlog=BACKLOG,
        dualstack_ipv6=address[0] == "::" and socket.has_dualstack_ipv6(),
    )


def is_loopback(address: str) -> bool:
    """Whether an address, without brackets or port, is one that only this computer reaches."""
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return False


def hidden_host() -> str:
    """A loopback address for a server behind a gate.

    A web page can try any port of 127.0.0.1, but not 16 million addresses with 28,000 ports each:
    the system chooses the port. Where a system has no other loopback address (macOS), this is
    127.0.0.1.
    """
    import secrets

    found = (
        f"127.{secrets.randbelow(254) + 1}.{secrets.randbelow(256)}.{secrets.randbelow(254) + 1}"
    )
    try:
        bound(found, 0).close()
    except OSError:
        return "127.0.0.1"
    return found
