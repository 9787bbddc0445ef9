"""Sockets, ports and discovery range."""

from __future__ import annotations

import contextlib
import fcntl
import os
import socket
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from cartwheel.bridges.ros2.rtps.discovery import Address
from cartwheel.codes.wires import DOMAIN_FULL, ROS_VARIABLE_INVALID
from cartwheel.errors import CartwheelError

GROUP = "239.255.0.1"
LOOPBACK = "127.0.0.1"
_BASE, _PER_DOMAIN, _PER_PARTICIPANT, _UNICAST = 7400, 250, 2, 10
_LAST_DOMAIN = 232
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

    @classmethod
    def of(cls, environment: Mapping[str, str] = os.environ) -> Reach:
        """Range from ROS environment variables. The default is this computer only.

        Source: REP 2017's ``ROS_AUTOMATIC_DISCOVERY_RANGE`` and ``ROS_STATIC_PEERS``, and the
        older ``ROS_LOCALHOST_ONLY``.

        Raises:
            CartwheelError: A variable has an invalid value.
        """
        peers = tuple(
            peer.strip()
            for peer in environment.get("ROS_STATIC_PEERS", "").split(";")
            if peer.strip()
        )
        only = environment.get("ROS_LOCALHOST_ONLY", "").strip()
        given = environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper()
        if only not in ("", "0", "1"):
            raise CartwheelError(
                f'ROS_LOCALHOST_ONLY has the invalid value "{only}"',
                code=ROS_VARIABLE_INVALID,
                hint="Set it to 0 or 1.",
                values={"variable": "ROS_LOCALHOST_ONLY", "value": only},
            )
        if only == "1":
            return cls(range="LOCALHOST")
        if not given:
            return cls(range="SUBNET" if only == "0" else "LOCALHOST", peers=peers)
        if given == "OFF":
            return cls(range="OFF")
        if given == "LOCALHOST":
            return cls(range="LOCALHOST", peers=peers)
        if given in ("SUBNET", "SYSTEM_DEFAULT"):
            return cls(range="SUBNET", peers=peers)
        raise CartwheelError(
            f'ROS_AUTOMATIC_DISCOVERY_RANGE has the invalid value "{given}"',
            code=ROS_VARIABLE_INVALID,
            hint="Set it to OFF, LOCALHOST, SUBNET or SYSTEM_DEFAULT.",
            values={"variable": "ROS_AUTOMATIC_DISCOVERY_RANGE", "value": given},
        )


def domain_id(environment: Mapping[str, str] = os.environ) -> int:
    """``ROS_DOMAIN_ID``; 0 if unset.

    Raises:
        CartwheelError: The domain is invalid.
    """
    given = environment.get("ROS_DOMAIN_ID", "").strip() or "0"
    if not given.isdecimal() or int(given) > _LAST_DOMAIN:
        raise CartwheelError(
            f'ROS_DOMAIN_ID has the invalid value "{given}"',
            code=ROS_VARIABLE_INVALID,
            hint=f"Set it to a number from 0 to {_LAST_DOMAIN}.",
            values={"variable": "ROS_DOMAIN_ID", "value": given},
        )
    return int(given)


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
        domain: See `domain_id`.
        reach: Discovery range.

    Raises:
        CartwheelError: No port is free.
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
        raise CartwheelError(
            "all ports for participants in this ROS domain are in use",
            code=DOMAIN_FULL,
            hint="Set ROS_DOMAIN_ID to a different domain.",
        )

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
                raise CartwheelError(
                    f'ROS_STATIC_PEERS contains the unknown host "{peer}"',
                    code=ROS_VARIABLE_INVALID,
                    values={"variable": "ROS_STATIC_PEERS", "value": peer},
                ) from None
        return found
