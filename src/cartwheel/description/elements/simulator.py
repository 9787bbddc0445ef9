"""For which version of Gazebo a description is."""

from __future__ import annotations

import re

from cartwheel.description.elements.node import Node

_CLASSIC = re.compile(r"^(?:lib)?gazebo_")
_GZ = re.compile(r"^(?:lib)?(?:gz|ign|ignition)[-_]")
"""Beginnings of the names of plugins for Gazebo Classic and for gz-sim."""


def is_classic(root: Node) -> bool:
    """Whether a description has plugins for Gazebo Classic, and none for gz-sim."""
    files, left = [], [root]
    while left:
        node = left.pop()
        if node.tag == "plugin":
            files.append(node.attributes.get("filename", "").rpartition("/")[2])
        else:
            left += node.children
    return any(map(_CLASSIC.search, files)) and not any(map(_GZ.search, files))
