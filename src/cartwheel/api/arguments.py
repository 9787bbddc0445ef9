"""Checks of the arguments of a program, so that a wrong one is named in the error."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np

from cartwheel.codes.command import OPTION_INVALID
from cartwheel.codes.files import ARGUMENT_UNKNOWN, INCLUDE_ABSENT
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.errors import CartwheelError, Code, DescriptionError, Diagnostic
from cartwheel.graph.renaming import Bridged

T = TypeVar("T", bound=str | Path)


def several(values: T | Sequence[T], name: str) -> list[T]:
    """The items of a sequence. A single text or path is one item, not a sequence of characters.

    Raises:
        CartwheelError: It contains something else.
    """
    if isinstance(values, str | Path):
        return [values]
    if isinstance(values, bytes | Mapping) or not isinstance(values, Collection):
        raise refused(name, "a text or a path, or a sequence of them", values)
    for value in values:
        if not isinstance(value, str | Path):
            raise refused(name, "a text or a path, or a sequence of them", value)
    return list(values)


def paths(values: str | Path | Sequence[str | Path], name: str) -> list[Path]:
    """The paths of a sequence, or a single one.

    Raises:
        CartwheelError: It contains something else.
    """
    return [Path(value) for value in several(values, name)]


def bridges(values: str | Path | Sequence[str | Path | Bridged]) -> list[Path | Bridged]:
    """The configuration files of ros_gz_bridge, and the entries that a launch file states.

    Raises:
        CartwheelError: It contains something else.
    """
    if isinstance(values, list | tuple):
        stated = [each for each in values if isinstance(each, Bridged)]
        return [
            *paths([each for each in values if not isinstance(each, Bridged)], "bridge"),
            *stated,
        ]
    return [*paths(values, "bridge")]  # type: ignore[arg-type]


def text(value: object, name: str) -> str:
    """A text.

    Raises:
        CartwheelError: It is not a text.
    """
    if not isinstance(value, str):
        raise refused(name, "a text", value)
    return value


def xacro_arguments(values: object) -> dict[str, str] | None:
    """The arguments of a xacro file as texts; None if none are given.

    Raises:
        CartwheelError: They are not a mapping of texts, numbers and booleans.
    """
    if values is None:
        return None
    if not isinstance(values, Mapping):
        raise refused("arguments", "a mapping", values)
    return {text(name, "the name of an argument"): _written(name, values[name]) for name in values}


def check_xacro_arguments(robot: RobotDescription, ignored: Collection[Code] = ()) -> None:
    """Refuses arguments that the description does not declare.

    If an included file is missing, it might declare them, and they are only reported.

    Args:
        robot: The description, which was read with the arguments.
        ignored: Codes that are no errors.

    Raises:
        DescriptionError: It does not declare one of them.
    """
    if any(each.code is INCLUDE_ABSENT for each in robot.diagnostics):
        return
    refuse_unknown_arguments(robot.diagnostics, ignored)


def refuse_unknown_arguments(
    diagnostics: Iterable[Diagnostic], ignored: Collection[Code] = ()
) -> None:
    """Raises the first diagnostic of an argument that a file does not declare.

    Raises:
        DescriptionError: There is one.
    """
    for each in diagnostics:
        if each.code is ARGUMENT_UNKNOWN and each.code not in ignored:
            raise DescriptionError(
                each.message, code=each.code, origin=each.origin, hint=each.hint,
                values=each.values,
            )  # fmt: skip


def _written(name: str, value: object) -> str:
    if isinstance(value, bool | np.bool_):
        return str(bool(value)).lower()
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, str | int | float | Path):
        return str(value)
    raise refused(f'the argument "{name}"', "a text, a number, True or False", value)


def source(value: object, name: str) -> None:
    """Checks the file, text or description of a world or robot.

    Raises:
        CartwheelError: It is none of them.
    """
    if not isinstance(value, str | Path | RobotDescription | WorldDescription):
        raise refused(name, "a name, a path, XML or a description", value)


def refused(name: str, wanted: str, value: object) -> CartwheelError:
    """The error for an argument of a wrong kind."""
    shown = f"{value!r:.60}"
    return CartwheelError(
        f"{name} must be {wanted} (got {shown})",
        code=OPTION_INVALID,
        values={"name": name, "value": shown},
    )
