"""The rules that find what breaks or misleads."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from cartwheel.description.check.finding import Finding, Remark
from cartwheel.description.check.subject import Subject
from cartwheel.errors import Severity

MOST_FINDINGS = 200
"""Of one rule. Each may search all names for the one that was meant."""

Finder = Callable[[Subject], Iterable[Remark]]


@dataclass(frozen=True, kw_only=True, slots=True)
class Rule:
    """One thing that is looked for."""

    name: str
    severity: Severity
    summary: str
    find: Finder

    def apply(self, subject: Subject) -> list[Finding]:
        """What it finds, up to `MOST_FINDINGS` and one that says that there are more."""
        remarks = list(itertools.islice(self.find(subject), MOST_FINDINGS + 1))
        if len(remarks) > MOST_FINDINGS:
            remarks[-1] = Remark(
                message=f"there are more than {MOST_FINDINGS} findings of this rule",
                origin=remarks[-1].origin,
                hint="Mend these and check again.",
            )
        return [
            Finding(
                rule=self.name,
                severity=remark.severity or self.severity,
                message=remark.message,
                origin=remark.origin,
                instead=remark.instead,
                place=remark.place,
                mark=remark.mark,
                hint=remark.hint,
            )
            for remark in remarks
        ]


def rule(name: str, severity: Severity, summary: str) -> Callable[[Finder], Rule]:
    """Makes a rule of the function that finds it."""

    def make(find: Finder) -> Rule:
        return Rule(name=name, severity=severity, summary=summary, find=find)

    return make
