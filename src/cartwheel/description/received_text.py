"""Descriptions received as text over the network, already expanded by the sender."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NoReturn

from cartwheel.codes.files import XACRO_NOT_EXPANDED
from cartwheel.description.elements.xml import Node
from cartwheel.description.files.other_places import FIND
from cartwheel.description.files.packages import Packages
from cartwheel.errors import DescriptionError, Origin

_COMMAND = re.compile(r"\$\(\s*([\w-]+)")


def refuse_xacro(root: Node, packages: Packages) -> bool:
    """Rejects xacro expressions, and replaces ``$(find …)`` by package folders.

    A remaining ``xmlns:xacro`` is harmless. In an SDF without that declaration, ``${`` is ordinary
    text.

    Args:
        root: The description's root; changed in place.
        packages: Finds packages.

    Returns:
        Whether anything was changed.

    Raises:
        DescriptionError: The text contains xacro; the hint contains the command to expand it.
    """
    changed = False
    strict = root.tag == "robot" or "xmlns:xacro" in root.attributes
    left = [root]
    while left:
        node = left.pop()
        left.extend(node.children)
        if node.tag.startswith("xacro:"):
            _refuse(f"<{node.tag}>", node.origin)
        # A <uri> in SDF is resolved when it is read: a missing file only affects one model.
        if root.tag == "sdf" and node.tag == "uri":
            continue
        words = {name: _found(value, node, packages) for name, value in node.attributes.items()}
        text = _found(node.text, node, packages)
        for word in (*words.values(), text) if strict else ():
            if "${" in word:
                _refuse("${…}", node.origin)
            if command := _COMMAND.search(word):
                _refuse(f"$({command[1]} …)", node.origin)
        if text != node.text or any(words[name] != node.attributes[name] for name in words):
            changed = True
            node.text = text
            node.set_attributes(words)
    return changed


def require_files(root: Node, packages: Packages) -> None:
    """Rejects files that only a plugin opens: those in `<parameters>` of ros2_control.

    Raises:
        DescriptionError: The description may not read such a file.
    """
    for plugin in _all(root, "plugin"):
        for node in _all(plugin, "parameters"):
            if text := node.text.strip():
                packages.require(packages.folder / text, "the file", node.origin)


def _all(root: Node, tag: str) -> Iterator[Node]:
    """All descendants with this tag, with any prefix."""
    left = [root]
    while left:
        node = left.pop()
        left.extend(node.children)
        if node.tag.rpartition(":")[2] == tag:
            yield node


def _found(text: str, node: Node, packages: Packages) -> str:
    if "$(" not in text:
        return text
    return FIND.sub(lambda match: str(packages.find(match[1], node.origin)), text)


def _refuse(what: str, origin: Origin) -> NoReturn:
    raise DescriptionError(
        f"the description contains {what}, but Cartwheel does not expand xacro in descriptions "
        "that it receives over the network",
        code=XACRO_NOT_EXPANDED,
        values={"name": what},
        origin=origin,
        hint="Expand the file first with xacro FILE, or spawn the file with cartwheel spawn "
        "FILE.xacro.",
    )
