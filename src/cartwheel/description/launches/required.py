"""Arguments without a default, without which ROS does not start a launch file."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path

from cartwheel.codes.files import LAUNCH_VALUE_UNKNOWN
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.files.package_search import Searched
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.repositories import repository_of, root_of
from cartwheel.description.launches.effort import UNKNOWN, Effort
from cartwheel.description.launches.reading import facts_of
from cartwheel.description.launches.search import launch_files
from cartwheel.description.launches.use import Facts
from cartwheel.errors import Diagnostic, Origin

_MOST = 100
"""Maximum number of launch files that are searched for includes."""


def stated_by_includers(
    file: Path, names: Collection[str], effort: Effort, package_path: Sequence[Path] = ()
) -> dict[str, str]:
    """The arguments for which all launch files that include a launch file state the same value.

    They are searched in its package and those beside it, or in its repository.

    Args:
        file: The launch file.
        names: Names of its arguments.
        effort: What reading may cost.
        package_path: Folders to search for packages first.
    """
    values: dict[str, set[str]] = {}
    searched: Searched = {}
    here, folder = file.resolve(), root_of(file) or repository_of(file)
    files = () if folder is None else launch_files(folder, effort)
    for path in itertools.islice(files, _MOST):
        if path.resolve() == here:
            continue
        packages = Packages(path, package_path, searched=searched)
        with effort.portion():
            for included, arguments in facts_of(path, packages, {}, effort).includes:
                if included.resolve() == here:
                    for name in names:
                        values.setdefault(name, set()).add(arguments.get(name, UNKNOWN))
    return {
        name: value
        for name, (value, *others) in ((name, sorted(found)) for name, found in values.items())
        if not others and UNKNOWN not in value
    }


def about_arguments(file: Path, facts: Facts, stated: Mapping[str, str]) -> Iterator[Diagnostic]:
    """Reports arguments without a default, and the values that other launch files state.

    Args:
        file: The launch file.
        facts: Its contents.
        stated: The values that launch files state which include it.
    """
    for name, value in stated.items():
        yield LAUNCH_VALUE_UNKNOWN.diagnostic(
            f'the argument "{name}" has no default, so "{value}" is used, which the launch files '
            "that include this one state",
            severity="info",
            origin=Origin(file=shown_path(file)),
            hint=f"To use another value, pass {name}:=VALUE.",
            values={"what": "argument", "name": name},
        )
    for (path, name), origin in facts.required.items():
        own = path == file
        hint = f"Pass {name}:=VALUE." if own else f'State it where "{path.name}" is included.'
        yield LAUNCH_VALUE_UNKNOWN.diagnostic(
            f'the argument "{name}" has neither a default nor a value, so ROS does not start the '
            "launch file",
            origin=origin,
            hint=hint,
            values={"what": "argument", "name": name},
        )
