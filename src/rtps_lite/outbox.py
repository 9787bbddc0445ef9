"""Paced sending of large samples, because receivers need time to empty their buffers."""

from __future__ import annotations

import itertools
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from rtps_lite.discovery import Address

Parts = Sequence[bytes | memoryview]
"""Parts of a datagram."""
Send = Callable[[Parts, Address], bool]
"""Sends a datagram, without waiting long. It may be lost. Returns False if the system refuses
it."""

_BURST = 2
"""Number of full datagrams in a burst. Receivers with default settings have space for three."""
_PAUSE = 0.0003
"""Pause in s in which the receiver makes space."""
_PAUSE_AGAIN = 0.001
"""Interval in s between bursts of repeated samples to all receivers, which limits them to 120
MB/s."""
_BETWEEN = 1000
"""Maximum number of small datagrams that wait between large ones."""
_WAITING = 64 << 20
"""Maximum queued bytes per receiver, unless they are a single sample."""


@dataclass(slots=True, eq=False)
class _Job:
    """A sample in transmission to one receiver."""

    source: object
    pieces: Iterator[Parts]
    size: int
    lost: Callable[[], None]
    """Called if the system refused a part of the sample."""
    whole: bool = True


class Outbox:
    """Sends samples to each receiver at its own pace. Used on the loop's thread.

    Args:
        send: See `Send`.
        wake: Schedules `tick` after a delay in s. None sends everything at once.
    """

    def __init__(self, send: Send, wake: Callable[[float], None] | None = None) -> None:
        self._send = send
        self._wake = wake
        self._jobs: dict[Address, deque[_Job]] = {}
        self._sizes: dict[Address, int] = {}
        self._between: dict[Address, deque[tuple[Parts, Callable[[], None]]]] = {}
        self._again: dict[object, tuple[Iterator[Parts], Address]] = {}
        """Repeated samples by requesting reader."""
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
        """Sends a sample after all samples that are already queued.

        Args:
            source: Writer of the sample.
            pieces: Datagrams of the sample, created when they are sent.
            size: Total size in bytes.
            address: Address of the receiver.
            lost: Called if the system refused a part of the sample, or the queue is full.
            most: Maximum number of queued samples of the source. A new sample replaces the oldest.
                Otherwise a receiver that was slow for a while would receive only old samples from
                then on.
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
        """Makes space if the source has reached its limit. The first sample is never dropped."""
        waiting = self._jobs[address]
        own = [job for job in itertools.islice(waiting, 1, None) if job.source is source]
        if len(own) >= most:
            waiting.remove(own[0])
            self._sizes[address] -= own[0].size
            own[0].lost()

    def put_between(self, parts: Parts, address: Address, lost: Callable[[], None]) -> None:
        """Sends a datagram at once, or before the next part of a larger sample.

        Directly after the last part, the receiver would have no space.
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
        """Whether a sample of a writer is in transmission."""
        return any(job.source is source for job in self._jobs.get(address, ()))

    def put_again(self, asker: object, pieces: Iterator[Parts], address: Address) -> None:
        """Repeats what a reader requested, unless a repetition is already in progress."""
        if asker not in self._again:
            self._again[asker] = pieces, address
            if self._wake is None or time.monotonic() >= self._again_at:
                self._go_on_again()
            self._sleep()

    def tick(self) -> None:
        """Sends all datagrams that are due."""
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
            # All requesting readers take turns.
            asker = next(iter(self._again))
            pieces, address = self._again.pop(asker)
            parts = next(pieces, None)
            if parts is not None:
                left -= 1
                self._again[asker] = pieces, address
                self._send(parts, address)
        self._again_at = time.monotonic() + _PAUSE_AGAIN
