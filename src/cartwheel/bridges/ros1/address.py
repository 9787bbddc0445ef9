"""Address of the master, and the address under which other nodes reach this node."""

from __future__ import annotations

import contextlib
import os
import socket
from collections.abc import Mapping
from urllib.parse import urlsplit

from cartwheel.codes.wires import ROS_URI_INVALID
from cartwheel.errors import CartwheelError

MASTER_URI = "http://localhost:11311"
"""Default of ``ROS_MASTER_URI``."""
_LOOPBACK = ("localhost", "::1")


def master_uri(special: Mapping[str, str]) -> str:
    """URI of the master, from ``__master:=`` or the environment.

    Raises:
        CartwheelError: The URI is invalid.
    """
    uri = special.get("__master") or os.environ.get("ROS_MASTER_URI") or MASTER_URI
    host_and_port(uri)
    return uri


def host_and_port(uri: str) -> tuple[str, int]:
    """Host and port of ``http://host:port/``.

    Raises:
        CartwheelError: The URI does not have this form.
    """
    try:
        parts = urlsplit(uri)
        if parts.scheme in ("http", "rosrpc") and parts.hostname and parts.port:
            return parts.hostname, parts.port
    except ValueError:
        pass
    raise CartwheelError(
        f'"{uri}" is not a valid address of a ROS master or node',
        code=ROS_URI_INVALID,
        hint=f"Addresses have the form {MASTER_URI}.",
        values={"uri": uri},
    )


def own_host(special: Mapping[str, str], master: str) -> str:
    """Host name or address in the node's URIs.

    The order is the same as in rospy: ``__hostname``, ``__ip``, ``ROS_HOSTNAME``, ``ROS_IP``,
    then the name of this computer if it can be resolved.
    """
    given = (
        special.get("__hostname")
        or special.get("__ip")
        or os.environ.get("ROS_HOSTNAME")
        or os.environ.get("ROS_IP")
    )
    if given:
        return given
    name = socket.gethostname()
    if name and not is_loopback(name):
        with contextlib.suppress(OSError):
            socket.gethostbyname(name)
            return name
    return _address_towards(*host_and_port(master))


def bind_address(host: str) -> str:
    """Address to listen on: loopback only, if the node's own host is loopback."""
    return "127.0.0.1" if is_loopback(host) else ""


def is_loopback(host: str) -> bool:
    """Whether a host name refers to the local computer on any computer."""
    return host in _LOOPBACK or host.startswith("127.")


def is_local(host: str) -> bool:
    """Whether a host name or address is one of this computer."""
    if is_loopback(host) or host == socket.gethostname():
        return True
    try:
        address = socket.gethostbyname(host)
    except OSError:
        return False
    if is_loopback(address):
        return True
    # Only addresses of this computer can be bound.
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind((address, 0))
        except OSError:
            return False
    return True


def _address_towards(host: str, port: int) -> str:
    """Own address on the route to a host. Sends nothing."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect((host, port))
        except OSError:
            return "127.0.0.1"
        return str(probe.getsockname()[0])
