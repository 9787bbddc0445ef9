"""A reader: puts what its writers send into order, and asks for what is missing."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from cartwheel.bridges.ros2.rtps import wire
from cartwheel.bridges.ros2.rtps.discovery import Address, Endpoint
from cartwheel.bridges.ros2.rtps.wire import Guid
from cartwheel.bridges.ros2.rtps.writer import Send

_WAITING = 256
"""Samples of a writer that wait for one before them."""
_WAITING_BYTES = 32 << 20
_LARGEST = 64 << 20
"""Bytes of a sample."""
_ASSEMBLED = 8
"""Samples of a writer of which parts are there."""
_PATIENCE = 3.0
"""s after which a missing sample is given up."""


@dataclass(frozen=True, slots=True)
class Taken:
    """A sample that came in."""

    payload: bytes
    inline: dict[int, bytes]
    writer: Guid
    number: int
    vendor: bytes
    keyed: bool = False


class _Assembly:
    """A sample of which fragments have come."""

    def __init__(self, size: int, fragment_size: int) -> None:
        self.data = bytearray(size)
        self.fragment_size = fragment_size
        self.missing = set(range(1, -(-size // fragment_size) + 1))

    def put(self, first: int, payload: bytes) -> bool:
        """Adds fragments; whether all are there."""
        for offset in range(0, len(payload), self.fragment_size):
            number = first + offset // self.fragment_size
            part = payload[offset : offset + self.fragment_size]
            start = (number - 1) * self.fragment_size
            part = part[: max(0, len(self.data) - start)]
            if number in self.missing:
                self.data[start : start + len(part)] = part
                self.missing.discard(number)
        return not self.missing


class WriterProxy:
    """A writer as its reader knows it."""

    def __init__(self, endpoint: Endpoint, address: Address, *, reliable: bool) -> None:
        self.guid = endpoint.guid
        self.user_data = endpoint.user_data
        self.reliable = reliable
        self.address = address
        self.next = 1
        self.waiting: dict[int, Taken | None] = {}
        """None where there is nothing to wait for."""
        self.waiting_bytes = 0
        self.waiting_since = 0.0
        self.assemblies: dict[int, _Assembly] = {}
        self.count = 0
        self.heartbeat_count = -1


class Reader:
    """One reader; on the loop's thread.

    Args:
        endpoint: Ours.
        send: Sends one datagram.
        take: Takes each sample, in the order in which its writer wrote.
    """

    def __init__(self, endpoint: Endpoint, send: Send, take: Callable[[Taken], None]) -> None:
        self.endpoint = endpoint
        self.proxies: dict[Guid, WriterProxy] = {}
        self._send = send
        self._take = take

    def match(self, endpoint: Endpoint, address: Address) -> None:
        """A writer is there."""
        known = self.proxies.get(endpoint.guid)
        if known is not None:
            known.address = address
            return
        reliable = self.endpoint.qos.reliable and endpoint.qos.reliable
        proxy = WriterProxy(endpoint, address, reliable=reliable)
        self.proxies[endpoint.guid] = proxy
        if reliable:
            # What was sent before we knew of the writer is asked for in this way.
            self._ask(proxy, ())

    def unmatch(self, guid: Guid) -> None:
        """A writer is gone."""
        self.proxies.pop(guid, None)

    def take_data(self, guid: Guid, vendor: bytes, data: wire.Data) -> None:
        """A sample, or a part of one."""
        proxy = self.proxies.get(guid)
        if proxy is None or data.number < proxy.next or data.number in proxy.waiting:
            return
        payload = data.payload
        if data.fragment:
            whole = self._assemble(proxy, data)
            if whole is None:
                return
            payload = whole
        taken = Taken(payload, data.inline, guid, data.number, vendor, data.keyed)
        if not proxy.reliable:
            proxy.next = data.number + 1
            for number in [one for one in proxy.assemblies if one < data.number]:
                del proxy.assemblies[number]
            self._take(taken)
            return
        self._wait(proxy, data.number, taken)

    def take_heartbeat(self, guid: Guid, told: wire.Heartbeat) -> None:
        """A writer says what it has."""
        proxy = self.proxies.get(guid)
        if proxy is None or not proxy.reliable:
            return
        if 0 <= proxy.heartbeat_count - told.count < 1000 or told.first < 1:
            return
        proxy.heartbeat_count = told.count
        self._skip_to(proxy, min(told.first, told.last + 1))
        end = min(told.last, proxy.next + 255)
        missing = [number for number in range(proxy.next, end + 1) if number not in proxy.waiting]
        if missing or not told.final:
            self._ask(proxy, missing)

    def take_gap(self, guid: Guid, told: wire.Gap) -> None:
        """A writer says what is nothing to wait for."""
        proxy = self.proxies.get(guid)
        if proxy is None or not proxy.reliable or told.start < 1:
            return
        if told.start <= proxy.next:
            self._skip_to(proxy, told.base)
        else:
            for number in range(told.start, min(told.base, told.start + _WAITING)):
                self._wait(proxy, number, None)
        for number in told.more:
            if number >= proxy.next:
                self._wait(proxy, number, None)

    def give_up(self, now: float) -> None:
        """Goes on without what does not come; once a second or so."""
        for proxy in self.proxies.values():
            if proxy.waiting and now - proxy.waiting_since > _PATIENCE:
                self._skip_to(proxy, min(proxy.waiting))

    def _assemble(self, proxy: WriterProxy, data: wire.Data) -> bytes | None:
        if data.size > _LARGEST or not data.size:
            return None
        assembly = proxy.assemblies.get(data.number)
        if assembly is None or len(assembly.data) != data.size:
            while len(proxy.assemblies) >= _ASSEMBLED:
                del proxy.assemblies[min(proxy.assemblies)]
            assembly = _Assembly(data.size, data.fragment_size)
            proxy.assemblies[data.number] = assembly
        if not assembly.put(data.fragment, data.payload):
            return None
        del proxy.assemblies[data.number]
        return bytes(assembly.data)

    def _wait(self, proxy: WriterProxy, number: int, taken: Taken | None) -> None:
        size = len(taken.payload) if taken else 0
        if number != proxy.next:
            full = len(proxy.waiting) >= _WAITING
            if full or proxy.waiting_bytes + size > _WAITING_BYTES:
                return
            if not proxy.waiting:
                proxy.waiting_since = time.monotonic()
                proxy.waiting[number] = taken
                proxy.waiting_bytes += size
                # The one before got lost, or was written before we knew its writer.
                self._ask(proxy, range(proxy.next, min(number, proxy.next + 255)))
                return
        proxy.waiting[number] = taken
        proxy.waiting_bytes += size
        self._deliver(proxy)

    def _skip_to(self, proxy: WriterProxy, number: int) -> None:
        if number <= proxy.next:
            return
        for passed in sorted(one for one in proxy.waiting if one < number):
            self._pass(proxy, proxy.waiting.pop(passed))
        for passed in [one for one in proxy.assemblies if one < number]:
            del proxy.assemblies[passed]
        proxy.next = number
        self._deliver(proxy)

    def _deliver(self, proxy: WriterProxy) -> None:
        while proxy.next in proxy.waiting:
            taken = proxy.waiting.pop(proxy.next)
            proxy.next += 1
            self._pass(proxy, taken)
        proxy.waiting_since = time.monotonic()

    def _pass(self, proxy: WriterProxy, taken: Taken | None) -> None:
        if taken is not None:
            proxy.waiting_bytes -= len(taken.payload)
            self._take(taken)

    def _ask(self, proxy: WriterProxy, missing: list[int] | range | tuple[()]) -> None:
        proxy.count += 1
        told = wire.acknack(
            reader=self.endpoint.guid[12:],
            writer=proxy.guid[12:],
            base=proxy.next,
            missing=missing,
            count=proxy.count,
            final=bool(missing),
        )
        head = wire.message(self.endpoint.guid[:12], told, to=proxy.guid[:12])
        self._send((head,), proxy.address)
