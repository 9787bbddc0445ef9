"""xacro's elements without a prefix, which ROS supported until Melodic.

Since Noetic, they have no effect in ROS, and files that need their definitions fail. Many published
robots are older.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any

PREFIX = "xacro:"
_NEEDED = {
    "property": ("name",),
    "macro": ("name",),
    "include": ("filename",),
    "insert_block": ("name",),
    "if": ("value",),
    "unless": ("value",),
    "arg": ("name", "default"),
}
"""xacro's elements, with the attributes that distinguish them from other elements."""
_OTHERS = frozenset(
    ("robot", "link", "joint", "gazebo", "transmission", "material", "sensor", "plugin", "model",
     "world", "include", "light", "frame", "inertial", "visual", "collision", "origin", "mass",
     "inertia", "geometry", "box", "cylinder", "sphere", "capsule", "mesh", "color", "texture",
     "parent", "child", "axis", "limit", "dynamics", "mimic", "calibration", "safety_controller",
     "actuator", "param", "hardware", "hardwareInterface", "type", "pose", "size", "radius",
     "length", "camera", "ray", "lidar", "imu", "gps", "contact", "surface", "friction",
     "ros2_control", "state_interface", "command_interface")
)  # fmt: skip
"""Elements that are valid in a description themselves, regardless of macro names."""


def prefixed(root: Any, report: Callable[[Any, str, int], None]) -> None:
    """Adds the prefix to xacro's elements below a file's root.

    Args:
        root: The DOM's root element; changed in place.
        report: Called once per tag with its first element, the tag and the number of elements.
    """
    found = [element for element in root.getElementsByTagName("*") if _is_xacro(element)]
    count = Counter(element.tagName for element in found)
    for tag, number in count.items():
        report(next(element for element in found if element.tagName == tag), tag, number)
    for element in found:
        _rename(element)


def call_prefixed(element: Any, macros: Any, within: Iterable[str]) -> bool:
    """Adds the prefix to a macro call if an element without prefix can only be a call.

    Args:
        element: A DOM element, not yet evaluated.
        macros: xacro's table of defined macros.
        within: The tags of active calls: a macro may create an element with its own name.

    Returns:
        Whether it is a call. Otherwise nothing has changed.
    """
    tag = element.tagName
    if tag in _OTHERS or ":" in tag:
        return False
    try:
        macro = macros[tag]
        if any(tag == re.split(r"[:.]", call)[-1] for call in within):
            return False
        given = set(element.attributes.keys())
        needed = {name for name in macro.params if name not in macro.defaultmap}
    except (KeyError, AttributeError):
        return False
    blocks = sum(name.startswith("*") for name in needed)
    needed = {name for name in needed if not name.startswith("*")}
    inside = [child for child in element.childNodes if child.nodeType == child.ELEMENT_NODE]
    if not needed <= given <= set(macro.params) or len(inside) != blocks:
        return False
    _rename(element)
    return True


def _is_xacro(element: Any) -> bool:
    needed = _NEEDED.get(element.tagName)
    if needed is None or not all(element.hasAttribute(name) for name in needed):
        return False
    # An SDF include contains a <uri>.
    inside = any(child.nodeType == child.ELEMENT_NODE for child in element.childNodes)
    return not (inside and element.tagName == "include")


def _rename(element: Any) -> None:
    element.nodeName = element.tagName = PREFIX + element.tagName
