"""Parameters of controllers that a launch file of ROS 1 contains itself, in ``<rosparam>``."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from cartwheel.description.elements import xml
from cartwheel.description.elements.node import Node
from cartwheel.description.files.regular_files import read_regular_text

_SUFFIXES = (".launch", ".xml")
_TYPE = re.compile(r"\btype\s*+:\s*+[\"']?+\w++/\w*?Controller\b")
"""The type of a controller."""

_DEEPEST = 20
"""Maximum number of nested namespaces."""


@dataclass(frozen=True, slots=True)
class _Block:
    line: int
    spaces: tuple[str, ...]
    """The namespaces in which it is, from the outermost."""


def has_controllers(text: str) -> bool:
    """Whether a text in YAML contains the type of a controller."""
    return _TYPE.search(text) is not None


def written_in(path: Path) -> str | None:
    """The ``<rosparam>`` elements of a launch file that contain controllers, as one YAML text.

    Each parameter is on the line on which it is in the file. Namespaces are keys.

    Returns:
        The text; None if the file is not a launch file in XML.
    """
    root = xml.readable_file(path) if path.suffix in _SUFFIXES else None
    if root is None or root.tag != "launch":
        return None
    source = read_regular_text(path).splitlines(keepends=True)
    lines: list[str] = []
    for block in _blocks(root, ()):
        head, text = _text_in(source, block.line - 1)
        # The first line is that of the tag, so the YAML begins on the next one or on this one.
        first, *rest = textwrap.dedent(text).rstrip().splitlines() or [""]
        found = [first.lstrip(), *rest] if first.strip() else rest
        start = head if first.strip() else head + 1
        lines += [""] * (start - len(block.spaces) - len(lines))
        lines += [f"{' ' * depth}{name}:" for depth, name in enumerate(block.spaces)]
        lines += [f"{' ' * len(block.spaces)}{line}" for line in found]
    return "\n".join(lines)


def _text_in(source: Sequence[str], index: int) -> tuple[int, str]:
    """The text of an element that begins on a line, and the index of the line of its content.

    The element's own text lacks its indentation.
    """
    last = index
    rest = source[index].partition("<rosparam")[2]
    # Not the whole file, because it may have thousands of elements.
    while "</rosparam" not in rest and last + 1 < len(source):
        last += 1
        rest = source[last]
    text = "".join(source[index : last + 1])
    begin = text.find(">", max(0, text.find("<rosparam"))) + 1
    end = text.find("</rosparam", begin)
    return index + text.count("\n", 0, begin), text[begin : end if end >= 0 else None]


def _blocks(node: Node, spaces: tuple[str, ...]) -> Iterator[_Block]:
    for child in node.children:
        stated = child.attributes.get("ns", "")
        # A namespace that begins with a slash is not relative.
        inside = () if stated.startswith("/") else spaces
        inside += tuple(each for each in stated.split("/") if each)
        if child.tag == "group":
            yield from _blocks(child, inside)
        elif child.tag == "rosparam" and "file" not in child.attributes:
            named = child.attributes.get("param", "")
            parts = (*inside, *(each for each in named.split("/") if each))
            known = len(parts) <= _DEEPEST and not any("$" in each for each in parts)
            if known and has_controllers(child.text):
                yield _Block(child.origin.line, parts)
