"""For which version of Gazebo a description is."""

from __future__ import annotations

import re
from typing import Literal

from cartwheel.description.elements.node import Node

_CLASSIC = re.compile(r"^(?:lib)?gazebo_")
_GZ = re.compile(r"^(?:lib)?(?:gz|ign|ignition)[-_]")
"""Beginnings of the names of plugins for Gazebo Classic and for gz-sim."""


Simulator = Literal["", "classic", "gz"]
"""Gazebo Classic or gz-sim; empty if it may be for either of them."""


def simulator_of(root: Node) -> Simulator:
    """The version of Gazebo that a description has plugins for; empty for none or both."""
    files, left = [], [root]
    while left:
        node = left.pop()
        if node.tag == "plugin":
            files.append(node.attributes.get("filename", "").rpartition("/")[2])
        else:
            left += node.children
    classic, gz = any(map(_CLASSIC.search, files)), any(map(_GZ.search, files))
    if classic == gz:
        return ""
    return "classic" if classic else "gz"
