"""The results file: one line of JSON for each case, so that an interrupted run can be resumed."""

from __future__ import annotations

import json
from pathlib import Path

from cartwheel.codes.command import OUTPUT_NOT_WRITTEN, RESULTS_INVALID
from cartwheel.errors import CartwheelError, Origin
from cartwheel.scenarios.outcome import Outcome

FILE = "results.jsonl"
SCHEMA = 1
_MOST_BYTES = 1 << 30


class Results:
    """The results of a run in a folder.

    Args:
        folder: The folder.
        resume: Whether to keep the results of an earlier run.

    Raises:
        CartwheelError: The folder cannot be written, or earlier results cannot be read.
    """

    def __init__(self, folder: Path, *, resume: bool) -> None:
        self.path = folder / FILE
        self.earlier: dict[str, Outcome] = {}
        """Earlier outcomes by the digest of the case."""
        try:
            folder.mkdir(parents=True, exist_ok=True)
            if resume and self.path.exists():
                self._read()
            self._file = self.path.open("a" if resume else "w", encoding="utf-8")
        except OSError as error:
            raise CartwheelError(
                f"{self.path} cannot be written: {error.strerror}",
                code=OUTPUT_NOT_WRITTEN,
                values={"path": str(self.path)},
            ) from None

    def _read(self) -> None:
        if self.path.stat().st_size > _MOST_BYTES:
            raise self._invalid(0, "it is too large")
        text = self.path.read_text(encoding="utf-8", errors="replace")
        complete = text.endswith("\n") or not text
        lines = text.splitlines()
        good = 0
        for number, line in enumerate(lines, start=1):
            try:
                data = json.loads(line)
                if data.pop("schema", None) != SCHEMA:
                    raise self._invalid(number, "another version of Cartwheel wrote it")
                outcome = Outcome.from_mapping(data)
            except (ValueError, TypeError, KeyError, AttributeError):
                if number == len(lines) and not complete:
                    break  # the run was interrupted while it wrote this line
                raise self._invalid(number, "the line is not a result") from None
            self.earlier[outcome.digest] = outcome
            good += 1
        if not complete:
            # The next line must not be appended to a part of a line.
            self.path.write_text("".join(f"{line}\n" for line in lines[:good]), encoding="utf-8")

    def _invalid(self, line: int, reason: str) -> CartwheelError:
        return CartwheelError(
            f"the results of the earlier run cannot be read: {reason}",
            code=RESULTS_INVALID,
            origin=Origin(file=str(self.path), line=line),
            hint="Run again without --resume.",
            values={"path": str(self.path)},
        )

    def add(self, outcome: Outcome) -> None:
        """Adds an outcome."""
        data = {"schema": SCHEMA, **outcome.as_mapping()}
        self._file.write(json.dumps(data, default=str, allow_nan=True) + "\n")
        self._file.flush()

    def close(self) -> None:
        """Closes the file."""
        self._file.close()
