"""The errors a user sees: what is wrong, where, and what to write instead."""

from __future__ import annotations

import difflib
import threading
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from cartwheel.budget import Budget

Severity = Literal["info", "warning", "error"]

_SIMILAR = 0.6
"""How alike two names are at least, where one is proposed for the other."""
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


Value = str | float | bool | tuple[str, ...] | tuple[float, ...] | None
"""What a diagnostic is about, for programs: a name, a number in SI units, several of one kind."""
Place = Literal["", "element", "attribute", "inside", "after", "line"]
"""Where the text of a fix goes.

``element`` replaces the element at the diagnostic's line; ``attribute`` replaces its attribute of
the same name, or is added to it; ``inside`` goes in before its closing tag; ``after`` follows
it. In YAML ``line`` replaces the line behind its indentation, and ``after`` is a new line below,
with the same indentation. Empty: the text shows what to write, but no exact place is known.
"""


_CODES: dict[str, Code] = {}
"""The codes of this process by number."""


@dataclass(frozen=True, slots=True)
class Code:
    """One kind of diagnostic. `cartwheel.codes` holds all of them and their explanations.

    Args:
        number: Such as ``CW204``. Published numbers never change and are never reused.
        name: Such as ``wheel-separation-mismatch``.
        severity: The default one.
        summary: What is reported, as a phrase.
    """

    number: str
    name: str
    severity: Severity
    summary: str

    def __post_init__(self) -> None:
        _CODES.setdefault(self.number, self)

    def __str__(self) -> str:
        return f"{self.number} {self.name}"

    def __reduce__(self) -> tuple[Any, ...]:
        """For other processes: each code is there once, so that it can be compared by ``is``."""
        return _same_code, (self.number, self.name, self.severity, self.summary)

    def diagnostic(
        self,
        message: str,
        *,
        origin: Origin | None = None,
        hint: str = "",
        severity: Severity | None = None,
        mark: str = "",
        values: Mapping[str, Value] | None = None,
        instead: str = "",
        place: Place = "",
    ) -> Diagnostic:
        """A diagnostic of this kind.

        Args:
            message: One sentence without place and code.
            origin: The place in the user's file.
            hint: The likely fix, as a sentence.
            severity: Where it differs from the code's.
            mark: The text in the source line that the caret points to; by default the whole tag.
            values: What the message names, for programs: tests, rules, JSON.
            instead: The text to write.
            place: Where `instead` goes.
        """
        return Diagnostic(
            code=self,
            severity=severity or self.severity,
            message=message,
            origin=origin,
            hint=hint,
            mark=mark,
            values=values or {},
            instead=instead,
            place=place,
        )

    def because(
        self,
        message: str,
        error: Exception,
        *,
        origin: Origin | None = None,
        hint: str | None = None,
        severity: Severity | None = None,
        values: Mapping[str, Value] | None = None,
    ) -> Diagnostic:
        """A diagnostic of this kind with its cause.

        Args:
            message: What failed; the error's own message follows it.
            error: What was raised.
            origin: The place if the error has none.
            hint: Instead of the error's.
            severity: Where it differs from the code's.
            values: For programs. The error's values are added, and ``cause``: the number of its
                code, or its text.
        """
        if not isinstance(error, CartwheelError):
            cause = one_line(error)
            return self.diagnostic(
                f"{message}: {cause}",
                origin=origin,
                hint=hint or "",
                severity=severity,
                values={**(values or {}), "cause": cause},
            )
        # An error without a code of its own is another one if its message is.
        cause = error.message if error.code is UNCLASSIFIED else error.code.number
        return self.diagnostic(
            f"{message}: {error.message}",
            origin=error.origin or origin,
            hint=(error.hint or "") if hint is None else hint,
            severity=severity,
            mark=error.mark,
            values={**error.values, **(values or {}), "cause": cause},
        )


def known_code(number: str) -> Code | None:
    """The code with a number, if this process has it."""
    return _CODES.get(number)


def _same_code(number: str, name: str, severity: Severity, summary: str) -> Code:
    code = Code(number, name, severity, summary)
    known = _CODES[number]
    return known if known == code else code


UNCLASSIFIED = Code("CW000", "unclassified", "error", "a diagnostic without a specific code")
"""Of diagnostics that have no code yet."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Diagnostic:
    """Something a user should know: about a file, a plugin, a wire or the run."""

    severity: Severity
    message: str
    """One sentence without place and code."""
    code: Code = UNCLASSIFIED
    origin: Origin | None = None
    hint: str = ""
    """The likely fix, as a sentence."""
    values: Mapping[str, Value] = field(default_factory=dict, compare=False)
    """What the message names, for programs."""
    mark: str = ""
    """The text in the source line that the caret points to; empty for the whole tag."""
    instead: str = ""
    """The text to write."""
    place: Place = ""
    """Where `instead` goes."""
    also: tuple[Diagnostic, ...] = ()
    """Further diagnostics of this code at the same place, as a macro makes them."""
    details: str = field(default="", compare=False)
    """A Python traceback, for the author of the code that failed."""

    @property
    def kind(self) -> tuple[object, ...]:
        """Equal for diagnostics that differ only in the names and numbers they are about.

        A tag or an attribute is part of the kind. Without a code, so is the message.
        """
        fixed = (self.values.get("tag"), self.values.get("attribute"))
        message = self.message if self.code is UNCLASSIFIED else ""
        return (self.code, self.severity, *fixed, message)

    @property
    def text(self) -> str:
        """Message, hint and number of the code in one line without place, for logs."""
        hint = f". {self.hint}" if self.hint else ""
        code = f" [{self.code.number}]" if self.code is not UNCLASSIFIED else ""
        return f"{self.message}{hint}{code}"

    @property
    def sorted_values(self) -> tuple[tuple[str, Value], ...]:
        """The values by name, to compare diagnostics."""
        return tuple(sorted(self.values.items(), key=lambda item: item[0]))

    @property
    def identity(self) -> tuple[object, ...]:
        """Equal for two reports of the same fault."""
        return (self.code, self.message, str(self.origin), self.sorted_values)

    def __str__(self) -> str:
        place = f"{self.origin}: " if self.origin else ""
        code = f" [{self.code}]" if self.code is not UNCLASSIFIED else ""
        return f"{place}{self.severity}: {self.message}{code}"


class CartwheelError(Exception):
    """Base of every error that the user can correct; the command line prints it and exits with 2.

    Args:
        message: One sentence without place and code.
        code: Its kind; by default that of the class.
        origin: The place in the user's file.
        hint: The likely fix, as a sentence.
        values: What the message names, for programs.
        mark: The text in the source line that the caret points to.
    """

    code: Code = UNCLASSIFIED

    def __init__(
        self,
        message: str,
        *,
        code: Code | None = None,
        origin: Origin | None = None,
        hint: str | None = None,
        values: Mapping[str, Value] | None = None,
        mark: str = "",
    ) -> None:
        self.message = message
        if code is not None:
            self.code = code
        self.origin = origin
        self.hint = hint
        self.values: Mapping[str, Value] = values or {}
        self.mark = mark
        super().__init__(message)

    def __reduce__(self) -> tuple[Any, ...]:
        """For other processes: subclasses have other arguments."""
        state = {
            "code": self.code,
            "origin": self.origin,
            "hint": self.hint,
            "values": self.values,
            "mark": self.mark,
        }
        return _restored, (type(self), self.message, state)

    def __str__(self) -> str:
        text = f"{self.origin}: {self.message}" if self.origin else self.message
        if self.hint:
            text += f"\n  {self.hint}"
        if self.origin:
            text += "".join(f"\n  in {frame}" for frame in self.origin.stack)
        return text

    def diagnostic(self, severity: Severity = "error") -> Diagnostic:
        """The same as a diagnostic, for what goes on in spite of it or shows it."""
        return Diagnostic(
            code=self.code,
            severity=severity,
            message=self.message,
            origin=self.origin,
            hint=self.hint or "",
            values=self.values,
            mark=self.mark,
        )


def _restored(kind: type[CartwheelError], message: str, state: Mapping[str, Any]) -> CartwheelError:
    error = kind.__new__(kind, message)
    CartwheelError.__init__(error, message, **state)
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
    """A name that does not exist; says which do and which was likely meant.

    Its values are ``kind``, ``name`` and ``meant``: the likely one, or empty.
    """

    def __init__(
        self,
        kind: str,
        name: str,
        existing: Iterable[str],
        *,
        code: Code | None = None,
        origin: Origin | None = None,
    ) -> None:
        known = sorted(set(existing))
        shown = name if len(name) <= _LONGEST else f"{name[:_LONGEST]}…"
        close = _close(name, known, _SIMILAR)
        super().__init__(
            f'{kind} "{shown}" does not exist',
            code=code,
            origin=origin,
            hint=_suggested(close, known),
            values={"kind": kind, "name": shown, "meant": close[0] if close else ""},
        )


def one_line(error: Exception) -> str:
    """An error on one line: ours with place and hint, others with their class."""
    if not isinstance(error, CartwheelError):
        return f"{type(error).__name__}: {error}"
    place = f"{error.origin}: " if error.origin else ""
    return f"{place}{error.message}{f'. {error.hint}' if error.hint else ''}"


def fault(
    message: str,
    error: BaseException,
    origin: Origin | None = None,
    *,
    code: Code = UNCLASSIFIED,
    values: Mapping[str, Value] | None = None,
) -> Diagnostic:
    """The diagnostic for code that raised an error, with the traceback in its details.

    Args:
        message: What failed; the error's own message follows it.
        error: What was raised.
        origin: The place in the user's file; that of the error where it has one.
        code: The kind of diagnostic.
        values: For programs. ``cause`` is added: the number of the error's code, or its class.
    """
    import traceback  # only at a fault: its import would slow every start

    said, place, cause = f"{type(error).__name__}: {error}", origin, type(error).__name__
    if isinstance(error, CartwheelError):
        said = f"{error.message}{f'. {error.hint}' if error.hint else ''}"
        place, cause = error.origin or origin, error.code.number
    return Diagnostic(
        code=code,
        severity="error",
        message=f"{message}: {said}",
        origin=place,
        values={**(values or {}), "cause": cause},
        details="".join(traceback.format_exception(error)).rstrip(),
    )


class Once:
    """Chooses which warnings are shown: each once, and different ones at a bounded rate.

    Two warnings are the same if their codes, places and values are. Values may hold names that a
    stranger chose, so their number is bounded, but a warning that comes after a flood is still
    shown. Those left out are counted. From any thread.

    Args:
        most: Different warnings at once; after these, one every 10 s.
    """

    PAUSE = 10.0
    """s between two warnings in the long run."""

    def __init__(self, most: int) -> None:
        self._budget = Budget(most, 1 / self.PAUSE)
        self._most = most
        self._shown: dict[int, None] = {}
        """Hashes of the latest warnings, since their values may be long."""
        self._left_out = 0
        self._lock = threading.Lock()

    def __call__(self, diagnostic: Diagnostic) -> Diagnostic | None:
        """The warning to show, with the number of those left out; None if it is not shown.

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
        """The same for a warning that is not made yet: whether it is shown."""
        return self._take(hash(key)) is not None

    def _take(self, key: int) -> int | None:
        """The number left out before; -1 with the last that is shown at once; None if it is not."""
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
    """Reports each diagnostic once, as `Once` chooses them; from any thread.

    Args:
        report: Takes those that are shown.
        most: As for `Once`.
        title: Where they come from; it precedes each message.
    """

    def __init__(
        self, report: Callable[[Diagnostic], object], most: int, *, title: str = ""
    ) -> None:
        self._report = report
        self._once = Once(most)
        self._before = f"{title}: " if title else ""

    def __call__(self, diagnostic: Diagnostic) -> None:
        """Reports a diagnostic unless it has been reported."""
        if shown := self._once(diagnostic):
            self.always(shown)

    def always(self, diagnostic: Diagnostic) -> None:
        """Reports a diagnostic even if it has been reported."""
        self._report(replace(diagnostic, message=f"{self._before}{diagnostic.message}"))


def _identity(diagnostic: Diagnostic) -> int:
    if diagnostic.code is UNCLASSIFIED:
        return hash((diagnostic.message, diagnostic.origin))
    return hash((diagnostic.code.number, diagnostic.origin, diagnostic.sorted_values))


def likely(name: str, existing: Iterable[str], *, cutoff: float = 0.75) -> str:
    """A sentence that names the likely meant one of `existing`, or nothing."""
    meant = meant_one(name, existing, cutoff=cutoff)
    return f'Did you mean "{meant}"?' if meant else ""


def meant_one(name: str, existing: Iterable[str], *, cutoff: float = 0.75) -> str:
    """The likely meant one of `existing`, or nothing."""
    close = _close(name, list(existing), cutoff)
    return close[0] if close else ""


def meant(name: str, existing: Iterable[str]) -> str:
    """The likely meant one of `existing`, which `suggestion` names; empty where none is alike."""
    return meant_one(name, existing, cutoff=_SIMILAR)


def suggestion(name: str, existing: Iterable[str]) -> str:
    """A sentence that names the likely meant one of `existing`, or lists them."""
    known = list(existing)
    return _suggested(_close(name, known, _SIMILAR), known)


def _suggested(close: Sequence[str], known: Sequence[str]) -> str:
    if not known:
        return "None exist."
    if close:
        return f'Did you mean "{close[0]}"?'
    shown = ", ".join(known[:12])
    return f"Valid names: {shown}{', …' if len(known) > 12 else ''}."


def _close(name: str, known: list[str], cutoff: float) -> list[str]:
    """The likely one; none for a name of megabytes, which others may ask for."""
    if len(name) > _LONGEST:
        return []
    return difflib.get_close_matches(name, known, n=1, cutoff=cutoff)
