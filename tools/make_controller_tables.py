"""Writes the tables in docs/controllers.md, or checks that they are up to date with --check.

The controllers and their parameters are read from the classes in ``cartwheel.dialects``.
"""

from __future__ import annotations

import dataclasses
import math
import sys
from pathlib import Path
from typing import Any

from cartwheel.dialects.ros_control.catalogue import ACKERMANN, controller_types, find_type
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.parameters import Row, rows

PAGE = Path(__file__).parents[1] / "docs" / "controllers.md"
BEGIN, END = "<!-- parameters: begin -->\n", "<!-- parameters: end -->"
Table = dict[str, dict[bool, Row]]


def families() -> dict[type[Controller], list[str]]:
    """The classes of controllers with their types, in the order of the types' names."""
    found: dict[type[Controller], list[str]] = {}
    for name, family in sorted(controller_types().items()):
        found.setdefault(family, []).append(name)
    # ROS 1 and ROS 2 use this name for two different controllers.
    found[find_type(ACKERMANN, ros2=False)].append(f"{ACKERMANN} (ROS 1)")
    return found


def table(family: type[Controller]) -> list[str]:
    """The parameters of a controller, as Markdown."""
    fields: Table = {}
    for ros2 in (False, True):
        for row in rows(family.parameters, ros2=ros2):
            fields.setdefault(row.field, {})[ros2] = row
    lines = ["| parameter | value | default | meaning |", "|---|---|---|---|"]
    for versions in sorted(fields.values(), key=_is_unused):
        row = versions.get(False) or versions[True]
        names = {ros2: _names(each) for ros2, each in versions.items()}
        shown = next(iter(names.values()))
        if len(names) == 1:
            shown += f" (ROS {2 if True in names else 1})"
        elif names[False] != names[True]:
            shown = f"{names[False]} (ROS 1), {names[True]} (ROS 2)"
        doc, _, stated = row.doc.partition(" Default: ")
        default = (
            stated.removesuffix(".")
            if stated
            else ""
            if row.kind == "group"
            else _default(row.default)
        )
        value = " ".join(filter(None, (row.kind, f"({row.unit})" if row.unit else "")))
        lines.append(f"| {shown} | {value} | {default} | {doc} |")
    return lines


def _is_unused(versions: dict[bool, Row]) -> bool:
    return next(iter(versions.values())).doc.startswith("No effect")


def _names(row: Row) -> str:
    spelled = dict.fromkeys((*row.spelled(), *row.spelled(front_steering=False)))
    return ", ".join(f"`{name.replace('{joint}', '<joint>')}`" for name in spelled)


def _default(value: Any) -> str:
    if value is dataclasses.MISSING:
        return "required"
    if value is None or value in ("", ()):
        return ""
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, tuple):
        return f"`[{', '.join(_plain(each) for each in value)}]`"
    return "no limit" if isinstance(value, float) and math.isinf(value) else f"`{_plain(value)}`"


def _type(name: str) -> str:
    kind, _, version = name.partition(" ")
    return f"`{kind}`" + (f" {version}" if version else "")


def _plain(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def text() -> str:
    """All tables."""
    lines: list[str] = []
    for family, types in families().items():
        lines += [f"### {types[0].partition('/')[2].removesuffix(' (ROS 1)')}", ""]
        lines += [f"For {', '.join(_type(each) for each in types)}:", "", *table(family), ""]
    return "\n".join(lines)


def main() -> None:
    """Writes or checks the page."""
    page = PAGE.read_text(encoding="utf-8")
    before, _, rest = page.partition(BEGIN)
    wanted = before + BEGIN + "\n" + text() + END + rest.partition(END)[2]
    if "--check" not in sys.argv:
        PAGE.write_text(wanted, encoding="utf-8")
    elif page != wanted:
        sys.exit("docs/controllers.md has old tables: run tools/make_controller_tables.py")


if __name__ == "__main__":
    main()
