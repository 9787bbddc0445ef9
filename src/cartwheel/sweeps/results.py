"""The results of a sweep."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, overload

import numpy as np

from cartwheel.codes.wires import PACKAGE_MISSING
from cartwheel.codes.world import SWEEP_INVALID
from cartwheel.errors import CartwheelError
from cartwheel.similar_names import suggestion


@dataclass(frozen=True, kw_only=True)
class Row:
    """The result of a case."""

    case: Mapping[str, Any]
    """The parameters."""
    values: Mapping[str, Any]
    """What the function returned; empty after an error."""
    error: str = ""
    """Why the case has no values."""
    seconds: float = 0.0
    """Wall time, s."""

    def flat(self) -> dict[str, Any]:
        """Parameters, values and the error by name, as a line of a table."""
        return {**self.case, **self.values, "error": self.error}


class Results(Sequence[Row]):
    """The results of all cases, in their order."""

    def __init__(self, rows: Sequence[Row]) -> None:
        self._rows = tuple(rows)

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, index: int) -> Row: ...
    @overload
    def __getitem__(self, index: slice) -> Results: ...
    def __getitem__(self, index: int | slice) -> Row | Results:
        found = self._rows[index]
        return Results(found) if isinstance(found, tuple) else found

    def __iter__(self) -> Iterator[Row]:
        return iter(self._rows)

    def __repr__(self) -> str:
        return f"<Results of {len(self)} cases, {len(self.failed)} failed>"

    @property
    def failed(self) -> Results:
        """The cases with an error."""
        return Results([row for row in self._rows if row.error])

    def column(self, name: str) -> np.ndarray[Any, Any]:
        """A parameter or value of all cases, NaN where it is missing, shape (n,).

        Raises:
            CartwheelError: No case has it, although not all of them have failed.
        """
        lines = [row.flat() for row in self._rows]
        names = dict.fromkeys(each for line in lines for each in line)
        if name not in names and len(self.failed) < len(self):
            raise CartwheelError(
                f'no case has a parameter or value named "{name}"',
                code=SWEEP_INVALID,
                hint=suggestion(name, list(names)),
                values={"name": name},
            )
        return np.array([line.get(name, np.nan) for line in lines])

    def columns(self) -> dict[str, list[Any]]:
        """The table by columns; None where a value is missing."""
        lines = [row.flat() for row in self._rows]
        names = dict.fromkeys(name for line in lines for name in line)
        return {name: [line.get(name) for line in lines] for name in names}

    def to_pandas(self) -> Any:
        """The table as a ``pandas.DataFrame``.

        Raises:
            CartwheelError: pandas is not installed.
        """
        try:
            import pandas
        except ImportError as error:
            raise _missing("pandas", error) from None
        return pandas.DataFrame(self.columns())

    def to_arrow(self) -> Any:
        """The table as a ``pyarrow.Table``.

        Raises:
            CartwheelError: pyarrow is not installed, or a column contains values of several kinds.
        """
        try:
            import pyarrow
        except ImportError as error:
            raise _missing("pyarrow", error) from None
        arrays: dict[str, Any] = {}
        for name, values in self.columns().items():
            try:
                arrays[name] = pyarrow.array(values)
            except (pyarrow.ArrowInvalid, pyarrow.ArrowTypeError) as error:
                raise invalid(f'the column "{name}" cannot be one of Arrow: {error}') from None
        return pyarrow.table(arrays)


def plain(value: Any) -> Any:
    """A number, text, list or mapping as JSON stores it.

    Raises:
        CartwheelError: It is something else.
    """
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Mapping):
        return {str(name): plain(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    raise invalid(
        f"cases and results must consist of numbers, texts, lists and mappings (got a "
        f"{type(value).__name__})"
    )


def _missing(package: str, error: ImportError) -> CartwheelError:
    return CartwheelError(
        f"this table requires the package {package}: {error}",
        code=PACKAGE_MISSING,
        hint=f"Install it with: pip install {package}",
        values={"package": package},
    )


def invalid(message: str) -> CartwheelError:
    """The error of an invalid argument."""
    return CartwheelError(message, code=SWEEP_INVALID)
