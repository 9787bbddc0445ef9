"""docs/check.md lists every rule as it is."""

from pathlib import Path

from cartwheel.description.check import RULES

PAGE = Path(__file__).parents[3] / "docs" / "check.md"


def test_the_page_lists_every_rule_with_its_severity_and_line():
    text = PAGE.read_text()
    rows = [line for line in text.splitlines() if line.startswith("| `") and line.count("|") == 4]
    listed = [row for row in rows if row.split("`")[1] in {rule.name for rule in RULES}]
    words = {"info": "note"}
    expected = [
        f"| `{rule.name}` | {words.get(rule.severity, rule.severity)} | "
        f"{rule.summary.replace('<', '&lt;').replace('>', '&gt;')} |"
        for rule in RULES
    ]
    assert listed == expected
