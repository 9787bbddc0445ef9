"""How many faults ``cartwheel check`` finds, and how many of its findings are faults."""

from __future__ import annotations

import os
import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.checks.seeded import ROBOT, seeded_faults

from benchmarks import mutations, mutations_of_sdf, mutations_of_xacro
from benchmarks.figure import Effort, Figure
from benchmarks.mutations import Mutation
from cartwheel.checks.project.run import check
from cartwheel.codes import code_named
from cartwheel.corpus.finding import robots_in
from cartwheel.description.convert import to_urdf
from cartwheel.description.files.named_files import shipped_descriptions
from cartwheel.description.files.package_folders import share
from cartwheel.errors import Code, DescriptionError, Diagnostic

KINDS = {"URDF": mutations, "SDF": mutations_of_sdf, "xacro": mutations_of_xacro}
"""The kinds of documents that are mutated."""
SITES = 5
"""Of one mutation in one robot."""
_ROOT = Path(__file__).parents[1]
_CART = "robots/rosbots_description/urdf/rosbots.xacro"


@dataclass(frozen=True, kw_only=True, slots=True)
class Trial:
    """One changed document, and the codes that a check newly reports in it."""

    name: str
    expected: str
    """The name of a code; empty if the change is no fault."""
    allowed: frozenset[str]
    """Names of codes of true findings, the expected one included."""
    new: Counter[str]
    """Names of codes, with the number of findings."""

    @property
    def is_found(self) -> bool:
        """Whether the expected code is reported."""
        return self.expected in self.new


def figures(effort: Effort) -> Iterator[Figure]:
    """Recall and precision, by code and in all; findings in clean robots."""
    with tempfile.TemporaryDirectory() as folder:
        room = Path(folder)
        seeded = _seeded(room, effort.every)
        of_kind = {
            kind: _mutated(room, module.FAULTS, bases(kind), effort.every)
            for kind, module in KINDS.items()
        }
        harmless = [
            trial
            for kind, module in KINDS.items()
            for trial in _mutated(room, module.HARMLESS, bases(kind), effort.every)
        ]
    mutated = [trial for trials in of_kind.values() for trial in trials]
    faults = [*seeded, *mutated]
    yield from _by_code(faults, mutated)
    yield _recall("documents of the tests", seeded)
    for kind, trials in of_kind.items():
        yield _recall(f"mutations of {kind}", trials)
    yield _recall("all", faults)
    for kind, trials in of_kind.items():
        yield _precision(f"mutations of {kind}", trials)
    alarms = [trial for trial in harmless if trial.new]
    yield Figure(
        group="check: all",
        name="harmless edits with a finding",
        value=len(alarms),
        unit=f"of {len(harmless)}",
        note=_listed(f"{each.name}: {', '.join(each.new)}" for each in alarms),
    )
    yield from _clean(effort.every)


def _seeded(room: Path, every: int) -> list[Trial]:
    """The documents of the tests. The robot that they change is clean, or their text is short."""
    trials = []
    for fault in list(seeded_faults())[::every]:
        controllers = []
        if fault.controllers:
            controllers = [room / "controllers.yaml"]
            controllers[0].write_text(fault.controllers)
        new = _counted(_findings(room, fault.text, fault.file, controllers))
        allowed = frozenset({fault.code})
        trials.append(Trial(name=fault.name, expected=fault.code, allowed=allowed, new=new))
    return trials


def _mutated(
    room: Path, kinds: Sequence[Mutation], robots: Mapping[str, str], every: int
) -> list[Trial]:
    """The mutations of some documents, by the names of their files."""
    usual = {name: _counted(_findings(room, text, name)) for name, text in robots.items()}
    documents = [
        (kind, name, document)
        for kind in kinds
        for name, text in robots.items()
        for document in mutations.documents(text, kind, SITES)
    ]
    trials = []
    for kind, name, document in documents[::every]:
        new = _counted(_findings(room, document, name)) - usual[name]
        allowed = frozenset({kind.code, *kind.follows} - {""})
        trials.append(Trial(name=kind.name, expected=kind.code, allowed=allowed, new=new))
    return trials


def bases(kind: str) -> dict[str, str]:
    """The documents of a kind that are mutated, by the names of their files.

    As URDF, these are the cart, and the tests' robot with an arm.
    """
    if kind == "URDF":
        return {"cart.urdf": to_urdf(share() / _CART, absolute=True), "tester.urdf": ROBOT}
    name = {"SDF": "rover.world", "xacro": "rover.xacro"}[kind]
    return {name: (Path(__file__).parent / "bases" / name).read_text()}


def _findings(
    room: Path, text: str, file: str = "robot.urdf", controllers: Sequence[Path] = ()
) -> Sequence[Diagnostic]:
    """What a check reports of a text; an error that ends it is a finding, too."""
    path = room / file
    path.write_text(text)
    try:
        return check(path, controllers=controllers, settings=False).findings
    except DescriptionError as error:
        return (error.diagnostic(),)


def _counted(findings: Iterable[Diagnostic]) -> Counter[str]:
    return Counter(finding.code.name for finding in findings)


def _by_code(faults: Sequence[Trial], mutated: Sequence[Trial]) -> Iterator[Figure]:
    by_code: dict[Code, list[Trial]] = defaultdict(list)
    for trial in faults:
        by_code[code_named(trial.expected)].append(trial)
    for code, trials in sorted(by_code.items(), key=lambda item: item[0].number):
        missed = Counter(trial.name for trial in trials if not trial.is_found)
        true = sum(trial.new[code.name] for trial in mutated if code.name in trial.allowed)
        wrong = Counter(
            trial.name for trial in mutated if code.name in trial.new.keys() - trial.allowed
        )
        notes = [f"precision {100 * true / (true + wrong.total()):.0f} %"] if wrong else []
        notes += [f"missed: {_listed(missed)}"] if missed else []
        notes += [f"wrong: {_listed(wrong)}"] if wrong else []
        yield Figure(
            group="check: recall by code",
            name=f"{code.number} {code.name}",
            value=100 * sum(trial.is_found for trial in trials) / len(trials),
            unit=f"% of {len(trials)}",
            note="; ".join(notes),
        )


def _recall(name: str, trials: Sequence[Trial]) -> Figure:
    count = sum(trial.is_found for trial in trials)
    return Figure(
        group="check: all",
        name=f"recall, {name}",
        value=100 * count / max(len(trials), 1),
        unit=f"% of {len(trials)} faults",
    )


def _precision(name: str, trials: Sequence[Trial]) -> Figure:
    """The share of the findings beyond those of the unchanged robot that are true."""
    total = sum(trial.new.total() for trial in trials)
    wrong: Counter[str] = Counter()
    for trial in trials:
        for code in trial.new.keys() - trial.allowed:
            wrong[code] += trial.new[code]
    return Figure(
        group="check: all",
        name=f"precision, {name}",
        value=100 * (total - wrong.total()) / max(total, 1),
        unit=f"% of {total} findings",
        note=_listed(wrong),
    )


def _clean(every: int) -> Iterator[Figure]:
    """Findings in what is shipped, and in robots that others published."""
    yield _report("shipped", list(shipped_descriptions())[::every], _ROOT)
    corpus = Path(os.environ.get("CARTWHEEL_CORPUS", _ROOT.parent / "shared" / "corpus"))
    if not corpus.is_dir():
        yield Figure(
            group="check: clean robots",
            name="published",
            value=0,
            unit="robots",
            note="no folder of published robots (CARTWHEEL_CORPUS)",
        )
        return
    for folder in sorted(each for each in corpus.iterdir() if each.is_dir())[::every]:
        yield _report(folder.name, robots_in(folder, package_path=[folder])[::every], folder)


def _report(name: str, files: Sequence[Path], folder: Path) -> Figure:
    findings: list[Diagnostic] = []
    unread: Counter[str] = Counter()
    for file in files:
        try:
            result = check(file, package_path=[folder], settings=False)
        except DescriptionError as error:
            unread[error.code.number] += 1
            continue
        if result.reports[0].name:
            findings += result.findings
        else:
            unread.update(finding.code.number for finding in result.findings)
    count = len(files) - unread.total()
    severities = Counter(finding.severity for finding in findings)
    codes = Counter(finding.code.number for finding in findings if finding.severity != "info")
    notes = [f"{severities['error']} errors, {severities['warning']} warnings"]
    notes += [_listed(codes)] if codes else []
    notes += [f"not read: {_listed(unread)}"] if unread else []
    return Figure(
        group="check: clean robots",
        name=name,
        value=severities["error"] + severities["warning"],
        unit=f"in {count} files",
        note="; ".join(notes),
    )


def _listed(names: Counter[str] | Iterable[str]) -> str:
    counts = names if isinstance(names, Counter) else Counter(names)
    return ", ".join(
        f"{name} ({count})" if count > 1 else name for name, count in counts.most_common()
    )
