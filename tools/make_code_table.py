"""Writes the table of codes into docs/check.md, or checks that it is up to date with --check."""

import html
import sys
from pathlib import Path

from cartwheel.checks.checking import REPORTED
from cartwheel.codes import MODULES, codes_of

PAGE = Path(__file__).parents[1] / "docs" / "check.md"
BEGIN, END = "<!-- codes: begin -->\n", "<!-- codes: end -->"
WORDS = {"info": "note"}


def table() -> str:
    """The codes that a check can report, as Markdown."""
    lines = ["| code | name | severity | reports |", "|---|---|---|---|"]
    for module in MODULES:
        codes = [code for code in codes_of(module) if code in REPORTED]
        if not codes:
            continue
        lines.append(f"| | **{MODULES[module]}** | | |")
        lines += [
            f"| {code.number} | `{code.name}` | {WORDS.get(code.severity, code.severity)} | "
            f"{html.escape(code.summary, quote=False)} |"
            for code in codes
        ]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Writes or checks the page."""
    text = PAGE.read_text(encoding="utf-8")
    before, _, rest = text.partition(BEGIN)
    wanted = before + BEGIN + table() + END + rest.partition(END)[2]
    if "--check" not in sys.argv:
        PAGE.write_text(wanted, encoding="utf-8")
    elif text != wanted:
        sys.exit("docs/check.md has an old table of codes: run tools/make_code_table.py")


if __name__ == "__main__":
    main()
