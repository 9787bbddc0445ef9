"""Sockets, ports and discovery range."""

from __future__ import annotations

import contextlib
import fcntl
import socket
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from rtps_lite.discovery import Address
from rtps_lite.interface import DomainFullError, UnknownHostError

GROUP = "239.255.0.1"
LOOPBACK = "127.0.0.1"
_BASE, _PER_DOMAIN, _PER_PARTICIPANT, _UNICAST = 7400, 250, 2, 10
LAST_DOMAIN = 232
PARTICIPANTS = 120
"""Maximum number of participants per computer, because there is one port for each."""
_PEERS = 32
"""Number of participants per computer that are searched individually."""
_BUFFER = 8 << 20
_SIOCGIFADDR = 0x8915

Range = Literal["OFF", "LOCALHOST", "SUBNET"]


@dataclass(frozen=True, kw_only=True, slots=True)
class Reach:
    """Discovery range."""

    range: Range = "LOCALHOST"
    peers: tuple[str, ...] = ()
    """Hosts to which announcements are sent individually."""


def own_addresses() -> dict[str, str]:
    """IPv4 addresses of this computer, by interface name."""
    found: dict[str, str] = {}
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        for _, name in socket.if_nameindex():
            request = struct.pack("256s", name.encode()[:15])
            # An interface without an address.
            with contextlib.suppress(OSError):
                answer = fcntl.ioctl(probe.fileno(), _SIOCGIFADDR, request)
                found[name] = socket.inet_ntoa(answer[20:24])
    return found


class Network:
    """Sockets of a participant.

    Args:
        domain: DDS domain, 0 to 232.
        reach: Discovery range.

    Raises:
        DomainFullError: No port is free.
        UnknownHostError: A peer cannot be resolved.
    """

    def __init__(self, domain: int, reach: Reach) -> None:
        self.reach = reach
        base = _BASE + _PER_DOMAIN * domain
        self._own = {LOOPBACK, *own_addresses().values()}
        peers = self._resolved(reach.peers)
        self._heard = frozenset() if reach.range == "OFF" else frozenset((*self._own, *peers))
        outer = tuple(sorted(address for address in self._own if not address.startswith("127.")))
        local = reach.range != "SUBNET" and not reach.peers
        self.unicast, port = self._open(base, LOOPBACK if local else "")
        self.locators: tuple[Address, ...] = tuple(
            (host, port) for host in ((LOOPBACK,) if local or not outer else outer)
        )
        """Addresses under which other participants reach this one."""
        self.multicast: socket.socket | None = None
        self.announce: list[Address] = []
        """Addresses that receive announcements in addition to the multicast group."""
        self._casters: list[socket.socket] = []
        self._group = (GROUP, base)
        if reach.range == "OFF":
            return
        self.announce = [
            (host, base + _UNICAST + _PER_PARTICIPANT * number)
            for host in (LOOPBACK, *peers)
            for number in range(_PEERS)
        ]
        with contextlib.suppress(OSError):
            self.multicast = self._join(base)
        for address in sorted(self._own) if reach.range == "SUBNET" else [LOOPBACK]:
            # An interface without multicast. Participants behind it must search for this one.
            with contextlib.suppress(OSError):
                self._casters.append(self._caster(address))

    def hears(self, host: str) -> bool:
        """Whether datagrams from a host are accepted."""
        return self.reach.range == "SUBNET" or host in self._heard

    def nearest(self, addresses: Sequence[Address], host: str) -> Address:
        """The participant's address that matches the source of its datagrams.

        No other address is used, so that a fake participant cannot redirect traffic to a victim.

        Args:
            addresses: The addresses in the participant's announcement.
            host: IPv4 address of the source.
        """
        for address in addresses:
            if address[0] == host:
                return address
        if self.is_own(host):
            for address in addresses:
                if self.is_own(address[0]):
                    return address
        return host, addresses[0][1]

    def is_own(self, host: str) -> bool:
        """Whether an address belongs to this computer."""
        return host in self._own

    def cast(self, data: bytes) -> None:
        """Sends to all participants in the discovery range."""
        for caster in self._casters:
            with contextlib.suppress(OSError):
                caster.sendto(data, self._group)
        for address in self.announce:
            with contextlib.suppress(OSError):
                self.unicast.sendto(data, address)

    def close(self) -> None:
        """Closes all sockets."""
        for sock in (self.unicast, self.multicast, *self._casters):
            if sock is not None:
                sock.close()

    def _open(self, base: int, host: str) -> tuple[socket.socket, int]:
        sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        sock.setblocking(False)
        for option in (socket.SO_RCVBUF, socket.SO_SNDBUF):
            sock.setsockopt(socket.SOL_SOCKET, option, _BUFFER)
        for number in range(PARTICIPANTS):
            port = base + _UNICAST + _PER_PARTICIPANT * number
            try:
                sock.bind((host, port))
            except OSError:
                continue
            return sock, port
        sock.close()
        raise DomainFullError

    def _join(self, port: int) -> socket.socket:
        sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        sock.setblocking(False)
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        sock.bind((GROUP, port))
        # All interfaces, because programs on this computer may announce themselves on any.
        for address in self._own:
            with contextlib.suppress(OSError):
                sock.setsockopt(
                    socket.IPPROTO_IP,
                    socket.IP_ADD_MEMBERSHIP,
                    socket.inet_aton(GROUP) + socket.inet_aton(address),
                )
        return sock

    @staticmethod
    def _caster(address: str) -> socket.socket:
        sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        sock.setblocking(False)
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(address))
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 1)
        return sock

    @staticmethod
    def _resolved(peers: tuple[str, ...]) -> list[str]:
        found = []
        for peer in peers:
            try:
                found.append(socket.gethostbyname(peer))
            except OSError:
                raise UnknownHostError(peer) from None
        return found
