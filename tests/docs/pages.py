"""What the pages of the documentation consist of."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
STEPS = DOCS / "tutorial" / "steps"
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    ROOT / "CHANGELOG.md",
    ROOT / "SECURITY.md",
    *sorted(DOCS.rglob("*.md")),
]

_FENCE = re.compile(r"^```(\w*)\s*$")
_NOTE = re.compile(r"^<!-- (not run|keys|fails|finds): (.+) -->$")


@dataclass
class Block:
    """A fenced block of a page."""

    page: Path
    line: int
    language: str
    lines: list[str] = field(default_factory=list)
    notes: dict[str, str] = field(default_factory=dict)
    """From the comment above it: ``not run`` with the reason, ``keys`` to type, ``fails`` or
    ``finds`` with the reason why the last command ends with status 2 or 1."""

    def __str__(self) -> str:
        return f"{self.page.relative_to(ROOT)}:{self.line}"


@dataclass
class Command:
    """A command of a console block, and what the page shows of its output."""

    block: Block
    line: int
    text: str
    expected: str = ""
    status: int = 0
    """The exit status that the page expects."""

    def __str__(self) -> str:
        return f"{self.block.page.relative_to(ROOT)}:{self.line}: $ {self.text}"


def blocks(page: Path, *languages: str) -> list[Block]:
    """The fenced blocks of a page in these languages; of all, where none is named."""
    found = list(_blocks(page))
    return [block for block in found if block.language in languages or not languages]


def _blocks(page: Path) -> Iterator[Block]:
    block: Block | None = None
    notes: dict[str, str] = {}
    for number, line in enumerate(page.read_text().splitlines(), start=1):
        fence = _FENCE.match(line)
        if block is None and fence:
            block = Block(page=page, line=number, language=fence[1], notes=notes)
            notes = {}
        elif block is None:
            note = _NOTE.match(line)
            if note:
                notes[note[1]] = note[2]
            elif line.strip():
                notes = {}
        elif fence:
            yield block
            block = None
        else:
            block.lines.append(line)
    assert block is None, f"{block}: a fence is not closed"


def commands(page: Path) -> list[Command]:
    """The commands of a page that are to be run, in order."""
    found: list[Command] = []
    for block in blocks(page, "console"):
        assert block.lines and block.lines[0].startswith("$ "), f"{block}: begins without a command"
        if "not run" in block.notes:
            continue
        for offset, line in enumerate(block.lines, start=1):
            if line.startswith("$ "):
                found.append(Command(block=block, line=block.line + offset, text=line[2:]))
            else:
                found[-1].expected += line + "\n"
        found[-1].status = 2 if "fails" in block.notes else int("finds" in block.notes)
    return found
