"""Parameters of controllers that a launch file of ROS 1 contains itself, in ``<rosparam>``."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from cartwheel.description.elements import xml
from cartwheel.description.elements.node import Node
from cartwheel.description.files.regular_files import read_regular_text

_SUFFIXES = (".launch", ".xml")
_TYPE = re.compile(r"\btype\s*+:\s*+[\"']?+\w++/\w*?Controller\b")
"""The type of a controller."""
_COMMENT = re.compile(r"(<!\[CDATA\[.*?(?:\]\]>|\Z))|<!--.*?(?:-->|\Z)", re.DOTALL)
_START = re.compile(
    r"<!\[CDATA\[.*?(?:\]\]>|\Z)|<rosparam(?=[\s/>])((?:[^>\"']++|\"[^\"]*+\"|'[^']*+')*+)(?:>|\Z)",
    re.DOTALL,
)
"""A start tag, with what is between its name and its end."""
_DEEPEST = 20
"""Maximum number of nested namespaces."""


@dataclass(frozen=True, slots=True)
class _Block:
    index: int
    """Its number among the elements of the file."""
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
    order = {id(each): index for index, each in enumerate(_elements(root))}
    texts = list(_texts(read_regular_text(path)))
    lines: list[str] = []
    for block in _blocks(root, (), order):
        if block.index >= len(texts):
            continue  # the file has an encoding that only the XML reader knows
        head, text = texts[block.index]
        # The first line is that of the tag, so the YAML begins on the next one or on this one.
        first, *rest = textwrap.dedent(text).rstrip().splitlines() or [""]
        found = [first.lstrip(), *rest] if first.strip() else rest
        start = head if first.strip() else head + 1
        lines += [""] * (start - len(block.spaces) - len(lines))
        lines += [f"{' ' * depth}{name}:" for depth, name in enumerate(block.spaces)]
        lines += [f"{' ' * len(block.spaces)}{line}" for line in found]
    return "\n".join(lines)


def _elements(root: Node) -> Iterator[Node]:
    """The ``<rosparam>`` elements of a launch file, in the order of their start tags."""
    for child in root.children:
        if child.tag == "rosparam":
            yield child
        yield from _elements(child)


def _texts(source: str) -> Iterator[tuple[int, str]]:
    """The text of each ``<rosparam>`` element, and the index of the line on which it begins.

    The elements' own texts lack their indentation. Comments are left out.
    """
    plain = _COMMENT.sub(lambda found: found[1] or "\n" * found[0].count("\n"), source)
    line = place = 0
    for tag in _START.finditer(plain):
        line += plain.count("\n", place, tag.end())
        place = tag.end()
        if tag[1] is not None:
            end = place if tag[1].endswith("/") else plain.find("</rosparam", place)
            yield line, plain[place : end if end >= 0 else None]


def _blocks(node: Node, spaces: tuple[str, ...], order: Mapping[int, int]) -> Iterator[_Block]:
    for child in node.children:
        stated = child.attributes.get("ns", "")
        # A namespace that begins with a slash is not relative.
        inside = () if stated.startswith("/") else spaces
        inside += tuple(each for each in stated.split("/") if each)
        if child.tag == "group":
            yield from _blocks(child, inside, order)
        elif child.tag == "rosparam" and "file" not in child.attributes:
            named = child.attributes.get("param", "")
            parts = (*inside, *(each for each in named.split("/") if each))
            known = len(parts) <= _DEEPEST and not any("$" in each for each in parts)
            if known and has_controllers(child.text):
                yield _Block(order[id(child)], parts)
