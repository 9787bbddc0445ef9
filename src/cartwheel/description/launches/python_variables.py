"""The variables of launch files in Python, of which some may have several values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from cartwheel.description.launches.effort import Effort
from cartwheel.description.launches.python_values import NOTHING, differ


@dataclass(frozen=True, kw_only=True, slots=True)
class Uncertain:
    """A function or variable that has one of several values, depending on an unknown condition."""

    what: Literal["return", "variable"]
    used: int
    """The line of the value that is used."""


class _Assigned(NamedTuple):
    number: int
    """Counts the assignments."""
    line: int


class Choice(NamedTuple):
    """A variable that has one of two values, depending on an unknown condition."""

    other: int
    """Line of the value that is not used."""
    used: int


class Variables:
    """The variables that are known at a place in a launch file, by name.

    Args:
        values: Those that are known from the beginning.
    """

    def __init__(self, values: Mapping[str, Any]) -> None:
        self._values = dict(values)
        self._assigned: dict[str, _Assigned] = {}
        self._choices: dict[str, Choice] = {}

    def __len__(self) -> int:
        return len(self._values)

    def __contains__(self, name: str) -> bool:
        return name in self._values

    def get(self, name: str, default: Any = NOTHING) -> Any:
        """The value of a variable."""
        return self._values.get(name, default)

    def choice(self, name: str) -> Choice | None:
        """Where a variable gets its values if it may have several; None if it has one."""
        return self._choices.get(name)

    def assign(self, name: str, value: Any, line: int) -> None:
        """Assigns a value in a line."""
        self._values[name] = value
        last = self._assigned.get(name)
        self._assigned[name] = _Assigned(0 if last is None else last.number + 1, line)
        self._choices.pop(name, None)

    def copy(self) -> Variables:
        """The same variables, which change independently."""
        return self.within({})

    def within(self, given: Mapping[str, Any]) -> Variables:
        """The variables in a function with these arguments."""
        inner = Variables({**self._values, **given})
        inner._assigned = {k: each for k, each in self._assigned.items() if k not in given}
        inner._choices = {k: each for k, each in self._choices.items() if k not in given}
        return inner

    def merge(self, before: Variables, first: Variables, line: int, effort: Effort) -> None:
        """Adds what another branch assigns to the variables after the last branch.

        A variable has the value of the last branch that assigns it. It has several values if those
        of the branches differ, or if only one branch assigns it and it had another value before.

        Args:
            before: The variables before the branches.
            first: Those after the other branch.
            line: Line of the condition.
            effort: What the comparison of values may cost.
        """
        effort.spend(len(self._assigned) + len(first._assigned))
        for name in dict.fromkeys((*first._assigned, *self._assigned)):
            old = before._assigned.get(name)
            one, two = first._assigned.get(name), self._assigned.get(name)
            if one == two == old:
                continue
            values = [each._values[name] for each in (first, self) if name in each._values]
            places = [line if each is None else each.line for each in (one, two)]
            if two == old:
                self._values[name] = first._values[name]
                self._assigned[name] = first._assigned[name]
                places.reverse()
            choice = first._choices.get(name) or self._choices.get(name)
            # A variable without another value is only used where the condition holds.
            if len(values) > 1 and differ(values, effort):
                choice = Choice(*places)
            if choice is not None:
                self._choices[name] = choice
