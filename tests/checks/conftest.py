"""A small robot without a fault, ways to spoil it, and the advice taken literally."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from tests.checks.seeded import ROBOT

from cartwheel.checks.checking import Report, check
from cartwheel.codes import code_named
from cartwheel.errors import Diagnostic


@dataclass
class Bench:
    """Checks texts as files."""

    folder: Path

    def report(self, text: str, name: str = "robot.urdf", **options: object) -> Report:
        """What is found in a text."""
        path = self.folder / name
        path.write_text(text)
        return check(path, **options)

    def find(
        self, text: str, rule: str, name: str = "robot.urdf", **options: object
    ) -> list[Diagnostic]:
        """What a rule finds in a text."""
        return [
            f for f in self.report(text, name, **options).findings if f.code is code_named(rule)
        ]


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    return Bench(tmp_path)


@pytest.fixture
def robot() -> str:
    """A URDF without a fault."""
    return ROBOT


@pytest.fixture
def spoil() -> Callable[..., str]:
    """The robot with texts replaced, each of which it must have."""

    def make(*pairs: tuple[str, str], text: str = ROBOT) -> str:
        for old, new in pairs:
            assert old in text, f"the robot has no {old!r}"
            text = text.replace(old, new, 1)
        return text

    return make


@pytest.fixture
def line_of() -> Callable[[str, str], int]:
    """The line in which a text stands first."""
    return lambda text, part: text[: text.index(part)].count("\n") + 1


@pytest.fixture
def take() -> Callable[[str, Diagnostic], str]:
    """A text with a finding's advice written where it says."""
    return take_advice


def take_advice(text: str, finding: Diagnostic) -> str:
    assert finding.origin is not None
    assert finding.instead
    if finding.place == "line" or finding.origin.file.endswith(".yaml"):
        return _take_in_yaml(text, finding)
    start = sum(len(line) + 1 for line in text.split("\n")[: finding.origin.line - 1])
    head = re.compile(r"<([\w:]+)((?:\s+[\w:]+=\"[^\"]*\")*)\s*(/?)>").search(text, start)
    assert head is not None
    tag, attributes, alone = head[1], head[2], bool(head[3])
    end = head.end() if alone else text.index(f"</{tag}>", head.end()) + len(f"</{tag}>")
    new = finding.instead
    if finding.place == "element":
        return text[: head.start()] + new + text[end:]
    if finding.place == "after":
        return text[:end] + new + text[end:]
    if finding.place == "inside":
        if alone:
            return text[: head.start()] + f"<{tag}{attributes}>{new}</{tag}>" + text[end:]
        close = end - len(f"</{tag}>")
        return text[:close] + new + text[close:]
    assert finding.place == "attribute", "the advice does not say where"
    name = new.partition("=")[0]
    attributes = re.sub(rf'\s+{name}="[^"]*"', "", attributes)
    return text[: head.start()] + f"<{tag} {new}{attributes}{'/' * alone}>" + text[head.end() :]


def _take_in_yaml(text: str, finding: Diagnostic) -> str:
    assert finding.origin is not None
    lines = text.split("\n")
    number = finding.origin.line - 1
    indent = " " * (len(lines[number]) - len(lines[number].lstrip()))
    if finding.place == "line":
        lines[number] = indent + finding.instead
    else:
        assert finding.place == "after"
        lines.insert(number + 1, indent + finding.instead)
    return "\n".join(lines)
