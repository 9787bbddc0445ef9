"""The errors a user sees: what is wrong, where, and what to write instead."""

from __future__ import annotations

import difflib
import threading
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, Literal

from cartwheel.budget import Budget

Severity = Literal["info", "warning", "error"]

_LONGEST = 500
"""Characters of a name that is shown whole and compared with others."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Origin:
    """The place in a user's file that made an element."""

    file: str
    line: int = 0
    """One-based; 0 where only the file is known."""
    stack: tuple[str, ...] = ()
    """Calls of the enclosing xacro macros, innermost first, each as ``file:line macro``."""

    def __str__(self) -> str:
        return f"{self.file}:{self.line}" if self.line else self.file


@dataclass(frozen=True, kw_only=True, slots=True)
class Diagnostic:
    """Something a user should know about a file that nevertheless loads."""

    severity: Severity
    message: str
    origin: Origin | None = None
    details: str = field(default="", compare=False)
    """Python's traceback, for the author of what failed."""

    def __str__(self) -> str:
        place = f"{self.origin}: " if self.origin else ""
        return f"{place}{self.severity}: {self.message}"


class CartwheelError(Exception):
    """Base of every error that is the user's to mend; the command line prints it and exits with 2.

    Args:
        message: One sentence without its place.
        origin: The place in the user's file.
        hint: The likely fix, a sentence of its own.
    """

    def __init__(
        self, message: str, *, origin: Origin | None = None, hint: str | None = None
    ) -> None:
        self.message = message
        self.origin = origin
        self.hint = hint
        super().__init__(message)

    def __reduce__(self) -> tuple[Any, ...]:
        """For other processes: subclasses are made of other arguments."""
        return _remade, (type(self), self.message, self.origin, self.hint)

    def __str__(self) -> str:
        text = f"{self.origin}: {self.message}" if self.origin else self.message
        if self.hint:
            text += f"\n  {self.hint}"
        if self.origin:
            text += "".join(f"\n  in {frame}" for frame in self.origin.stack)
        return text


def _remade(
    kind: type[CartwheelError], message: str, origin: Origin | None, hint: str | None
) -> CartwheelError:
    error = kind.__new__(kind, message)
    CartwheelError.__init__(error, message, origin=origin, hint=hint)
    return error


class DescriptionError(CartwheelError):
    """A robot or world description that cannot be used."""


class WorldError(CartwheelError):
    """A model that cannot be built, spawned or deleted."""


class SimulationError(CartwheelError):
    """A simulation that cannot go on."""


class DivergedError(SimulationError):
    """A simulation whose state is no longer finite."""


class PluginError(CartwheelError):
    """A plugin or sensor whose parameters make no sense."""


class GraphError(CartwheelError):
    """A topic, service or message that does not fit."""


class RecordingError(CartwheelError):
    """A recording that cannot be written or read."""


class ControlError(CartwheelError):
    """A running simulation that cannot be reached or refuses a request."""


class StaticModelError(PluginError):
    """A plugin would drive a joint of a model that is static."""


class UnknownNameError(CartwheelError):
    """A name that does not exist; says which do and which was likely meant."""

    def __init__(
        self, kind: str, name: str, existing: Iterable[str], *, origin: Origin | None = None
    ) -> None:
        known = sorted(set(existing))
        shown = name if len(name) <= _LONGEST else f"{name[:_LONGEST]}…"
        super().__init__(
            f'{kind} "{shown}" does not exist', origin=origin, hint=suggestion(name, known)
        )


def one_line(error: Exception) -> str:
    """An error for who shows a line alone: the user's with place and hint, ours with its class."""
    if not isinstance(error, CartwheelError):
        return f"{type(error).__name__}: {error}"
    place = f"{error.origin}: " if error.origin else ""
    return f"{place}{error.message}{f'. {error.hint}' if error.hint else ''}"


def fault(message: str, error: BaseException, origin: Origin | None = None) -> Diagnostic:
    """What to say of code that raised an error; the traceback is in the details."""
    import traceback  # only at a fault: its import would slow every start

    said, place = f"{type(error).__name__}: {error}", origin
    if isinstance(error, CartwheelError):
        said = f"{error.message}{f'. {error.hint}' if error.hint else ''}"
        place = error.origin or origin
    return Diagnostic(
        severity="error",
        message=f"{message}: {said}",
        origin=place,
        details="".join(traceback.format_exception(error)).rstrip(),
    )


class Once:
    """Chooses which warnings are shown: each text once, and different ones at a bounded rate.

    Texts may hold names that a stranger chose, so their number is bounded, but a warning that
    comes after a flood is still shown. Those left out are counted. From any thread.

    Args:
        most: Different texts at once; after these, one every 10 s.
    """

    PAUSE = 10.0
    """s between two warnings in the long run."""

    def __init__(self, most: int) -> None:
        self._budget = Budget(most, 1 / self.PAUSE)
        self._most = most
        self._shown: dict[int, None] = {}
        """Hashes of the latest texts, since a text may be long."""
        self._left_out = 0
        self._lock = threading.Lock()

    def __call__(self, text: str) -> str | None:
        """The text to show, with the number of those left out; None if it is not shown."""
        with self._lock:
            key = hash(text)
            if key in self._shown:
                return None
            if not self._budget.take():
                self._left_out += 1
                return None
            self._shown[key] = None
            if len(self._shown) > self._most:
                del self._shown[next(iter(self._shown))]
            elif len(self._shown) == self._most:
                return f"{text} (from now on at most one warning every {self.PAUSE:g} s is shown)"
            if not self._left_out:
                return text
            left_out, self._left_out = self._left_out, 0
            return f"{text} (warnings that are not shown: {left_out})"


def likely(name: str, existing: Iterable[str], *, cutoff: float = 0.75) -> str:
    """A sentence that names the likely meant one of `existing`, or nothing."""
    close = _close(name, list(existing), cutoff)
    return f'Did you mean "{close[0]}"?' if close else ""


def suggestion(name: str, existing: Iterable[str]) -> str:
    """A sentence that names the likely meant one of `existing`, or lists them."""
    known = list(existing)
    if not known:
        return "There are none."
    close = _close(name, known, 0.6)
    if close:
        return f'Did you mean "{close[0]}"?'
    shown = ", ".join(known[:12])
    return f"There are: {shown}{', …' if len(known) > 12 else ''}."


def _close(name: str, known: list[str], cutoff: float) -> list[str]:
    """The likely one; none for a name of megabytes, which others may ask for."""
    if len(name) > _LONGEST:
        return []
    return difflib.get_close_matches(name, known, n=1, cutoff=cutoff)
