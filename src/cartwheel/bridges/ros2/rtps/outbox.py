"""What is sent in several datagrams, some at a time: a receiver needs moments to take them."""

from __future__ import annotations

import itertools
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from cartwheel.bridges.ros2.rtps.discovery import Address

Parts = Sequence[bytes | memoryview]
"""Of a datagram."""
Send = Callable[[Parts, Address], bool]
"""Sends one datagram; never waits long, and may lose it. False where the system did not take it."""

_BURST = 2
"""Full datagrams in a row; a receiver of default settings has room for three."""
_PAUSE = 0.0003
"""s that a receiver gets to make room."""
_PAUSE_AGAIN = 0.001
"""s between bursts of what is sent again, to all who ask: 120 MB/s, whoever asks for how much."""
_BETWEEN = 1000
"""Small datagrams that may wait for a moment between large ones."""
_WAITING = 64 << 20
"""Bytes that may wait for one receiver, where they are more than one sample."""


@dataclass(slots=True, eq=False)
class _Job:
    """A sample on its way to one receiver."""

    source: object
    pieces: Iterator[Parts]
    size: int
    lost: Callable[[], None]
    """Called where the system did not take all of it."""
    whole: bool = True


class Outbox:
    """Sends samples to receivers, each at its pace; on the loop's thread.

    Args:
        send: See `Send`.
        wake: Calls `tick` after so many seconds; None sends everything at once.
    """

    def __init__(self, send: Send, wake: Callable[[float], None] | None = None) -> None:
        self._send = send
        self._wake = wake
        self._jobs: dict[Address, deque[_Job]] = {}
        self._sizes: dict[Address, int] = {}
        self._between: dict[Address, deque[tuple[Parts, Callable[[], None]]]] = {}
        self._again: dict[object, tuple[Iterator[Parts], Address]] = {}
        """What is sent again, by who asked."""
        self._again_at = 0.0

    def put(
        self,
        source: object,
        pieces: Iterator[Parts],
        size: int,
        address: Address,
        *,
        lost: Callable[[], None],
        most: int,
    ) -> None:
        """Sends a sample after those that wait already.

        Args:
            source: Its writer.
            pieces: Its datagrams, made when they are sent.
            size: Of all of them, in bytes.
            address: Of the receiver.
            lost: Called where the system did not take all of it, or too much waits already.
            most: Samples of the source that may wait; the oldest is dropped for a new one. A
                receiver that was slow for a while would else get only old samples from then on.
        """
        waiting = self._jobs.get(address)
        if waiting is None:
            self._jobs[address] = waiting = deque()
            self._sizes[address] = 0
        elif self._sizes[address] + size > _WAITING:
            lost()
            return
        else:
            self._drop_oldest(source, address, most)
        waiting.append(_Job(source, pieces, size, lost))
        self._sizes[address] += size
        if len(waiting) == 1:
            self._go_on(address)
            self._sleep()

    def _drop_oldest(self, source: object, address: Address, most: int) -> None:
        """Makes room for a sample of a source, if as many as may wait do. One is on its way."""
        waiting = self._jobs[address]
        own = [job for job in itertools.islice(waiting, 1, None) if job.source is source]
        if len(own) >= most:
            waiting.remove(own[0])
            self._sizes[address] -= own[0].size
            own[0].lost()

    def put_between(self, parts: Parts, address: Address, lost: Callable[[], None]) -> None:
        """Sends a datagram: at once, or where larger samples are under way, before their next part.

        Right behind their last part it would meet a receiver that has no room.
        """
        if address not in self._jobs:
            if not self._send(parts, address):
                lost()
            return
        between = self._between.setdefault(address, deque())
        if len(between) >= _BETWEEN:
            lost()
        else:
            between.append((parts, lost))

    def is_sending(self, source: object, address: Address) -> bool:
        """Whether a sample of a writer is under way."""
        return any(job.source is source for job in self._jobs.get(address, ()))

    def put_again(self, asker: object, pieces: Iterator[Parts], address: Address) -> None:
        """Sends what somebody asked for again, unless it is being sent to it already."""
        if asker not in self._again:
            self._again[asker] = pieces, address
            if self._wake is None or time.monotonic() >= self._again_at:
                self._go_on_again()
            self._sleep()

    def tick(self) -> None:
        """Sends what is due."""
        for address in list(self._jobs):
            self._go_on(address)
        if self._again and time.monotonic() >= self._again_at:
            self._go_on_again()
        self._sleep()

    def _sleep(self) -> None:
        if self._wake is not None and (self._jobs or self._again):
            self._wake(_PAUSE)

    def _go_on(self, address: Address) -> None:
        for small, lost in self._between.pop(address, ()):
            if not self._send(small, address):
                lost()
        waiting = self._jobs[address]
        left = _BURST
        while waiting and (left or self._wake is None):
            job = waiting[0]
            parts = next(job.pieces, None)
            if parts is not None:
                left -= 1
                job.whole = self._send(parts, address) and job.whole
                continue
            waiting.popleft()
            self._sizes[address] -= job.size
            if not job.whole:
                job.lost()
        if not waiting:
            del self._jobs[address], self._sizes[address]

    def _go_on_again(self) -> None:
        left = _BURST
        while self._again and (left or self._wake is None):
            # All who ask take turns.
            asker = next(iter(self._again))
            pieces, address = self._again.pop(asker)
            parts = next(pieces, None)
            if parts is not None:
                left -= 1
                self._again[asker] = pieces, address
                self._send(parts, address)
        self._again_at = time.monotonic() + _PAUSE_AGAIN
