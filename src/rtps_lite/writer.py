"""A writer: sends samples to its readers, and repeats those that a reader reports as missing."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence

from rtps_lite import wire
from rtps_lite.discovery import Address, Endpoint
from rtps_lite.history import History, Sample
from rtps_lite.outbox import Outbox, Parts, Send
from rtps_lite.wire import UNKNOWN, Guid, Prefix

_FIRST_AGAIN, _LAST_AGAIN = 0.05, 2.0
"""Initial and maximum interval in s between reminders to a reader that does not respond."""
_SILENCE = 3.0
"""Time in s without a response after which a reader counts as unresponsive."""
_REPLY = 0.001
"""Minimum interval in s between responses to a reader, which limits the traffic it can cause."""
_SOON = 0.05
"""Delay in s of a reminder in place of a suppressed response."""


class ReaderProxy:
    """A matched reader."""

    def __init__(self, endpoint: Endpoint, address: Address, *, start: int) -> None:
        self.guid = endpoint.guid
        self.user_data = endpoint.user_data
        self.reliable = endpoint.qos.reliable
        self.address = address
        self.start = start
        """Number of the first sample that the reader receives."""
        self.acked = start - 1
        self.patience = _FIRST_AGAIN
        self.remind_at = 0.0
        self.asked_at = 0.0
        """Time of the first reminder since the last response."""
        self.greeted = True
        """Whether it received the earlier samples, which requires a first response."""
        self.replied_at = 0.0
        self.wanted: dict[int, set[int] | None] = {}
        """Requested samples or fragments to repeat; at most the kept samples."""
        self.gone = 0
        """Number of the last sample that the reader is known to have missed."""
        self.last_count = -1


class Writer:
    """A writer. Used on the loop's thread.

    A reliable writer keeps as many samples as its depth, regardless of who has received them. It
    never waits for readers, so slower readers miss samples.

    Args:
        endpoint: Discovery data of the writer.
        send: See `Send`.
        outbox: Sends samples that need several datagrams. None sends them at once.
        clock: Returns the timestamp of a sample in ns since 1970.
    """

    def __init__(
        self,
        endpoint: Endpoint,
        send: Send,
        *,
        outbox: Outbox | None = None,
        clock: Callable[[], int] = time.time_ns,
    ) -> None:
        self.endpoint = endpoint
        self.proxies: dict[Guid, ReaderProxy] = {}
        self.dropped = 0
        """Samples that readers missed, for one of three reasons: they were requested too late,
        they were discarded while a reader did not respond, or the system refused to send them and
        the reader is not reliable."""
        self.on_readers: Callable[[], None] = lambda: None
        """Called when the first reader appears, and when the last one disappears."""
        self.on_drop: Callable[[], None] = lambda: None
        """Called when a reader has requested a sample that is no longer kept."""
        self.on_refusal: Callable[[], None] = lambda: None
        """Called when the system refused to send a sample that is not repeated."""
        self.on_silence: Callable[[], None] = lambda: None
        """Called when samples were discarded that an unresponsive reader has not received."""
        self._prefix, self._entity = endpoint.guid[:12], endpoint.guid[12:]
        self._send = send
        self._outbox = outbox or Outbox(send)
        self._clock = clock
        self._last = 0
        self._history = History(endpoint.qos)
        self._count = 0

    # -- readers

    def match(self, endpoint: Endpoint, address: Address, *, proved: bool = True) -> None:
        """Adds a reader, or updates its address.

        Args:
            endpoint: Discovery data of the reader.
            address: Address of the reader.
            proved: Whether its participant has ever responded. Before that, it receives no
                samples.
        """
        known = self.proxies.get(endpoint.guid)
        if known is not None:
            known.address = address
            return
        qos = self.endpoint.qos
        self._history.expire(self._clock())
        history = qos.transient_local and endpoint.qos.transient_local
        first = self._history.first(self._last + 1)
        proxy = ReaderProxy(endpoint, address, start=first if history else self._last + 1)
        if not qos.reliable:
            proxy.reliable = False
        self.proxies[endpoint.guid] = proxy
        proxy.greeted = proved or not history
        if history and proved:
            self._greet(proxy)
        if proxy.reliable:
            self._heartbeat(proxy, final=False)
            # The reader may not have discovered this writer yet.
            proxy.remind_at = time.monotonic() + proxy.patience
        if len(self.proxies) == 1:
            self.on_readers()

    def unmatch(self, guid: Guid) -> None:
        """Removes a reader."""
        gone = self.proxies.pop(guid, None)
        if gone is None:
            return
        gone.wanted.clear()
        if not self.proxies:
            self.on_readers()
            if not self.endpoint.qos.transient_local:
                self._history.clear()

    # -- samples

    def write(
        self,
        payload: bytes,
        *,
        inline: bytes = b"",
        to: Prefix | None = None,
        keyed: bool = False,
    ) -> None:
        """Sends a sample.

        Args:
            payload: CDR with encapsulation.
            inline: Parameters in front of the payload.
            to: The only receiving participant; None for all.
            keyed: Whether the payload is a key.
        """
        payload += b"\0" * (-len(payload) % 4)
        now = self._clock()
        stamp = wire.timestamp(now // 10**9, (now % 10**9 << 32) // 10**9)
        self._last += 1
        sample = Sample(self._last, payload, inline, to, stamp, now, keyed)
        qos = self.endpoint.qos
        if qos.reliable and (self.proxies or qos.transient_local):
            self._history.add(sample)
        reached: set[Prefix] = set()
        for proxy in self.proxies.values():
            prefix = proxy.guid[:12]
            if to is not None and prefix != to:
                self._pass_over(proxy, self._last)
            elif prefix not in reached and proxy.greeted:
                # One datagram is enough for all readers of a participant.
                reached.add(prefix)
                self._send_sample(sample, proxy, UNKNOWN)
            if proxy.reliable and not proxy.remind_at:
                proxy.remind_at = time.monotonic() + proxy.patience

    def remind(self, now: float) -> None:
        """Announces the kept samples to readers that lack some. Call it several times per s."""
        for proxy in self.proxies.values():
            if proxy.reliable and proxy.remind_at and now >= proxy.remind_at:
                if proxy.acked >= self._last:
                    proxy.remind_at = 0.0
                    continue
                if self._outbox.is_sending(self, proxy.address) or proxy.wanted:
                    # The reader would request samples that are already being sent.
                    proxy.remind_at = now + proxy.patience
                    continue
                proxy.asked_at = proxy.asked_at or now
                if now - proxy.asked_at > _SILENCE:
                    self._count_gone(proxy)
                proxy.patience = min(2 * proxy.patience, _LAST_AGAIN)
                proxy.remind_at = now + proxy.patience
                self._heartbeat(proxy, final=False)

    def take_acknack(self, guid: Guid, acknack: wire.Acknack) -> None:
        """Handles a reader's report of received and missing samples."""
        proxy = self.proxies.get(guid)
        if proxy is None or not proxy.reliable:
            return
        if 0 <= proxy.last_count - acknack.count < 1000:
            return
        if proxy.asked_at and time.monotonic() - proxy.asked_at > _SILENCE:
            self._count_gone(proxy)
        proxy.asked_at = 0.0
        proxy.last_count = acknack.count
        proxy.patience = _FIRST_AGAIN
        proxy.acked = max(proxy.acked, min(acknack.base - 1, self._last))
        if proxy.acked < self._last:
            proxy.remind_at = time.monotonic() + proxy.patience
        if not proxy.greeted:
            # The participant is real, because only it knows what to respond to.
            proxy.greeted = True
            self._greet(proxy)
            if not acknack.final:
                self._reply(proxy, ())
            return
        lost: list[int] = []
        gone = self.dropped
        for number in acknack.missing:
            if number > self._last:
                break
            sample = self._history.get(number)
            ours = sample is not None and sample.to in (None, guid[:12])
            if sample is not None and ours and number >= proxy.start:
                proxy.wanted[number] = None
            else:
                lost.append(number)
                if number >= proxy.start and number > proxy.gone and sample is None:
                    # Count the sample once, even if it is requested again.
                    proxy.gone = number
                    self.dropped += 1
        if self.dropped > gone:
            self.on_drop()
        self._send_again(proxy)
        if acknack.missing or not acknack.final:
            self._reply(proxy, lost)

    def take_nack_frag(self, guid: Guid, nack: wire.NackFrag) -> None:
        """Handles a reader's report of missing fragments."""
        proxy = self.proxies.get(guid)
        sample = self._history.get(nack.number)
        if proxy is None or sample is None or not proxy.reliable or not proxy.greeted:
            return
        if sample.to not in (None, guid[:12]) or nack.number < proxy.start:
            return
        wanted = {number for number in nack.missing if 1 <= number <= sample.fragments}
        known = proxy.wanted.setdefault(nack.number, set()) if wanted else None
        if known is not None:
            known |= wanted
            self._send_again(proxy)

    def _greet(self, proxy: ReaderProxy) -> None:
        """Sends the kept samples to a new reader."""
        for sample in self._history:
            if sample.number > proxy.acked and sample.number >= proxy.start:
                self._send_sample(sample, proxy, proxy.guid[12:])
        proxy.remind_at = time.monotonic() + proxy.patience

    def _send_again(self, proxy: ReaderProxy) -> None:
        if proxy.wanted:
            self._outbox.put_again(proxy, self._pieces_again(proxy), proxy.address)

    def _pieces_again(self, proxy: ReaderProxy) -> Iterator[Parts]:
        """Requested samples and fragments, until none are left."""
        while proxy.wanted:
            number = next(iter(proxy.wanted))
            fragments = proxy.wanted.pop(number)
            # It may have been discarded since.
            sample = self._history.get(number)
            if sample is not None:
                to, reader = proxy.guid[:12], proxy.guid[12:]
                yield from sample.datagrams(self.endpoint.guid, to, reader, fragments)

    def _reply(self, proxy: ReaderProxy, lost: Sequence[int]) -> None:
        """Announces the kept samples, and those that are no longer kept."""
        now = time.monotonic()
        if now - proxy.replied_at < _REPLY:
            proxy.remind_at = min(proxy.remind_at or math.inf, now + _SOON)
            return
        proxy.replied_at = now
        gaps = [wire.gap(reader=proxy.guid[12:], writer=self._entity, numbers=lost)] if lost else []
        self._post(proxy, *gaps, self._heartbeat_of(proxy, final=True))

    def _count_gone(self, proxy: ReaderProxy) -> None:
        """Counts discarded samples that an unresponsive reader has not received."""
        gone = self._history.first(self._last + 1) - 1
        before = max(proxy.gone, proxy.acked)
        if gone > before:
            proxy.gone = gone
            self.dropped += gone - before
            self.on_silence()

    def _count_refused(self, prefix: Prefix) -> None:
        """Counts a sample that was refused for a participant's readers that are not reliable."""
        lost = sum(
            not proxy.reliable for guid, proxy in self.proxies.items() if guid[:12] == prefix
        )
        if lost:
            self.dropped += lost
            self.on_refusal()

    # -- datagrams

    def _post(self, proxy: ReaderProxy, *submessages: bytes) -> None:
        head = wire.message(self._prefix, *submessages, to=proxy.guid[:12])
        self._send((head,), proxy.address)

    def _pass_over(self, proxy: ReaderProxy, number: int) -> None:
        if proxy.reliable:
            self._post(
                proxy, wire.gap(reader=proxy.guid[12:], writer=self._entity, numbers=[number])
            )

    def _heartbeat(self, proxy: ReaderProxy, *, final: bool) -> None:
        self._post(proxy, self._heartbeat_of(proxy, final=final))

    def _heartbeat_of(self, proxy: ReaderProxy, *, final: bool) -> bytes:
        self._count += 1
        first = max(self._history.first(self._last + 1), proxy.start)
        return wire.heartbeat(
            reader=proxy.guid[12:],
            writer=self._entity,
            first=first,
            last=self._last,
            count=self._count,
            final=final,
        )

    def _send_sample(self, sample: Sample, proxy: ReaderProxy, reader: bytes) -> None:
        prefix, address = proxy.guid[:12], proxy.address
        datagrams = sample.datagrams(self.endpoint.guid, prefix, reader)
        size = len(sample.payload)

        def lost() -> None:
            self._count_refused(prefix)

        if size > wire.LARGEST or self._outbox.is_sending(self, address):
            depth = self.endpoint.qos.depth
            self._outbox.put(self, datagrams, size, address, lost=lost, most=depth)
        else:
            self._outbox.put_between(next(datagrams), address, lost)
