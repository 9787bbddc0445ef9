"""The parts of stand-in packages that a sensor's driver would provide: frames and topics.

Many sensor packages describe only the body of the sensor: on the robot, the driver publishes the
images and the calibrated frames, and for a simulation users attach sensors of their own. Such a
stand-in marks its own sensors and frames with the attribute `MARK`. They are used only if the
robot's files attach no sensor to the device.
"""

from __future__ import annotations

from collections.abc import Iterable

from cartwheel.description.elements.xml import Node

MARK = "driver_of"
"""Attribute with the device's root link; an empty value marks nothing."""
SPARE = "if_undefined"
"""Attribute of a link that is removed if the robot's files define a link with this name."""


def choose_driver_parts(root: Node) -> tuple[str, ...]:
    """Removes the marked elements of each device that has sensors of its own, and all marks.

    A device's marked elements are also removed if the robot's files define one of its links or
    joints themselves.

    Args:
        root: The expanded robot.

    Returns:
        The names of the marked sensors that remain, which the original package does not contain.
    """
    stated = _names([node for node in root.children if SPARE not in node.attributes])
    root.children = [
        node
        for node in root.children
        if SPARE not in node.attributes or not _names([node]) & stated
    ]
    marked = [node for node in root.children if node.attributes.get(MARK)]
    own = [node for node in root.children if not node.attributes.get(MARK)]
    for device in dict.fromkeys(node.attributes[MARK] for node in marked):
        parts = [node for node in marked if node.attributes[MARK] == device]
        if not _is_sensed(device, own, parts) and not _names(own) & _names(parts):
            continue
        root.children = [node for node in root.children if node.attributes.get(MARK) != device]
    sensors = tuple(
        each.attributes.get("name", "").strip()
        for node in root.children
        if node.attributes.get(MARK)
        for each in node.children
        if each.tag == "sensor"
    )
    for node in root.children:
        if MARK in node.attributes or SPARE in node.attributes:
            kept = {k: v for k, v in node.attributes.items() if k not in (MARK, SPARE)}
            node.set_attributes(kept)
    return sensors


def _is_sensed(device: str, own: Iterable[Node], parts: Iterable[Node]) -> bool:
    """Whether the robot's files attach a sensor to a link of the device."""
    links = _links_below(device, [*own, *parts])
    return any(
        node.tag == "gazebo"
        and node.attributes.get("reference", "").strip() in links
        and any(each.tag == "sensor" for each in node.children)
        for node in own
    )


def _names(nodes: Iterable[Node]) -> set[tuple[str, str]]:
    """The tags and names of links and joints."""
    return {
        (node.tag, node.attributes.get("name", "").strip())
        for node in nodes
        if node.tag in ("link", "joint")
    }


def _links_below(root: str, nodes: Iterable[Node]) -> set[str]:
    """The link and all links that joints attach to it, directly or through other links."""
    below: dict[str, list[str]] = {}
    for node in nodes:
        if node.tag == "joint":
            ends = {
                each.tag: each.attributes.get("link", "").strip()
                for each in node.children
                if each.tag in ("parent", "child")
            }
            below.setdefault(ends.get("parent", ""), []).append(ends.get("child", ""))
    found = {root}
    waiting = [root]
    while waiting:
        for link in below.get(waiting.pop(), ()):
            if link not in found:
                found.add(link)
                waiting.append(link)
    return found
