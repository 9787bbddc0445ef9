"""How much memory others may make us hold for samples that are not complete yet."""

from __future__ import annotations

from collections import Counter

from cartwheel.bridges.ros2.rtps.wire import Prefix

LARGEST = 128 << 20
"""Bytes of a sample: a cloud of 1920 x 1080 points has 66 MB, and what is larger than twice that is
no command for a simulation."""
_OF_PARTICIPANT = LARGEST + (32 << 20)
"""Bytes of one participant: its largest sample, and what came after it."""
_IN_ALL = 2 * _OF_PARTICIPANT
"""Bytes of all: two such participants at a time."""


class Room:
    """What all readers of a participant of ours hold, by whose samples it is."""

    def __init__(self) -> None:
        self._of: Counter[Prefix] = Counter()
        self._in_all = 0

    @property
    def held(self) -> int:
        """Bytes."""
        return self._in_all

    def take(self, prefix: Prefix, size: int) -> bool:
        """Whether there is room for some bytes more, which then are held."""
        if self._of[prefix] + size > _OF_PARTICIPANT or self._in_all + size > _IN_ALL:
            if not self._of[prefix]:
                del self._of[prefix]
            return False
        self._of[prefix] += size
        self._in_all += size
        return True

    def free(self, prefix: Prefix, size: int) -> None:
        """They are held no longer."""
        self._in_all -= size
        self._of[prefix] -= size
        if not self._of[prefix]:
            del self._of[prefix]
