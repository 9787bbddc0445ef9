"""Runs scenarios, shows the progress, and writes the reports."""

from __future__ import annotations

import contextlib
import fnmatch
import json
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import cartwheel
from cartwheel.cli import interrupts
from cartwheel.cli.console import is_terminal, note, paint, printable, say
from cartwheel.cli.writing import writing
from cartwheel.codes.command import NO_CASES, OPTION_INVALID, OPTIONS_CONFLICT, USAGE
from cartwheel.codes.devices import PLUGIN_FILE_INVALID
from cartwheel.errors import CartwheelError, UnknownNameError
from cartwheel.jobs import cores
from cartwheel.scenarios import (
    Case,
    Options,
    Outcome,
    Results,
    Runner,
    Scenario,
    Workers,
    as_junit,
    as_page,
    cases_of,
    digests,
    find_scenarios,
    load_scenario,
    schema_text,
)

SCHEMA = 1
_KEPT = ("failures", "all", "none")
_REPORT = "report.html"
_INTERVAL = 10.0
"""Wall time between two lines about the progress, s."""
_MOST_LINES = 10
"""Maximum number of lines of a program's output for a case that failed."""
_MOST_NAMES = 5
"""Maximum number of ignored files whose names are shown."""
_MOST_SHOWN = 20
"""Maximum number of failed cases that are shown at the end."""


@dataclass(frozen=True, kw_only=True)
class Request:
    """The arguments of the command."""

    files: tuple[Path, ...]
    select: tuple[str, ...]
    seeds: int | None
    seed: int | None
    listed: bool
    resume: bool
    jobs: int | None
    fail_fast: bool
    timeout: float
    view: bool
    allow_launch: bool
    output: Path
    record: str
    pictures: str
    junit: Path | None
    json: bool
    package_path: tuple[Path, ...]
    plugins: tuple[Path, ...]


def print_schema() -> None:
    """Prints the JSON Schema of scenarios."""
    say(schema_text().rstrip())


def test(request: Request) -> int:
    """Runs the cases. Returns the exit status: 0 if all pass, else 1.

    Raises:
        CartwheelError: A scenario or an argument is invalid.
    """
    for option, value in (("--record", request.record), ("--pictures", request.pictures)):
        if value not in _KEPT:
            raise UnknownNameError(f"value of {option}", value, _KEPT, code=OPTION_INVALID)
    if not request.files:
        raise CartwheelError(
            "a scenario is missing", code=USAGE, hint="Pass a scenario file, or a folder with them."
        )
    for file in request.plugins:
        if not file.is_file():
            raise CartwheelError(
                f'the plugin file "{file}" does not exist',
                code=PLUGIN_FILE_INVALID,
                values={"path": str(file)},
            )
    scenarios = [load_scenario(file) for file in _found(request.files)]
    cases = _unique(_selected(request, scenarios))
    if request.listed:
        for case in cases:
            say(case.id)
        return 0
    if not cases:
        raise CartwheelError(
            "no case is selected", code=NO_CASES, hint="List all cases with --list."
        )
    if request.view:
        return _view(request, scenarios, cases)
    cases = _digested(request, scenarios, cases)
    results = Results(request.output, resume=request.resume)
    begun = time.monotonic()
    try:
        outcomes, interrupted = _run(request, scenarios, cases, results)
    finally:
        results.close()
    _write(request, outcomes, time.monotonic() - begun)
    _show(request, outcomes, len(cases))
    if interrupted:
        raise interrupts.Interrupted(interrupts.last_signal())
    return int(any(each.status != "passed" for each in outcomes))


def _found(files: Sequence[Path]) -> list[Path]:
    """The scenario files, sorted within each folder. Other YAML files in folders are reported.

    Raises:
        CartwheelError: A folder contains no scenario.
    """
    found: list[Path] = []
    for file in files:
        if not file.is_dir():
            found.append(file)
            continue
        inside, others = find_scenarios(file)
        if others:
            names = ", ".join(str(each) for each in others[:_MOST_NAMES])
            more = ", …" if len(others) > _MOST_NAMES else ""
            note(f"ignored files that are not scenarios: {names}{more}")
        if not inside:
            raise CartwheelError(
                f"{file} contains no scenario files",
                code=NO_CASES,
                hint='Scenario files end with .yaml, and contain the key "expect".',
                values={"path": str(file)},
            )
        found += inside
    return list(dict.fromkeys(found))


def _selected(request: Request, scenarios: Sequence[Scenario]) -> list[Case]:
    seeds = None
    if request.seed is not None or request.seeds is not None:
        first = request.seed or 0
        seeds = range(first, first + (request.seeds or 1))
    cases = [
        case
        for index, scenario in enumerate(scenarios)
        for case in cases_of(scenario, index, seeds=seeds)
    ]
    if not request.select:
        return cases
    return [
        case
        for case in cases
        if any(text in case.id or fnmatch.fnmatchcase(case.id, text) for text in request.select)
    ]


def _unique(cases: Sequence[Case]) -> list[Case]:
    """The cases with different names, for scenarios with equal names and repeated values."""
    seen: dict[str, int] = {}
    found = []
    for case in cases:
        number = seen[case.id] = seen.get(case.id, 0) + 1
        found.append(case if number == 1 else replace(case, id=f"{case.id}#{number}"))
    return found


def _digested(request: Request, scenarios: Sequence[Scenario], cases: Sequence[Case]) -> list[Case]:
    by_scenario: dict[int, list[Case]] = {}
    for case in cases:
        by_scenario.setdefault(case.scenario, []).append(case)
    return [
        case
        for index, each in by_scenario.items()
        for case in digests(scenarios[index], each, request.package_path, request.plugins)
    ]


def _options(request: Request) -> Options:
    return Options(
        folder=request.output,
        package_path=request.package_path,
        plugins=request.plugins,
        record=cast(Any, request.record),
        pictures=cast(Any, request.pictures),
        allow_launch=request.allow_launch,
        view=request.view,
    )


def _view(request: Request, scenarios: Sequence[Scenario], cases: Sequence[Case]) -> int:
    if len(cases) > 1:
        raise CartwheelError(
            f"--view requires a single case, but {len(cases)} are selected",
            code=OPTIONS_CONFLICT,
            hint="Select one with --select.",
            values={"cases": len(cases)},
        )
    outcome = Runner(scenarios, _options(request), announce=note).run(cases[0])
    _show(request, [outcome], 1)
    return int(outcome.status != "passed")


def _run(
    request: Request, scenarios: Sequence[Scenario], cases: Sequence[Case], results: Results
) -> tuple[list[Outcome], bool]:
    """The outcomes in the order of the cases, and whether a signal ended the run."""
    outcomes: dict[str, Outcome] = {}
    for case in cases:
        earlier = results.earlier.get(case.digest)
        if earlier is not None and earlier.status == "passed":
            outcomes[case.id] = earlier
    waiting = [case for case in cases if case.id not in outcomes]
    if outcomes:
        note(f"{len(outcomes)} cases passed in an earlier run")
    count = request.jobs or cores()
    workers = Workers(scenarios, _options(request), min(count, len(waiting)), request.timeout)
    with _progress(len(waiting)) as bar, interrupts.handled_by(workers.stop):
        try:
            for outcome in workers.run(waiting):
                results.add(outcome)
                outcomes[outcome.id] = outcome
                bar.done(outcome)
                if request.fail_fast and outcome.status != "passed":
                    break
        finally:
            workers.close()
    return [outcomes[case.id] for case in cases if case.id in outcomes], workers.stopped


def _write(request: Request, outcomes: Sequence[Outcome], wall: float) -> None:
    folder = request.output
    texts = {
        folder / _REPORT: as_page(outcomes, folder, wall=wall),
        folder / "junit.xml": as_junit(outcomes),
        folder / "results.json": json.dumps(_as_mapping(outcomes), indent=1, default=str),
    }
    if request.junit is not None:
        texts[request.junit] = texts[folder / "junit.xml"]
    for path, text in texts.items():
        with writing(path):
            path.write_text(text, encoding="utf-8", errors="replace")


def _as_mapping(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    statuses = [each.status for each in outcomes]
    return {
        "schema": SCHEMA,
        "version": cartwheel.__version__,
        "summary": {name: statuses.count(name) for name in ("passed", "failed", "error")},
        "cases": [each.as_mapping() for each in outcomes],
    }


def _show(request: Request, outcomes: Sequence[Outcome], count: int) -> None:
    if request.json:
        say(json.dumps(_as_mapping(outcomes), indent=2, default=str))
        return
    failed = [each for each in outcomes if each.status != "passed"]
    for outcome in failed[:_MOST_SHOWN]:
        say(paint(outcome.id, "bold", "red"))
        for finding in outcome.findings:
            say(finding.text)
        if outcome.late:
            say(f"  lockstep: {outcome.late} periods without a message in time")
        if outcome.output:
            say("\n    ".join(["  output of the program:", *_last_lines(outcome.output)]))
        for name, file in (("recording", outcome.recording), ("picture", outcome.picture)):
            if file:
                say(f"  {name}: {request.output / file}")
        say()
    if len(failed) > _MOST_SHOWN:
        say(f"and {len(failed) - _MOST_SHOWN} more failed cases")
    missing = count - len(outcomes)
    errors = sum(each.status == "error" for each in failed)
    parts = [f"{len(outcomes) - len(failed)} passed"]
    parts += [f"{len(failed) - errors} failed"] if len(failed) > errors else []
    parts += [f"{errors} error{'s' if errors > 1 else ''}"] if errors else []
    parts += [f"{missing} not run"] if missing else []
    say(paint(", ".join(parts), "red" if failed else "green"))
    if not request.view:
        note(f"report: {request.output / _REPORT}")
    sys.stdout.flush()


def _last_lines(output: str) -> list[str]:
    """The end of a program's output, for a terminal."""
    lines = output.rstrip().splitlines()
    return lines if len(lines) <= _MOST_LINES else ["…", *lines[-_MOST_LINES:]]


class _Lines:
    """A line for each case that failed, and one every few seconds."""

    def __init__(self, total: int) -> None:
        self._total, self._count, self._failed = total, 0, 0
        self._due = time.monotonic() + _INTERVAL

    def done(self, outcome: Outcome) -> None:
        self._count += 1
        if outcome.status != "passed":
            self._failed += 1
            note(f"{outcome.status}: {outcome.id}")
        if time.monotonic() >= self._due:
            self._due = time.monotonic() + _INTERVAL
            note(f"{self._count} of {self._total} cases, {self._failed} failed")


class _Bar:
    """A bar with the number of cases and the remaining time."""

    def __init__(self, bar: Any, total: int) -> None:
        self._bar, self._failed = bar, 0
        self._task = bar.add_task("cases", total=total, failed="")

    def done(self, outcome: Outcome) -> None:
        if outcome.status != "passed":
            self._failed += 1
            self._bar.console.print(
                printable(f"{outcome.status}: {outcome.id}"), markup=False, highlight=False
            )
        failed = f"{self._failed} failed" if self._failed else ""
        self._bar.update(self._task, advance=1, failed=failed)


@contextlib.contextmanager
def _progress(total: int) -> Iterator[_Lines | _Bar]:
    """Shows the progress on stderr within the block."""
    if not is_terminal(sys.stderr):
        yield _Lines(total)
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as RichProgress

    columns = (
        BarColumn(bar_width=None),
        MofNCompleteColumn(),
        TextColumn("[red]{task.fields[failed]}"),
        TimeRemainingColumn(),
    )
    with RichProgress(*columns, console=Console(stderr=True), transient=True) as bar:
        yield _Bar(bar, total)
