"""Listening sockets, and addresses that cannot be guessed."""

from __future__ import annotations

import ipaddress
import socket

from cartwheel.codes.wires import ADDRESS_UNAVAILABLE
from cartwheel.errors import ControlError
from cartwheel.options import Option

BACKLOG = 128
"""Maximum number of connections that wait to be accepted."""


def resolve(host: str, port: int) -> tuple[socket.AddressFamily, tuple[str, int]]:
    """Address of a host name. IPv4 takes precedence, because ``localhost`` has both.

    Args:
        host: Name or address; empty for all addresses of this computer.
        port: 0 to 65535.

    Raises:
        OSError: The name is unknown, or the port is out of range.
    """
    if not 0 <= port <= 65535:
        raise OSError(f"port {port} is not between 0 and 65535")
    name = host or "0.0.0.0"  # noqa: S104 - the user chose this address
    found = socket.getaddrinfo(
        # As bytes: for a str, Python loads its IDNA tables, which takes several ms.
        name.encode() if name.isascii() else name,
        port,
        type=socket.SOCK_STREAM,
        flags=socket.AI_PASSIVE,
    )
    family, _, _, _, address = min(found, key=lambda each: each[0] != socket.AF_INET)
    return family, (str(address[0]), port)


def listen(host: str, port: int, *, title: str, option: Option) -> socket.socket:
    """Creates a non-blocking listening socket.

    Args:
        host: Name or address; empty for all addresses of this computer.
        port: 0 chooses a free port.
        title: Name of the server, for errors.
        option: Option that sets the port, for errors.

    Raises:
        ControlError: The address is not available.
    """
    try:
        made = bound(host, port)
    except (OSError, UnicodeError) as error:
        raise ControlError(
            f"{title} cannot listen on {host}:{port}: {error}",
            code=ADDRESS_UNAVAILABLE,
            hint="Another program may be using the port. Choose a different port: "
            f"{option.given(port + 1 if port < 65535 else 0)}",
            values={"server": title, "host": host, "port": port},
        ) from error
    made.setblocking(False)
    return made


def bound(host: str, port: int) -> socket.socket:
    """Creates a listening socket.

    Raises:
        OSError: The address is not available.
    """
    family, address = resolve(host, port)
    return socket.create_server(
        address,
        family=family,
        backlog=BACKLOG,
        dualstack_ipv6=address[0] == "::" and socket.has_dualstack_ipv6(),
    )


def is_loopback(address: str) -> bool:
    """Whether an address without brackets or port is reachable only from this computer."""
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return False


def hidden_host() -> str:
    """A loopback address for a server behind a gate.

    A web page can try all ports of 127.0.0.1, but not 16 million addresses with 28,000 ports
    each. The system chooses the port. On systems with a single loopback address (macOS), this is
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
