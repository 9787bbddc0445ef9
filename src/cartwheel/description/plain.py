"""Descriptions as text over a wire, where xacro has been expanded by whoever sends them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NoReturn

from cartwheel.codes.files import XACRO_NOT_EXPANDED
from cartwheel.description.packages import FIND, Packages
from cartwheel.description.xml import Node
from cartwheel.errors import DescriptionError, Origin

_COMMAND = re.compile(r"\$\(\s*([\w-]+)")


def refuse_xacro(root: Node, packages: Packages) -> bool:
    """Refuses what only xacro expands, and puts the folders of packages for ``$(find …)``.

    A ``xmlns:xacro`` that is left over is harmless. ``${`` in an SDF that does not declare it is
    text like any other.

    Args:
        root: Of the description; changed.
        packages: Finds packages.

    Returns:
        Whether something was changed.

    Raises:
        DescriptionError: There is xacro in it; names the command that expands it.
    """
    changed = False
    strict = root.tag == "robot" or "xmlns:xacro" in root.attributes
    left = [root]
    while left:
        node = left.pop()
        left.extend(node.children)
        if node.tag.startswith("xacro:"):
            _refuse(f"<{node.tag}>", node.origin)
        # What an SDF's <uri> names is found where it is read: a missing one costs one model.
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
    """Refuses files that only a plugin opens: those that ros2_control names in `<parameters>`.

    Raises:
        DescriptionError: The description may not read such a file.
    """
    for plugin in _all(root, "plugin"):
        for node in _all(plugin, "parameters"):
            if text := node.text.strip():
                packages.require(packages.folder / text, "the file", node.origin)


def _all(root: Node, tag: str) -> Iterator[Node]:
    """The elements below one whose tag is this, with any prefix."""
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
        f"the text contains {what}, but xacro in text received over the network is not expanded",
        code=XACRO_NOT_EXPANDED,
        values={"name": what},
        origin=origin,
        hint="Expand the file first with xacro FILE, or spawn the file with cartwheel spawn "
        "FILE.xacro.",
    )
