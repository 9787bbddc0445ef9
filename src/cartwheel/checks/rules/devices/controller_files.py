"""Files with the parameters of controllers."""

from __future__ import annotations

from collections.abc import Iterator

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
