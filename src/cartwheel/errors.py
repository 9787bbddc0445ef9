"""Errors and diagnostics: what is wrong, where, and what to write instead.

The file is long because all packages share these classes.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, Self, TypedDict, Unpack

from cartwheel.similar_names import LONGEST, SIMILAR, closest, suggested

Severity = Literal["info", "warning", "error"]


@dataclass(frozen=True, kw_only=True, slots=True)
class Origin:
    """The location of an element in a user's file."""

    file: str
    line: int = 0
    """One-based; 0 if only the file is known."""
    stack: tuple[str, ...] = ()
    """Calls of the enclosing xacro macros, innermost first, each as ``file:line macro``."""

    def __str__(self) -> str:
        return f"{self.file}:{self.line}" if self.line else self.file


Value = str | float | bool | tuple[str, ...] | tuple[float, ...] | None
"""A value in a diagnostic: a name, a number in SI units, or several values of the same kind."""
Place = Literal["", "element", "attribute", "inside", "after", "line"]
"""Where to insert the text of a fix.

``element`` replaces the element at the diagnostic's line. ``attribute`` replaces the attribute with
the same name in that element, or is added to the element. ``inside`` is inserted before the
element's closing tag, and ``after`` behind the element. In YAML, ``line`` replaces the line except
for its indentation, and ``after`` is a new line below with the same indentation. If empty, the text
shows what to write, but the exact location is unknown.
"""


class Where(TypedDict, total=False):
    """What `Code.diagnostic` passes on to a `Diagnostic`."""

    origin: Origin | None
    hint: str
    mark: str
    instead: str
    place: Place


class Details(Where, total=False):
    """The optional arguments of `Code.diagnostic`."""

    severity: Severity | None
    values: Mapping[str, Value] | None


_CODES: dict[str, Code] = {}
"""The codes of this process by number."""


@dataclass(frozen=True, slots=True)
class Code:
    """A kind of diagnostic. `cartwheel.codes` contains all codes and their explanations.

    Args:
        number: Such as ``CW204``. Published numbers never change and are never reused.
        name: Such as ``wheel-separation-mismatch``.
        severity: The default severity.
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
        """Unpickles to the existing instance, so that codes can be compared with ``is``."""
        return _same_code, (self.number, self.name, self.severity, self.summary)

    def diagnostic(
        self,
        message: str,
        *,
        severity: Severity | None = None,
        values: Mapping[str, Value] | None = None,
        **where: Unpack[Where],
    ) -> Diagnostic:
        """Creates a diagnostic with this code.

        Args:
            message: One sentence without location and code.
            severity: None for the code's default severity.
            values: Names and numbers in the message, for programs, tests, rules and JSON.
            **where: The location and the fix; see the fields of `Diagnostic`.
        """
        severity = severity or self.severity
        return Diagnostic(
            code=self, severity=severity, message=message, values=values or {}, **where
        )

    def because(
        self,
        message: str,
        error: Exception,
        *,
        origin: Origin | None = None,
        hint: str | None = None,
        values: Mapping[str, Value] | None = None,
    ) -> Diagnostic:
        """Creates a diagnostic with this code and its cause.

        Args:
            message: What failed; the error's message is appended.
            error: The cause.
            origin: The location if the error has none.
            hint: Replaces the error's hint.
            values: For programs. The error's values are added, and ``cause``: the error's code
                number, or its text.
        """
        if not isinstance(error, CartwheelError):
            error = CartwheelError(one_line(error))
        # Unclassified errors differ if their messages differ.
        cause = error.message if error.code is UNCLASSIFIED else error.code.number
        return self.diagnostic(
            f"{message}: {error.message}",
            origin=error.origin or origin,
            hint=(error.hint or "") if hint is None else hint,
            mark=error.mark,
            values={**error.values, **(values or {}), "cause": cause},
        )


def known_code(number: str) -> Code | None:
    """The code with this number, or None if it does not exist in this process."""
    return _CODES.get(number)


def _same_code(number: str, name: str, severity: Severity, summary: str) -> Code:
    code = Code(number, name, severity, summary)
    known = _CODES[number]
    return known if known == code else code


UNCLASSIFIED = Code("CW000", "unclassified", "error", "a diagnostic without a specific code")
"""Code for diagnostics without a specific code."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Diagnostic:
    """A diagnostic about a file, a plugin, a wire protocol or the simulation."""

    severity: Severity
    message: str
    """One sentence without location and code."""
    code: Code = UNCLASSIFIED
    origin: Origin | None = None
    hint: str = ""
    """The likely fix, as a sentence."""
    values: Mapping[str, Value] = field(default_factory=dict, compare=False)
    """Names and numbers in the message, for programs."""
    mark: str = ""
    """The text in the source line that the caret points to; empty for the whole tag."""
    instead: str = ""
    """The replacement text."""
    place: Place = ""
    """Where to insert `instead`."""
    also: tuple[Diagnostic, ...] = ()
    """Additional diagnostics with this code at the same location, for example from one macro."""
    details: str = field(default="", compare=False)
    """A Python traceback, for the author of the failing code."""

    @property
    def kind(self) -> tuple[object, ...]:
        """Equal for diagnostics that differ only in their names and numbers.

        A tag or an attribute is part of the kind. For unclassified diagnostics, so is the message.
        """
        fixed = (self.values.get("tag"), self.values.get("attribute"))
        message = self.message if self.code is UNCLASSIFIED else ""
        return (self.code, self.severity, *fixed, message)

    @property
    def text(self) -> str:
        """Message, hint and code number on one line without location, for logs."""
        hint = f". {self.hint}" if self.hint else ""
        code = f" [{self.code.number}]" if self.code is not UNCLASSIFIED else ""
        return f"{self.message}{hint}{code}"

    @property
    def sorted_values(self) -> tuple[tuple[str, Value], ...]:
        """The values sorted by name, to compare diagnostics."""
        return tuple(sorted(self.values.items(), key=lambda item: item[0]))

    @property
    def identity(self) -> tuple[object, ...]:
        """Equal for two reports of the same fault.

        For unclassified diagnostics, the message is part of the identity.
        """
        message = self.message if self.code is UNCLASSIFIED else ""
        return (self.code, message, str(self.origin), self.sorted_values)

    def __str__(self) -> str:
        place = f"{self.origin}: " if self.origin else ""
        code = f" [{self.code}]" if self.code is not UNCLASSIFIED else ""
        return f"{place}{self.severity}: {self.message}{code}"


class Pickled(BaseException):
    """An exception that `pickle` restores with all attributes, without its constructor.

    Without it, `pickle` would call the constructor with the message as the only argument, and a
    process that receives the error, such as one with a `multiprocessing.Pool`, would hang.
    """

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self), self.args, self.__dict__)


def _restored(
    kind: type[BaseException], args: tuple[Any, ...], state: dict[str, Any]
) -> BaseException:
    error = kind.__new__(kind, *args)
    error.args = args
    error.__dict__.update(state)
    return error


class CartwheelError(Pickled, Exception):
    """Base class of errors that the user can correct; the command line exits with 2.

    Args:
        message: One sentence without location and code.
        code: The diagnostic code; None for the class's default.
        origin: The location in the user's file.
        hint: The likely fix, as a sentence.
        values: Names and numbers in the message, for programs.
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

    def __str__(self) -> str:
        text = f"{self.origin}: {self.message}" if self.origin else self.message
        if self.hint:
            text += f"\n  {self.hint}"
        if self.origin:
            text += "".join(f"\n  in {frame}" for frame in self.origin.stack)
        return text

    def diagnostic(self, severity: Severity = "error") -> Diagnostic:
        """Converts the error to a diagnostic, to report it without raising it."""
        return self.code.diagnostic(
            self.message,
            severity=severity,
            origin=self.origin,
            hint=self.hint or "",
            values=self.values,
            mark=self.mark,
        )

    @classmethod
    def of(cls, error: CartwheelError, origin: Origin | None) -> Self:
        """The same fault as an error of this class, at a different location."""
        return cls(
            error.message, code=error.code, origin=origin, hint=error.hint, values=error.values
        )


class DescriptionError(CartwheelError):
    """A robot or world description that cannot be used."""


class WorldError(CartwheelError):
    """A model that cannot be built, spawned or deleted."""


class SimulationError(CartwheelError):
    """A simulation that cannot continue."""


class DivergedError(SimulationError):
    """A simulation whose state is no longer finite."""


class TimedOutError(SimulationError, TimeoutError):
    """Something that was awaited did not happen within the simulation time allowed."""


class PluginError(CartwheelError):
    """A plugin or sensor with invalid parameters."""


class GraphError(CartwheelError):
    """An invalid topic, service or message."""


class RecordingError(CartwheelError):
    """A recording that cannot be written or read."""


class ControlError(CartwheelError):
    """A running simulation that cannot be reached or rejects a request."""


class StaticModelError(PluginError):
    """A plugin that would drive a joint of a static model."""


class UnknownNameError(CartwheelError):
    """An unknown name; the message lists existing names or suggests the likely one.

    The values are ``kind``, ``name`` and ``meant``, the likely name or an empty string. A `message`
    replaces the statement that the name does not exist.
    """

    def __init__(
        self,
        kind: str,
        name: str,
        existing: Iterable[str],
        *,
        code: Code | None = None,
        origin: Origin | None = None,
        message: str = "",
    ) -> None:
        known = sorted(set(existing))
        shown = name if len(name) <= LONGEST else f"{name[:LONGEST]}…"
        close = closest(name, known, SIMILAR)
        super().__init__(
            message or f'{kind} "{shown}" does not exist',
            code=code,
            origin=origin,
            hint=suggested(close, known) if known or not message else "",
            values={"kind": kind, "name": shown, "meant": close[0] if close else ""},
        )


def one_line(error: Exception) -> str:
    """An error on one line: with location and hint, or with its class if it is not a
    CartwheelError.
    """
    if not isinstance(error, CartwheelError):
        return f"{type(error).__name__}: {error}"
    place = f"{error.origin}: " if error.origin else ""
    return f"{place}{error.message}{f'. {error.hint}' if error.hint else ''}"


def enumerated(texts: Iterable[str]) -> str:
    """Texts in a sentence, as in ``a, b and c``."""
    *first, last = [*texts] or [""]
    return f"{', '.join(first)} and {last}" if first else last


def fault(
    message: str,
    error: BaseException,
    origin: Origin | None = None,
    *,
    code: Code = UNCLASSIFIED,
    values: Mapping[str, Value] | None = None,
) -> Diagnostic:
    """Creates a diagnostic for code that raised an error, with the traceback as details.

    Args:
        message: What failed; the error's message is appended.
        error: The error.
        origin: The location in the user's file, if the error has none.
        code: The diagnostic code.
        values: For programs. ``cause`` is added: the number of the error's code, or its class.
    """
    import traceback  # Imported only for faults, because the import would delay every start.

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
