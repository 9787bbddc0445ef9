"""The file with the results of a sweep: a line of JSON for each case that is done."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from cartwheel.codes.command import OUTPUT_NOT_WRITTEN, RESULTS_INVALID
from cartwheel.errors import CartwheelError, Origin
from cartwheel.sweeps.results import Row

_SCHEMA = 1
_MOST_BYTES = 1 << 30


class Stored:
    """Results that are read when a sweep is continued.

    Args:
        path: The file; None stores nothing.
        function: Name of the function, which must be that of an earlier sweep.

    Raises:
        CartwheelError: The file cannot be read or written, or is not that of this sweep.
    """

    def __init__(self, path: Path | None, function: str) -> None:
        self._path, self._function = path, function
        self._earlier: dict[str, list[Row]] = {}
        self._file: Any = None
        if path is None:
            return
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            kept = self._read(path) if path.exists() and path.stat().st_size else []
            if not kept:
                kept = [json.dumps({"schema": _SCHEMA, "function": function})]
            # The last line of an interrupted sweep may be incomplete.
            new = path.with_name(f"{path.name}.new")
            new.write_text("".join(f"{line}\n" for line in kept), encoding="utf-8")
            new.replace(path)
            self._file = path.open("a", encoding="utf-8")
        except OSError as error:
            raise CartwheelError(
                f"{path} cannot be used: {error.strerror}", code=OUTPUT_NOT_WRITTEN,
                values={"path": str(path)},
            ) from None  # fmt: skip

    def _read(self, path: Path) -> list[str]:
        """The complete lines, which are also stored."""
        if path.stat().st_size > _MOST_BYTES:
            raise self._invalid(1, "it is too large")
        text = path.read_text("utf-8", "replace")
        lines = text.splitlines()
        if not text.endswith("\n"):
            lines.pop()
        for number, line in enumerate(lines, start=1):
            try:
                data = json.loads(line)
                if number == 1:
                    about = (data["schema"], data["function"])
                else:
                    row = Row(**data)
                    self._earlier.setdefault(key_of(row.case), []).append(row)
            except (ValueError, TypeError, KeyError, AttributeError):
                raise self._invalid(number, "the line is not a result") from None
            if about != (_SCHEMA, self._function):
                raise self._invalid(1, f"it is that of another sweep, {about[1]}")
        return lines

    def _invalid(self, line: int, reason: str) -> CartwheelError:
        return CartwheelError(
            f"the results of the earlier sweep cannot be read: {reason}",
            code=RESULTS_INVALID,
            origin=Origin(file=str(self._path), line=line),
            hint="Delete the file, or name another one.",
            values={"path": str(self._path)},
        )

    def earlier(self, cases: Sequence[Mapping[str, Any]]) -> dict[int, Row]:
        """The earlier results without an error, by the index of the case."""
        found: dict[int, Row] = {}
        used: Counter[str] = Counter()
        for index, case in enumerate(cases):
            key = key_of(case)
            good = [row for row in self._earlier.get(key, ()) if not row.error]
            if used[key] < len(good):
                found[index] = good[used[key]]
                used[key] += 1
        return found

    def add(self, row: Row) -> None:
        """Adds a result."""
        if self._file is not None:
            data = {
                "case": row.case, "values": row.values, "error": row.error, "seconds": row.seconds,
            }  # fmt: skip
            self._file.write(json.dumps(data) + "\n")
            self._file.flush()

    def close(self) -> None:
        """Closes the file."""
        if self._file is not None:
            self._file.close()


def key_of(case: Mapping[str, Any]) -> str:
    """A text that is equal for equal cases."""
    return json.dumps(case, sort_keys=True)
