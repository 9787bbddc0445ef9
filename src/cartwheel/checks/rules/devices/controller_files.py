"""Files with the parameters of controllers."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.controller_files import repeated_keys
from cartwheel.checks.controller_search import named_files, resolved
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.errors import Diagnostic


@rule(devices_codes.CONTROLLERS_FILE_UNREADABLE)
def controllers_file(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for element in named_files(robot):
            path = resolved(subject.packages, element)
            if isinstance(path, Diagnostic):
                yield path
    for _, file in subject.control:
        if file.problem is not None:
            yield file.problem


@rule(devices_codes.CONTROLLER_PARAMETER_REPEATED)
def repeated_parameters(subject: Subject) -> Iterator[Diagnostic]:
    files = {file.path: file for _, file in subject.control}
    for file in files.values():
        if file.path.suffix not in (".yaml", ".yml"):
            continue  # the elements of a launch file are merged
        for key, last in repeated_keys(file.root):
            line = last.start_mark.line + 1
            yield devices_codes.CONTROLLER_PARAMETER_REPEATED.diagnostic(
                message=f'"{key.value}" is repeated in line {line}, and only the last one is used',
                values={"name": key.value, "line": line},
                origin=file.origin(key),
                hint="Remove one of them.",
                mark=key.value,
            )
