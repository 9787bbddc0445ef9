"""Memory limits for incomplete samples from other participants."""

from __future__ import annotations

from collections import Counter

from rtps_lite.wire import Prefix

LARGEST = 128 << 20
"""Maximum size of a sample in bytes. A point cloud with 1920 x 1080 points has 66 MB. A message
of twice that size is not a command for a simulation."""
_OF_PARTICIPANT = LARGEST + (32 << 20)
"""Maximum bytes per participant: its largest sample and the samples after it."""
_IN_ALL = 2 * _OF_PARTICIPANT
"""Maximum bytes in total, for two such participants at a time."""


class Room:
    """Bytes of incomplete samples by participant, shared by all local readers."""

    def __init__(self) -> None:
        self._of: Counter[Prefix] = Counter()
        self._in_all = 0

    @property
    def held(self) -> int:
        """Reserved bytes in total."""
        return self._in_all

    def take(self, prefix: Prefix, size: int) -> bool:
        """Reserves bytes. Returns False if the limit is exceeded."""
        if self._of[prefix] + size > _OF_PARTICIPANT or self._in_all + size > _IN_ALL:
            if not self._of[prefix]:
                del self._of[prefix]
            return False
        self._of[prefix] += size
        self._in_all += size
        return True

    def free(self, prefix: Prefix, size: int) -> None:
        """Releases bytes."""
        self._in_all -= size
        self._of[prefix] -= size
        if not self._of[prefix]:
            del self._of[prefix]
