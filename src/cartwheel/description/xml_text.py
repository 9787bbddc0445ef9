"""Writes a tree as XML text, as for robot_description, without xacro and internal marks."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.description.elements.xml import Node
from cartwheel.description.files.packages import Packages

_WITH_FILES = ("mesh", "texture")


def write_xml(root: Node, packages: Packages | None = None) -> str:
    """XML text, indented by two spaces per level, with attributes in file order.

    Args:
        root: The tree.
        packages: If given, the URIs of meshes and textures become ``file://`` URIs.

    Raises:
        DescriptionError: A mesh or texture does not exist.
    """
    return '<?xml version="1.0"?>\n' + "".join(_lines(root, 0, packages))


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _quoted(text: str) -> str:
    # The XML parser converts unescaped line breaks to spaces.
    text = _escaped(text).replace('"', "&quot;")
    return '"' + text.replace("\n", "&#10;").replace("\t", "&#9;").replace("\r", "&#13;") + '"'


def _lines(node: Node, level: int, packages: Packages | None) -> Iterator[str]:
    indent = "  " * level
    opening = f"{indent}<{node.tag}"
    for name, value in node.attributes.items():
        if name == "xmlns:xacro":
            continue
        if packages is not None and name == "filename" and node.tag in _WITH_FILES and value:
            value = packages.resolve(value, node.origin, what=node.tag).as_uri()  # noqa: PLW2901
        opening += f" {name}={_quoted(value)}"
    if not node.children:
        yield f"{opening}>{_escaped(node.text)}</{node.tag}>\n" if node.text else f"{opening}/>\n"
        return
    yield f"{opening}>\n"
    if node.text:
        yield f"{indent}  {_escaped(node.text)}\n"
    for child in node.children:
        yield from _lines(child, level + 1, packages)
    yield f"{indent}</{node.tag}>\n"
