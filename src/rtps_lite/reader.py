"""A reader: sorts received samples, and requests missing ones."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass

from rtps_lite import wire
from rtps_lite.discovery import Address, Endpoint
from rtps_lite.outbox import Send
from rtps_lite.room import LARGEST, Room
from rtps_lite.wire import Guid

_WAITING = 256
"""Maximum number of samples per writer that wait for earlier ones; one request covers as many."""
_ASSEMBLED = 8
"""Maximum number of incomplete samples per writer."""
_SMALLEST = 512
"""Minimum size in bytes of a fragment, except for the last. It is half of the standard's minimum.
The overhead of tracking fragments thus stays smaller than the fragments."""
_REMEMBERED = 1000
"""Maximum number of lost writers whose last sample is remembered."""
_PATIENCE = 3.0
"""Timeout in s for a missing sample or fragment."""
_REPLY = 0.001
"""Minimum interval in s between responses to a writer. Additional responses are delayed."""


@dataclass(frozen=True, slots=True)
class Taken:
    """A received sample."""

    payload: bytes
    inline: dict[int, bytes]
    writer: Guid
    number: int
    vendor: bytes
    keyed: bool = False


class _Assembly:
    """A sample with missing fragments. It needs no more memory than the received fragments."""

    def __init__(self, size: int, fragment_size: int, now: float) -> None:
        self.size = size
        self.fragment_size = fragment_size
        self.count = -(-size // fragment_size)
        self.parts: dict[int, bytes] = {}
        self.held = 0
        self.touched = now

    def split(self, first: int, payload: bytes) -> dict[int, bytes]:
        """New fragments in a datagram; empty if one has the wrong length."""
        found = {}
        step = self.fragment_size
        for offset in range(0, len(payload), step):
            number = first + offset // step
            part = payload[offset : offset + step]
            wanted = step if number < self.count else self.size - (self.count - 1) * step
            if number == self.count:
                # Padding may follow the data.
                part = part[:wanted]
            if number > self.count or len(part) != wanted:
                return {}
            if number not in self.parts:
                found[number] = part
        return found

    def whole(self) -> bytes | None:
        """The sample, once it is complete."""
        if len(self.parts) < self.count:
            return None
        return b"".join(self.parts[number] for number in range(1, self.count + 1))


class WriterProxy:
    """A matched writer."""

    def __init__(self, endpoint: Endpoint, address: Address, *, reliable: bool) -> None:
        self.guid = endpoint.guid
        self.user_data = endpoint.user_data
        self.reliable = reliable
        self.address = address
        self.next = 1
        self.waiting: dict[int, Taken | None] = {}
        """Samples by number. None means that the sample will not arrive."""
        self.waiting_since = 0.0
        self.assemblies: dict[int, _Assembly] = {}
        self.count = 0
        self.heartbeat_count = -1
        self.last = 0
        """Number of the last sample that the writer has announced."""
        self.asked_at = 0.0
        self.must_ask = False
        """Whether a delayed response is due."""


class Reader:
    """A reader. Used on the loop's thread.

    Args:
        endpoint: Discovery data of the reader.
        send: Sends a datagram.
        take: Called with each sample, in the order of writing.
        room: Memory budget for incomplete samples. None creates one for this reader.
        again: Whether a writer that was lost and is discovered again delivers its samples again.
            Otherwise each sample is delivered once, so that no request is executed twice.
    """

    def __init__(
        self,
        endpoint: Endpoint,
        send: Send,
        take: Callable[[Taken], None],
        *,
        room: Room | None = None,
        again: bool = False,
    ) -> None:
        self.endpoint = endpoint
        self._again = again
        self._lost: OrderedDict[Guid, int] = OrderedDict()
        """The next sample of each writer that was lost."""
        self._room = room or Room()
        self.proxies: dict[Guid, WriterProxy] = {}
        self._send = send
        self._take = take

    def match(self, endpoint: Endpoint, address: Address) -> None:
        """Adds a writer, or updates its address."""
        known = self.proxies.get(endpoint.guid)
        if known is not None:
            known.address = address
            return
        reliable = self.endpoint.qos.reliable and endpoint.qos.reliable
        proxy = WriterProxy(endpoint, address, reliable=reliable)
        proxy.next = self._lost.pop(endpoint.guid, proxy.next)
        self.proxies[endpoint.guid] = proxy
        if reliable:
            # This requests the samples that were sent before the writer was discovered.
            self._ask(proxy, ())

    def unmatch(self, guid: Guid) -> None:
        """Removes a writer."""
        proxy = self.proxies.pop(guid, None)
        if proxy is None:
            return
        if not self._again:
            self._lost[guid] = proxy.next
            if len(self._lost) > _REMEMBERED:
                self._lost.popitem(last=False)
        for number in list(proxy.assemblies):
            self._drop(proxy, number)
        for taken in proxy.waiting.values():
            if taken is not None:
                self._room.free(guid[:12], len(taken.payload))

    def take_data(self, guid: Guid, vendor: bytes, data: wire.Data) -> None:
        """Handles a sample or fragment."""
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
                self._drop(proxy, number)
            self._take(taken)
            return
        self._wait(proxy, data.number, taken)

    def take_heartbeat(self, guid: Guid, heartbeat: wire.Heartbeat) -> None:
        """Handles a writer's announcement of its samples."""
        proxy = self.proxies.get(guid)
        if proxy is None or not proxy.reliable:
            return
        if 0 <= proxy.heartbeat_count - heartbeat.count < 1000 or heartbeat.first < 1:
            return
        proxy.heartbeat_count = heartbeat.count
        self._skip_to(proxy, min(heartbeat.first, heartbeat.last + 1))
        proxy.last = heartbeat.last
        end = min(heartbeat.last, proxy.next + 255)
        missing = any(number not in proxy.waiting for number in range(proxy.next, end + 1))
        if not missing and heartbeat.final:
            return
        now = time.monotonic()
        if now - proxy.asked_at < _REPLY:
            proxy.must_ask = True
            return
        self._ask_up_to(proxy, end)

    def take_gap(self, guid: Guid, gap: wire.Gap) -> None:
        """Handles a writer's list of samples that will not arrive."""
        proxy = self.proxies.get(guid)
        if proxy is None or not proxy.reliable or gap.start < 1:
            return
        if gap.start <= proxy.next:
            self._skip_to(proxy, gap.base)
        else:
            for number in range(gap.start, min(gap.base, gap.start + _WAITING)):
                self._wait(proxy, number, None)
        for number in gap.more:
            if number >= proxy.next:
                self._wait(proxy, number, None)

    def remind(self) -> None:
        """Sends delayed responses. Call it several times per s."""
        for proxy in self.proxies.values():
            if proxy.must_ask:
                self._ask_up_to(proxy, min(proxy.last, proxy.next + 255))

    def _ask_up_to(self, proxy: WriterProxy, end: int) -> None:
        missing = range(proxy.next, end + 1)
        self._ask(proxy, [number for number in missing if number not in proxy.waiting])

    def give_up(self, now: float) -> None:
        """Skips samples after a timeout. Call it about once per s."""
        for proxy in self.proxies.values():
            for number, assembly in list(proxy.assemblies.items()):
                if now - assembly.touched > _PATIENCE:
                    self._drop(proxy, number)
            if proxy.waiting and now - proxy.waiting_since > _PATIENCE:
                self._skip_to(proxy, min(proxy.waiting))

    def _assemble(self, proxy: WriterProxy, data: wire.Data) -> bytes | None:
        small = data.fragment_size < min(_SMALLEST, data.size)
        if not 0 < data.size <= LARGEST or small:
            return None
        now = time.monotonic()
        assembly = proxy.assemblies.get(data.number)
        if assembly is None:
            if len(proxy.assemblies) >= _ASSEMBLED and not self._make_room(proxy, data.number):
                return None
            assembly = _Assembly(data.size, data.fragment_size, now)
            proxy.assemblies[data.number] = assembly
        elif (assembly.size, assembly.fragment_size) != (data.size, data.fragment_size):
            return None
        found = assembly.split(data.fragment, data.payload)
        size = sum(map(len, found.values()))
        if not found or not self._room.take(proxy.guid[:12], size):
            return None
        assembly.parts |= found
        assembly.held += size
        assembly.touched = now
        whole = assembly.whole()
        if whole is not None:
            self._drop(proxy, data.number)
        return whole

    def _make_room(self, proxy: WriterProxy, number: int) -> bool:
        """Drops an incomplete sample: the newest of a reliable writer, otherwise the oldest."""
        worst = max(proxy.assemblies) if proxy.reliable else min(proxy.assemblies)
        if proxy.reliable and number > worst:
            return False
        self._drop(proxy, worst)
        return True

    def _drop(self, proxy: WriterProxy, number: int) -> None:
        """Drops an incomplete sample."""
        self._room.free(proxy.guid[:12], proxy.assemblies.pop(number).held)

    def _wait(self, proxy: WriterProxy, number: int, taken: Taken | None) -> None:
        if number == proxy.next:
            proxy.next += 1
            if taken is not None:
                self._take(taken)
            self._deliver(proxy)
            return
        if number in proxy.waiting or len(proxy.waiting) >= _WAITING:
            return
        if taken is not None and not self._room.take(proxy.guid[:12], len(taken.payload)):
            return
        first = not proxy.waiting
        proxy.waiting[number] = taken
        if first:
            proxy.waiting_since = time.monotonic()
            # The previous sample was lost, or was written before the writer was discovered.
            self._ask(proxy, range(proxy.next, min(number, proxy.next + 255)))

    def _skip_to(self, proxy: WriterProxy, number: int) -> None:
        if number <= proxy.next:
            return
        for passed in sorted(one for one in proxy.waiting if one < number):
            self._pass(proxy, proxy.waiting.pop(passed))
        for passed in [one for one in proxy.assemblies if one < number]:
            self._drop(proxy, passed)
        proxy.next = number
        self._deliver(proxy)

    def _deliver(self, proxy: WriterProxy) -> None:
        while proxy.next in proxy.waiting:
            taken = proxy.waiting.pop(proxy.next)
            proxy.next += 1
            self._pass(proxy, taken)
        proxy.waiting_since = time.monotonic()

    def _pass(self, proxy: WriterProxy, taken: Taken | None) -> None:
        """Delivers a sample that has waited."""
        if taken is not None:
            self._room.free(proxy.guid[:12], len(taken.payload))
            self._take(taken)

    def _ask(self, proxy: WriterProxy, missing: list[int] | range | tuple[()]) -> None:
        proxy.count += 1
        proxy.must_ask = False
        proxy.asked_at = time.monotonic()
        acknack = wire.acknack(
            reader=self.endpoint.guid[12:],
            writer=proxy.guid[12:],
            base=proxy.next,
            missing=missing,
            count=proxy.count,
            final=bool(missing),
        )
        head = wire.message(self.endpoint.guid[:12], acknack, to=proxy.guid[:12])
        self._send((head,), proxy.address)
