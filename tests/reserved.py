"""Numbers that no other test of this machine uses at the same time: ports and DDS domains.

A port that was free a moment ago may be anybody's by the time a program listens on it. So each
number is reserved by a name among abstract Unix sockets, which the system frees as soon as this
process has ended, and ports lie below those that the system gives to connections.
"""

from __future__ import annotations

import random
import socket

_held: list[socket.socket] = []
_FIRST_PORT, _LAST_PORT = 15000, 32000
_FIRST_DOMAIN, _DOMAINS_AT_ONCE, _BLOCKS = 20, 7, 11
"""Ports of DDS domains above 101 lie among those that the system gives to connections."""


def _reserve(name: str) -> bool:
    mark = socket.socket(socket.AF_UNIX)
    try:
        mark.bind(f"\0cartwheel-tests-{name}")
    except OSError:
        mark.close()
        return False
    _held.append(mark)
    return True


def free_port() -> int:
    """A port on which nobody listens, and which no other test is given while this process lives."""
    while True:
        port = random.randint(_FIRST_PORT, _LAST_PORT)
        with socket.socket() as probe:
            try:
                probe.bind(("", port))
            except OSError:
                continue
        if _reserve(f"port-{port}"):
            return port


def dds_domains() -> int:
    """The first of seven DDS domains in a row that no other test process uses."""
    for block in range(_BLOCKS):
        if _reserve(f"domains-{block}"):
            return _FIRST_DOMAIN + _DOMAINS_AT_ONCE * block
    raise RuntimeError(f"{_BLOCKS} test processes use all DDS domains already")
