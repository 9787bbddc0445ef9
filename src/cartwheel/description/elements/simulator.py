"""For which version of Gazebo a description is."""

from __future__ import annotations

import re
from collections.abc import Iterable

from cartwheel.description.elements.node import Node
from cartwheel.description.model import Simulator

_CLASSIC = re.compile(r"^(?:lib)?gazebo_")
_GZ = re.compile(r"^(?:lib)?(?:gz|ign|ignition)[-_]")
"""Beginnings of the names of plugins for Gazebo Classic and for gz-sim."""


def simulator_of(root: Node) -> Simulator:
    """The version of Gazebo that a description has plugins for; empty for none or both."""
    found = simulators_of(plugin_files(root))
    return found.pop() if len(found) == 1 else ""


def plugin_files(root: Node) -> list[str]:
    """The file names of the plugins in a description."""
    files, left = [], [root]
    while left:
        node = left.pop()
        if node.tag == "plugin":
            files.append(node.attributes.get("filename", "").strip())
        else:
            left += node.children
    return files


def simulators_of(filenames: Iterable[str]) -> set[Simulator]:
    """The versions of Gazebo that some plugins are for."""
    names = [each.rpartition("/")[2] for each in filenames]
    found: set[Simulator] = {"classic"} if any(map(_CLASSIC.search, names)) else set()
    return found | {"gz"} if any(map(_GZ.search, names)) else found
