"""The samples that a writer keeps for repetition, and their datagrams.

Source: RTPS 2.5, 8.2.3 (HistoryCache) and 8.4.14.1 (fragments of large samples).
"""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass

from rtps_lite import wire
from rtps_lite.discovery import EndpointQos
from rtps_lite.outbox import Parts
from rtps_lite.wire import Guid, Prefix

_MOST_BYTES = 64 << 20
"""Maximum bytes of all samples in a history, unless they are a single sample."""


@dataclass(frozen=True, slots=True)
class Sample:
    """A written sample."""

    number: int
    """Sequence number, from 1."""
    payload: bytes
    inline: bytes
    to: Prefix | None
    """The only receiving participant; None for all."""
    written: bytes
    """Encoded timestamp submessage."""
    at: int
    """Timestamp in ns."""
    keyed: bool = False

    @property
    def fragments(self) -> int:
        """Number of fragments; at most 1 if the sample fits into one datagram."""
        return -(-len(self.payload) // wire.LARGEST)

    def datagrams(
        self, writer: Guid, to: Prefix, reader: bytes, only: set[int] | None = None
    ) -> Iterator[Parts]:
        """Datagrams of the sample, created when they are requested.

        Args:
            writer: The sample's writer.
            to: The receiving participant.
            reader: Entity ID of the receiving reader.
            only: Numbers of the fragments, from 1; None for all.
        """
        prefix, entity = writer[:12], writer[12:]
        if len(self.payload) <= wire.LARGEST:
            head = wire.data_head(
                reader=reader,
                writer=entity,
                number=self.number,
                inline=self.inline,
                size=len(self.payload),
                keyed=self.keyed,
            )
            yield wire.message(prefix, self.written, head, to=to), self.payload
            return
        whole = memoryview(self.payload)
        for fragment in range(1, self.fragments + 1) if only is None else sorted(only):
            part = whole[(fragment - 1) * wire.LARGEST : fragment * wire.LARGEST]
            head = wire.fragment_head(
                reader=reader,
                writer=entity,
                number=self.number,
                inline=self.inline,
                fragment=fragment,
                length=len(part),
                size=len(whole),
            )
            yield wire.message(prefix, self.written, head, to=to), part


class History:
    """The samples that a writer keeps, oldest first.

    Args:
        qos: Policies of the writer. `depth` limits the number of samples, and `lifespan` their age.
    """

    def __init__(self, qos: EndpointQos) -> None:
        self._qos = qos
        self._samples: OrderedDict[int, Sample] = OrderedDict()
        self._bytes = 0

    def __iter__(self) -> Iterator[Sample]:
        return iter(self._samples.values())

    def get(self, number: int) -> Sample | None:
        """The sample with a sequence number; None if it is not kept."""
        return self._samples.get(number)

    def first(self, default: int) -> int:
        """Sequence number of the oldest sample; `default` if the history is empty."""
        return next(iter(self._samples), default)

    def add(self, sample: Sample) -> None:
        """Adds the newest sample, and discards the oldest ones beyond the limits."""
        self._samples[sample.number] = sample
        self._bytes += len(sample.payload)
        while len(self._samples) > self._qos.depth or (
            self._bytes > _MOST_BYTES and len(self._samples) > 1
        ):
            self._discard_oldest()

    def expire(self, now: int) -> None:
        """Discards the samples whose lifespan has ended at time `now`, in ns."""
        while self._samples and self._qos.lifespan < math.inf:
            if now - next(iter(self)).at <= self._qos.lifespan * 1e9:
                break
            self._discard_oldest()

    def clear(self) -> None:
        """Discards all samples."""
        self._samples.clear()
        self._bytes = 0

    def _discard_oldest(self) -> None:
        _, oldest = self._samples.popitem(last=False)
        self._bytes -= len(oldest.payload)
