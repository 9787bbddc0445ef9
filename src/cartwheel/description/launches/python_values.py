"""The values of expressions in launch files in Python, and their texts."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import Any

from cartwheel import yaml_text
from cartwheel.description.launches.effort import LONGEST, UNKNOWN, Effort


class Unknown:
    """A value that cannot be determined."""


class Description:
    """The text that xacro produces from a file.

    Args:
        number: Its number in `Facts.descriptions`.
    """

    def __init__(self, number: int | None) -> None:
        self.number = number


class Configuration:
    """The configuration of a robot that the builder of moveit_configs_utils makes.

    Args:
        name: The robot.
        folder: The package of the configuration.
    """

    def __init__(self, name: str, folder: str) -> None:
        self.name = name
        self.folder = folder
        self.description: Description | None = None
        """None if it was not read yet."""


class Changed:
    """The path of a file whose text a launch file changes, which is made when it is used.

    Args:
        make: Returns the path.
        source: The path of the file itself.
    """

    def __init__(self, make: Callable[[], str], source: Any) -> None:
        self._make = make
        self.source = source

    @cached_property
    def path(self) -> str:
        """The path of the changed file."""
        return self._make()


NOTHING = Unknown()
_JOINING = 1000
"""Steps to join a list, which may be long."""
_LARGEST = 1e9
_NUMBERS: Mapping[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
}


def text(value: Any) -> str:
    """A value as text; `UNKNOWN` for an unknown one."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool) or _is_number(value):
        return str(value)
    if isinstance(value, list):
        return joined(value)
    return value.path if isinstance(value, Changed) else UNKNOWN


def joined(value: Any) -> str:
    """The text of substitutions, which launch concatenates; `UNKNOWN` if it is too long."""
    return _short(text(each) for each in _flat([value]))


def _flat(values: Iterable[Any]) -> Iterator[Any]:
    """The values in nested lists, of which one may contain itself; only the first `LONGEST`."""
    left = [iter(values)]
    looked = 0
    while left and looked < LONGEST:
        looked += 1
        value = next(left[-1], None)
        if value is None:
            left.pop()
        elif isinstance(value, list):
            left.append(iter(value))
        else:
            yield value


def _short(parts: Iterable[str]) -> str:
    """The parts as one text; `UNKNOWN` if it is too long, as texts that grow in loops are."""
    length, found = 0, []
    for each in parts:
        length += len(each)
        if length > LONGEST:
            return UNKNOWN
        found.append(each)
    return "".join(found)


def concatenated(parts: Iterable[Any]) -> str:
    """A text made of values; unknown if it is too long."""
    return _short(text(each) for each in parts)


def path_of(parts: Iterable[Any]) -> str:
    """The path that consists of values, of which one may be a list of substitutions, as in
    ``[folder, [name, ".xacro"]]``; unknown if it is too long.
    """
    steps: list[str] = []
    length = 0
    for part in parts:
        for step in part if isinstance(part, list) else [part]:
            steps.append(joined(step))
            length += 1 + len(steps[-1])
            if length > LONGEST:
                return UNKNOWN
    return str(PurePosixPath(*steps))


def combined(sign: ast.operator, left: Any, right: Any) -> Any:
    """The value of a binary operation on paths, texts, lists or numbers."""
    if isinstance(sign, ast.Div):
        return path_of((text(left), text(right)))
    if type(sign) in _NUMBERS and _is_number(left) and _is_number(right):
        return _NUMBERS[type(sign)](left, right)
    if isinstance(sign, ast.Add):
        if isinstance(left, list) and isinstance(right, list):
            return left + right if len(left) + len(right) <= LONGEST else NOTHING
        return concatenated((left, right))
    return NOTHING


def _is_number(value: Any) -> bool:
    """Whether it is a number, and not so large that computing with it takes time."""
    return type(value) in (int, float) and abs(value) < _LARGEST


def items(kind: str, values: list[Any]) -> list[Any] | None:
    """The values over which a loop runs.

    Args:
        kind: The function or method that is called on the values; empty without one.
        values: Its arguments; the object of a method is the first.

    Returns:
        The values; None if they are unknown.
    """
    first: Any = values[0] if values else NOTHING
    if isinstance(first, dict):
        pairs = [[key, value] for key, value in first.items()]
        column = {"": 0, "keys": 0, "list": 0, "sorted": 0, "values": 1}.get(kind)
        if column is not None:
            return [pair[column] for pair in pairs]
        return pairs if kind == "items" else None
    if kind == "range" and all(type(each) is int and abs(each) <= LONGEST for each in values):
        return list(range(*values)) if 1 <= len(values) <= 2 else None
    if kind == "enumerate" and isinstance(first, list):
        begin = values[1] if len(values) > 1 and type(values[1]) is int else 0
        return [[index, each] for index, each in enumerate(first, begin)]
    if not values or not all(isinstance(each, list) for each in values):
        return None
    if kind == "zip":
        return [list(each) for each in zip(*values, strict=False)]
    if kind == "reversed":
        return list(reversed(first))
    return list(first) if kind in ("", "list", "tuple", "sorted", "set") else None


def loaded(path: str, effort: Effort) -> Any:
    """The contents of a YAML file; `NOTHING` if it cannot be read."""
    import yaml

    try:
        content = yaml_text.read(Path(path))
        effort.load(content)
        return yaml_text.load(content)
    except (OSError, ValueError, yaml.YAMLError):
        return NOTHING


def differ(values: Iterable[Any], effort: Effort) -> bool:
    """Whether a value is known and another one is not equal to it."""
    found: set[tuple[bool, Any]] = set()
    for value in values:
        effort.spend(_JOINING if isinstance(value, list) else 1)
        described = isinstance(value, Description)
        found.add((described, value.number if described else joined(value).strip(UNKNOWN)))
        if len(found) > 1:
            return True
    return False


def is_known(*values: Any) -> bool:
    """Whether values are texts that are completely known."""
    return all(isinstance(each, str) and UNKNOWN not in each for each in values)
