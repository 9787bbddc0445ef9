"""Rules, each of which finds one kind of fault."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

from cartwheel.checks.subject import Subject
from cartwheel.errors import UNCLASSIFIED, Code, Diagnostic, Origin

MOST_FINDINGS = 200
"""Maximum findings per rule. Each finding may search all names for a similar one."""
Finder = Callable[[Subject], Iterable[Diagnostic]]


@dataclass(frozen=True, kw_only=True, slots=True)
class Rule:
    """Finds one kind of fault."""

    code: Code
    find: Finder

    def apply(self, subject: Subject) -> list[Diagnostic]:
        """At most `MOST_FINDINGS` findings, plus one that reports how many were omitted."""
        findings = list(itertools.islice(self.find(subject), MOST_FINDINGS + 1))
        if len(findings) > MOST_FINDINGS:
            findings[-1] = _more(self.code, findings[-1].origin)
        return [
            replace(each, code=self.code) if each.code.number == UNCLASSIFIED.number else each
            for each in findings
        ]


def limited(
    findings: Iterable[Diagnostic], finish: Callable[[Diagnostic], Diagnostic]
) -> Iterator[Diagnostic]:
    """At most `MOST_FINDINGS` findings per code, plus one that reports that there are more.

    Args:
        findings: All findings.
        finish: Completes the findings that are kept.
    """
    counts: Counter[Code] = Counter()
    for each in findings:
        counts[each.code] += 1
        if counts[each.code] <= MOST_FINDINGS:
            yield finish(each)
        elif counts[each.code] == MOST_FINDINGS + 1:
            yield _more(each.code, each.origin)


def _more(code: Code, origin: Origin | None) -> Diagnostic:
    return code.diagnostic(
        f"there are more than {MOST_FINDINGS} findings of this kind",
        origin=origin,
        hint="Fix these and check again.",
        values={"most": MOST_FINDINGS},
    )


def rule(code: Code) -> Callable[[Finder], Rule]:
    """Decorator that makes a rule from a function that finds one kind of fault."""

    def make(find: Finder) -> Rule:
        return Rule(code=code, find=find)

    return make
