"""Checks a file or workspace with its project's settings, suppressions and baseline."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from cartwheel.checks.checking import Report, place
from cartwheel.checks.checking import check as check_description
from cartwheel.checks.project import workspace
from cartwheel.checks.project.baseline import Baseline
from cartwheel.checks.project.selection import Selection
from cartwheel.checks.project.settings import Settings, settings_for
from cartwheel.checks.project.suppressions import Suppressions
from cartwheel.description.launches import LaunchSearch, OwnLaunches
from cartwheel.dialects.plugin_files import using
from cartwheel.errors import DescriptionError, Diagnostic, Origin


@dataclass(frozen=True, kw_only=True, slots=True)
class Result:
    """The result of checking a file or folder."""

    path: str
    """The file or the folder."""
    reports: tuple[Report, ...]
    """Reports for each description, before selection and suppression."""
    findings: tuple[Diagnostic, ...]
    """Sorted by file and line; findings shared by several descriptions are listed once."""
    ignored: int = 0
    """Number of findings with ignored or unselected codes."""
    suppressed: int = 0
    """Number of findings suppressed by comments."""
    accepted: int = 0
    """Number of findings accepted by the baseline."""
    strict: bool = False
    """Whether the project's settings treat notes as failures."""

    @property
    def complete(self) -> bool:
        """False if some rules were skipped because something could not be read."""
        return all(report.complete for report in self.reports)

    def count(self, severity: str) -> int:
        """The number of findings with a severity: ``error``, ``warning`` or ``info``."""
        return sum(finding.severity == severity for finding in self.findings)


def check(
    path: Path | str,
    *,
    arguments: Mapping[str, str] | None = None,
    package_path: Sequence[Path] = (),
    controllers: Sequence[Path] = (),
    select: Sequence[str] = (),
    ignore: Sequence[str] = (),
    baseline: Path | None = None,
    settings: bool = True,
    use_baseline: bool = True,
    plugins: Sequence[Path] = (),
) -> Result:
    """Finds mistakes in a description, or in all descriptions in a folder.

    ``cartwheel check`` calls this function, so the findings are the same.

    Args:
        path: A xacro, URDF, SDF or world file, a built-in model, or a folder.
        arguments: Values of xacro arguments.
        package_path: Folders to search for packages first.
        controllers: Controller files to check instead of those found near the robot.
        select: Codes to report instead of the settings': numbers, names, or prefixes such as
            ``CW2``. Empty for the settings' selection, or all codes.
        ignore: Codes not to report, in addition to those in the settings.
        baseline: A file with accepted findings, instead of the settings' baseline.
        settings: Whether to read ``cartwheel.toml`` or ``pyproject.toml`` in or above the path.
        use_baseline: False to also report findings that the baseline accepts.
        plugins: Python files that define plugins. They are executed.

    Raises:
        DescriptionError: A single file cannot be read at all, or is not a description.
        UnknownNameError: A code does not exist.
        CartwheelError: The settings, the baseline or a plugin cannot be read.
    """
    project = settings_for(Path(path)) if settings and Path(path).exists() else Settings()
    selection = Selection.of(select or project.select, (*project.ignore, *ignore))
    accepted_file = (baseline or project.baseline) if use_baseline else None
    accepted = Baseline.read(accepted_file) if accepted_file is not None else None
    folder = Path(path).is_dir() and not (Path(path) / "model.config").is_file()
    files = workspace.descriptions(Path(path)) if folder else [Path(path)]
    launches = LaunchSearch(package_path, Path(path) if folder else None).of
    with using(plugins):
        reports = tuple(
            _report(file, arguments or {}, package_path, controllers, launches, folder=folder)
            for file in files
        )
    return _result(str(path), reports, selection, accepted, strict=project.strict)


def _report(
    file: Path,
    arguments: Mapping[str, str],
    package_path: Sequence[Path],
    controllers: Sequence[Path],
    launches: Callable[[Path], OwnLaunches],
    *,
    folder: bool,
) -> Report:
    try:
        return check_description(
            file,
            arguments=arguments,
            package_path=package_path,
            controller_files=controllers,
            launches=launches,
        )
    except DescriptionError as error:
        # Without a line, there is nothing to show for a single file except the error itself.
        if not folder and (error.origin is None or not error.origin.line):
            raise
        finding = error.diagnostic()
        if finding.origin is None:
            finding = replace(finding, origin=Origin(file=str(file)))
        return Report(
            file=str(file),
            name="",
            findings=(finding,),
            complete=False,
            files=(str(file),),
        )


def _result(
    path: str,
    reports: tuple[Report, ...],
    selection: Selection,
    baseline: Baseline | None,
    *,
    strict: bool,
) -> Result:
    suppressions = Suppressions()
    findings: list[Diagnostic] = []
    seen: set[tuple[object, ...]] = set()
    ignored = suppressed = accepted = 0
    for report in reports:
        for finding in report.findings:
            if finding.identity in seen:
                continue
            seen.add(finding.identity)
            # Comments first: a comment that suppresses an ignored code is not unused.
            if suppressions.suppresses(finding):
                suppressed += 1
            elif finding.code not in selection:
                ignored += 1
            elif baseline is not None and baseline.accepts(finding):
                accepted += 1
            else:
                findings.append(finding)
    files = dict.fromkeys(file for report in reports for file in report.files)
    notes = suppressions.unused(files)
    findings += [note for note in notes if note.code in selection]
    order = {file: index for index, file in enumerate(files)}
    return Result(
        path=path,
        reports=reports,
        findings=tuple(sorted(findings, key=lambda each: place(each, order))),
        ignored=ignored,
        suppressed=suppressed,
        accepted=accepted,
        strict=strict,
    )
