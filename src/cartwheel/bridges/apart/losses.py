"""Diagnosis of messages that were dropped because a ring was full."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable

from cartwheel.bridges.apart.ring import Put, RingWriter
from cartwheel.codes.wires import (
    BRIDGE_RECOVERED,
    BRIDGE_SLOW,
    MESSAGE_TOO_LARGE,
    PUBLISHED_TOO_FAST,
)
from cartwheel.errors import Diagnostic

_JUDGED = 0.5
"""Delay in s after the first dropped message, until it is clear whether the reader still reads."""

Later = Callable[[float, Callable[[], None]], None]


class Losses:
    """Warns of dropped messages, with their cause.

    Args:
        ring: Ring that rejected the messages.
        later: Runs a function after a number of seconds on a separate thread.
        warn: Receives warnings for the user.
    """

    def __init__(self, ring: RingWriter, later: Later, warn: Callable[[Diagnostic], None]) -> None:
        self._ring = ring
        self._later = later
        self._warn = warn
        self._lock = threading.Lock()
        self._lost: Counter[str] = Counter()
        """Dropped messages by topic, until their cause is reported."""
        self._read = 0
        """Bytes that the ring's reader had read before the first dropped message."""
        self._too_large: set[str] = set()
        self._still = False

    def add(self, topic: str, put: Put, size: int) -> None:
        """Counts a dropped message. Callable on any thread.

        Args:
            topic: Topic of the message.
            put: Result of the ring.
            size: Size of the message in bytes.
        """
        if put is Put.TOO_LARGE:
            if topic not in self._too_large:
                self._too_large.add(topic)
                self._warn(
                    MESSAGE_TOO_LARGE.diagnostic(
                        f"a {size / 1e6:.0f} MB message on {topic} exceeds the bridge's "
                        f"limit of {self._ring.largest / 1e6:.0f} MB; such messages are "
                        "dropped",
                        values={"topic": topic},
                    )
                )
            return
        with self._lock:
            is_first = not self._lost
            self._lost[topic] += 1
            if is_first:
                self._read = self._ring.look()
        if is_first:
            self._later(_JUDGED, self._judge)

    def _judge(self) -> None:
        with self._lock:
            reads = self._ring.look() > self._read
            if not reads and self._still:
                # The state has not changed since the last warning.
                self._later(_JUDGED, self._judge)
                return
            lost = self._lost
            if reads:
                self._lost = Counter()
        if not reads:
            self._still = True
            self._warn(
                BRIDGE_SLOW.diagnostic(
                    "the bridge process is suspended or blocked; messages are dropped until it "
                    "reads again"
                )
            )
            self._later(_JUDGED, self._judge)
        elif self._still:
            self._still = False
            self._warn(
                BRIDGE_RECOVERED.diagnostic(
                    f"the bridge process has caught up; {_counted(lost)} were dropped",
                    values={"dropped": lost.total(), "topics": tuple(sorted(lost))},
                )
            )
        else:
            for topic in lost:
                self._warn(
                    PUBLISHED_TOO_FAST.diagnostic(
                        f"{topic} is published faster than the bridge process reads it, so "
                        "messages are dropped",
                        values={"topic": topic},
                    )
                )


def _counted(lost: Counter[str]) -> str:
    return ", ".join(f"{count} messages on {topic}" for topic, count in sorted(lost.items()))
