"""The variables of launch files in Python, of which some may have several values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

from cartwheel.description.launches.effort import Effort
from cartwheel.description.launches.python_values import NOTHING, differ


@dataclass(frozen=True, kw_only=True, slots=True)
class Uncertain:
    """What has one of several values: a function or variable, depending on an unknown condition, or
    the text of a file, in which a launch file replaces parts.
    """

    what: Literal["return", "variable", "text"]
    used: int
    """The line of the value that is used, or in which parts are replaced."""


class Place(NamedTuple):
    """Where an expression is in a launch file in Python."""

    file: Path
    line: int
    column: int


class Choice(NamedTuple):
    """A variable that has one of two values, depending on an unknown condition."""

    other: int
    """Line of the value that is not used."""
    used: int


class Variables:
    """The variables that are known at a place in a launch file, by name.

    Those of a branch or function contain only what it assigns itself, so that many of them need
    little memory.

    Args:
        values: Those that are known from the beginning.
        outside: The variables around this place, which others of the same name hide.
    """

    def __init__(self, values: Mapping[str, Any], outside: Variables | None = None) -> None:
        self._values = dict(values)
        self._outside = outside
        self._lines: dict[str, int] = {}
        """The lines in which they were assigned."""
        self._choices: dict[str, Choice] = {}

    def __contains__(self, name: str) -> bool:
        return self._holder(name) is not None

    def get(self, name: str, default: Any = NOTHING) -> Any:
        """The value of a variable."""
        holder = self._holder(name)
        return default if holder is None else holder._values[name]

    def choice(self, name: str) -> Choice | None:
        """Where a variable gets its values if it may have several; None if it has one."""
        holder = self._holder(name)
        return None if holder is None else holder._choices.get(name)

    def assign(self, name: str, value: Any, line: int, choice: Choice | None = None) -> None:
        """Assigns a value in a line, or one of two values."""
        self._values[name] = value
        self._lines[name] = line
        if choice is not None:
            self._choices[name] = choice
        else:
            self._choices.pop(name, None)

    def within(self, given: Mapping[str, Any]) -> Variables:
        """The variables in a branch, or in a function with these arguments."""
        return Variables(given, self)

    def add(self, branch: Variables) -> None:
        """Assigns what a branch assigns that is executed."""
        for name, line in branch._lines.items():
            self.assign(name, branch._values[name], line, branch._choices.get(name))

    def add_one_of(self, first: Variables, last: Variables, line: int, effort: Effort) -> None:
        """Assigns what two branches assign of which one is executed.

        A variable has the value of the last branch that assigns it. It has several values if those
        of the branches differ, or if only one branch assigns it and it had another value before.

        Args:
            first: The variables in a branch.
            last: Those in the other one.
            line: Line of the condition.
            effort: What the comparison of values may cost.
        """
        effort.spend(len(first._lines) + len(last._lines))
        for name in dict.fromkeys((*first._lines, *last._lines)):
            used, other = (last, first) if name in last._lines else (first, last)
            places = Choice(other._line(name, line), used._lines[name])
            choice = used.choice(name) or other.choice(name)
            # A variable without another value is only used where the condition holds.
            if name in other and differ((other.get(name), used.get(name)), effort):
                choice = places
            self.assign(name, used.get(name), places.used, choice)

    def _holder(self, name: str) -> Variables | None:
        """The innermost variables with this name."""
        found: Variables | None = self
        while found is not None and name not in found._values:
            found = found._outside
        return found

    def _line(self, name: str, default: int) -> int:
        """The line in which a variable was assigned."""
        holder = self._holder(name)
        return default if holder is None else holder._lines.get(name, default)
