"""Accepted findings of a project, so that only new findings are reported.

An entry consists of a file, a code and the names in the finding, with a count. It contains no line
numbers, so unrelated changes to the file have no effect.
"""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from cartwheel.codes import command
from cartwheel.description.files.regular_files import read_regular_text
from cartwheel.errors import CartwheelError, Diagnostic, Origin

_MAX_BYTES = 50_000_000
_SCHEMA = 1
_Key = tuple[str, str, str]


class Baseline:
    """The accepted findings with their counts.

    Args:
        counts: By file, code and names.
        folder: Folder of the baseline file; files of findings are relative to it.
    """

    def __init__(self, counts: Counter[_Key], folder: Path) -> None:
        self._left = Counter(counts)
        self._folder = folder

    @classmethod
    def read(cls, file: Path) -> Baseline:
        """Reads a baseline file.

        Raises:
            CartwheelError: The file cannot be read, or is not a baseline.
        """
        try:
            content: Any = json.loads(read_regular_text(file, _MAX_BYTES))
            if content["schema"] != _SCHEMA:
                raise ValueError(f"schema {content['schema']} is not supported")
            counts = Counter[_Key]()
            for entry in content["findings"]:
                names = json.dumps(entry["names"])
                counts[str(entry["file"]), str(entry["code"]), names] += int(entry["count"])
        except (OSError, ValueError, KeyError, TypeError, OverflowError, RecursionError) as error:
            raise CartwheelError(
                f"the baseline cannot be read: {error}",
                code=command.BASELINE_INVALID,
                origin=Origin(file=str(file)),
                hint="Write a new baseline with --write-baseline.",
            ) from error
        return cls(counts, file.absolute().parent)

    def accepts(self, finding: Diagnostic) -> bool:
        """Whether a finding is in the baseline; an entry accepts as many findings as its count."""
        key = _key(finding, self._folder)
        if self._left[key] <= 0:
            return False
        self._left[key] -= 1
        return True


def write(file: Path, findings: Iterable[Diagnostic]) -> int:
    """Writes a baseline that accepts these findings; returns their number."""
    folder = file.absolute().parent
    counts = Counter(_key(each, folder) for each in findings)
    entries = [
        {"file": name, "code": code, "names": json.loads(names), "count": count}
        for (name, code, names), count in sorted(counts.items())
    ]
    text = json.dumps({"schema": _SCHEMA, "findings": entries}, indent=1)
    file.write_text(text + "\n", encoding="utf-8")
    return counts.total()


def _key(finding: Diagnostic, folder: Path) -> _Key:
    name = ""
    if finding.origin is not None:
        name = Path(os.path.relpath(Path(finding.origin.file).absolute(), folder)).as_posix()
    # Numbers are omitted, because they may change while the fault remains.
    names = [[key, value] for key, value in finding.values.items() if isinstance(value, str)]
    return (name, finding.code.number, json.dumps(sorted(names)))
