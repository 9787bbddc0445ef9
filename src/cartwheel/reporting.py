"""Reports each diagnostic once, and different ones at a limited rate."""

from __future__ import annotations

import threading
from collections.abc import Callable, Hashable
from dataclasses import replace

from cartwheel.budget import Budget
from cartwheel.errors import UNCLASSIFIED, Diagnostic


class Once:
    """Selects the warnings to show: each one once, and different warnings at a limited rate.

    Two warnings are the same if their codes, locations and values are equal. Values may contain
    names chosen by remote clients, so the number of warnings is limited, but a warning after a
    flood is still shown. Suppressed warnings are counted. Thread-safe.

    Args:
        most: Different warnings in a burst; after that, one every 10 s.
    """

    PAUSE = 10.0
    """Interval between warnings after the burst, s."""

    def __init__(self, most: int) -> None:
        self._budget = Budget(most, 1 / self.PAUSE)
        self._most = most
        self._shown: dict[int, None] = {}
        """Hashes of the latest warnings, because their values may be long."""
        self._left_out = 0
        self._lock = threading.Lock()

    def __call__(self, diagnostic: Diagnostic) -> Diagnostic | None:
        """Returns the warning with the number of suppressed warnings, or None if it is suppressed.

        The number is also in its values, as ``left_out``.
        """
        left_out = self._take(_identity(diagnostic))
        if left_out is None:
            return None
        if left_out < 0:
            more = f" (from now on, at most one such warning is shown every {self.PAUSE:g} s)"
            return replace(diagnostic, message=diagnostic.message + more)
        if not left_out:
            return diagnostic
        return replace(
            diagnostic,
            message=f"{diagnostic.message} (warnings not shown: {left_out})",
            values={**diagnostic.values, "left_out": left_out},
        )

    def allows(self, key: Hashable) -> bool:
        """Whether a warning with this key is shown, before the warning is created."""
        return self._take(hash(key)) is not None

    def _take(self, key: int) -> int | None:
        """Number of warnings suppressed before; -1 for the last in a burst; None if suppressed."""
        with self._lock:
            if key in self._shown:
                return None
            if not self._budget.take():
                self._left_out += 1
                return None
            self._shown[key] = None
            if len(self._shown) > self._most:
                del self._shown[next(iter(self._shown))]
            elif len(self._shown) == self._most:
                return -1
            left_out, self._left_out = self._left_out, 0
            return left_out


class Reporter:
    """Reports each diagnostic once, as selected by `Once`. Thread-safe.

    Args:
        report: Called with each diagnostic to show.
        most: As for `Once`.
        title: The source of the diagnostics, as a prefix to each message.
    """

    def __init__(
        self, report: Callable[[Diagnostic], object], most: int, *, title: str = ""
    ) -> None:
        self._report = report
        self._once = Once(most)
        self._before = f"{title}: " if title else ""

    def __call__(self, diagnostic: Diagnostic) -> None:
        """Reports a diagnostic that has not been reported yet."""
        if shown := self._once(diagnostic):
            self.always(shown)

    def always(self, diagnostic: Diagnostic) -> None:
        """Reports a diagnostic even if it has been reported before."""
        self._report(replace(diagnostic, message=f"{self._before}{diagnostic.message}"))


def _identity(diagnostic: Diagnostic) -> int:
    if diagnostic.code is UNCLASSIFIED:
        return hash((diagnostic.message, diagnostic.origin))
    return hash((diagnostic.code.number, diagnostic.origin, diagnostic.sorted_values))
