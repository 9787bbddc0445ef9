"""Why messages did not get into a ring."""

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
"""s after the first loss, when it is clear whether the reader goes on reading."""

Later = Callable[[float, Callable[[], None]], None]


class Losses:
    """Warns of messages that were dropped, with their cause.

    Args:
        ring: That did not take them.
        later: Runs a function after some seconds, on a thread of its own.
        warn: Takes a warning for the user.
    """

    def __init__(self, ring: RingWriter, later: Later, warn: Callable[[Diagnostic], None]) -> None:
        self._ring = ring
        self._later = later
        self._warn = warn
        self._lock = threading.Lock()
        self._lost: Counter[str] = Counter()
        """Messages by topic, of those that are not judged yet."""
        self._read = 0
        """What the ring's reader had read before them."""
        self._too_large: set[str] = set()
        self._still = False

    def add(self, topic: str, put: Put, size: int) -> None:
        """A message was dropped; on any thread.

        Args:
            topic: Of the message.
            put: What the ring said.
            size: Bytes of the message.
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
                # Until it does, there is nothing new to say.
                self._later(_JUDGED, self._judge)
                return
            lost = self._lost
            if reads:
                self._lost = Counter()
        if not reads:
            self._still = True
            self._warn(
                BRIDGE_SLOW.diagnostic(
                    "its process is suspended or blocked; messages are dropped until it reads again"
                )
            )
            self._later(_JUDGED, self._judge)
        elif self._still:
            self._still = False
            self._warn(
                BRIDGE_RECOVERED.diagnostic(
                    f"its process reads again; {_counted(lost)} were dropped",
                    values={"dropped": _counted(lost)},
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
