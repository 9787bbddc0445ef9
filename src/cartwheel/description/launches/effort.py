"""What the launch files near a robot may cost to read."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator

UNKNOWN = "\0"
"""A character in texts of which a part is unknown."""
LONGEST = 10_000
"""Maximum length of a text or list that is computed."""
_STEPS = 30_000_000
"""Each takes about a microsecond. The launch files of the largest public repositories take fewer
than a million."""
_SECONDS = 5.0
"""CPU time of all expressions."""
_MOST_SECONDS = 30.0
"""CPU time of all steps, of which a few are slow, such as those that join long lists."""
_LOOK = 1000
"""Steps between two looks at the clock."""
_SEARCH = 3000
"""Steps of the search for a package, in thousands of folders."""
_YAML = 20
"""Steps for each character of a YAML file, because PyYAML is slow."""


class TooCostlyError(Exception):
    """The launch files cost more than they may."""


class Effort:
    """The remaining effort for all launch files that are read together.

    Steps are counted, so that what is read depends only on the files. The limits on time are for
    files that are made to be slow.
    """

    def __init__(self) -> None:
        self._steps = _STEPS
        self._next_look = _STEPS
        self._seconds = _SECONDS
        self._end = time.thread_time() + _MOST_SECONDS
        self._packages: set[str] = set()

    @contextlib.contextmanager
    def portion(self) -> Iterator[None]:
        """Limits the block, which reads a launch file, to half of what remains.

        If it costs more, it ends early without an error, and other launch files can still be read.

        Raises:
            TooCostlyError: Nothing remains.
        """
        self._look()
        steps, seconds, end = self._steps // 2, self._seconds / 2, self._end
        self._steps -= steps
        self._seconds -= seconds
        self._next_look = self._steps
        self._end -= (end - time.thread_time()) / 2
        try:
            yield
        except TooCostlyError:
            pass
        finally:
            self._steps += steps
            self._next_look = self._steps
            self._seconds += seconds
            self._end = end

    def spend(self, steps: int = 1) -> None:
        """Counts steps before they are made.

        Raises:
            TooCostlyError: They are too many, or those before took too long.
        """
        if steps > self._steps:
            raise TooCostlyError
        self._steps -= steps
        if self._steps < self._next_look:
            self._look()

    def _look(self) -> None:
        self._next_look = self._steps - _LOOK
        if self._seconds < 0 or time.thread_time() > self._end:
            raise TooCostlyError

    def spend_seconds(self, seconds: float) -> None:
        """Counts CPU time of expressions.

        Raises:
            TooCostlyError: It was too much.
        """
        self._seconds -= seconds
        if self._seconds <= 0:
            raise TooCostlyError

    def search(self, package: str) -> None:
        """Counts the search for a package, whose result is remembered.

        Raises:
            TooCostlyError: There were too many steps.
        """
        self.spend(1 if package in self._packages else _SEARCH)
        self._packages.add(package)

    def load(self, text: str) -> None:
        """Counts a YAML file before it is loaded.

        Raises:
            TooCostlyError: There were too many steps.
        """
        self.spend(_YAML * len(text))


def limited(text: str) -> str:
    """A text; `UNKNOWN` if it is too long, as texts that contain others several times are."""
    return text if len(text) <= LONGEST else UNKNOWN
