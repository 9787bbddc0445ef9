"""Angles in degrees and positions in millimetres."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cartwheel.checks import edits, nodes
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.units import FARTHEST, is_converted
from cartwheel.codes import robot as robot_codes
from cartwheel.description.elements.node import Node
from cartwheel.errors import Diagnostic

_ADDED = 4 * math.pi
"""rad; editors may accumulate angles up to this value."""


@rule(robot_codes.ANGLE_IN_DEGREES)
def angle_degrees(subject: Subject) -> Iterator[Diagnostic]:
    for node in nodes.walk(subject.root):
        text, attribute = _angles(subject, node)
        values = nodes.numbers(text, 3)
        if values is None or not any(map(_is_degrees, values)):
            continue
        radians = " ".join(
            nodes.short(math.radians(v) if abs(v) > 2 * math.pi + 0.01 or v == int(v) else v)
            for v in values
        )
        instead = f'rpy="{radians}"'
        if not attribute:
            xyz = " ".join(node.text.split()[:3])
            instead = nodes.written("pose", dict(node.attributes), f"{xyz} {radians}")
        yield robot_codes.ANGLE_IN_DEGREES.diagnostic(
            message=f"the angles {text} are read as radians: {max(values, key=abs):g} rad is "
            f"{max(map(abs, values)) / 2 / math.pi:.3g} turns",
            values={"angles": values},
            hint="Are the angles in degrees?",
            origin=node.origin,
            instead=instead,
            place="attribute" if attribute else "element",
            mark="rpy" if attribute else "",
        )


@rule(robot_codes.POSITION_IN_MILLIMETRES)
def place_millimetres(subject: Subject) -> Iterator[Diagnostic]:
    if not subject.is_urdf:
        return
    for holder in nodes.walk(subject.root):
        if holder.tag not in ("joint", "visual", "collision", "inertial"):
            continue
        origin = nodes.child(holder, "origin")
        xyz = nodes.numbers(nodes.text_of(origin, "xyz"), 3)
        if origin is None or xyz is None or math.hypot(*xyz) <= FARTHEST:
            continue
        metres = " ".join(nodes.short(value / 1000) for value in xyz)
        yield robot_codes.POSITION_IN_MILLIMETRES.diagnostic(
            message=f"the origin of this <{holder.tag}> is {math.hypot(*xyz):.4g} m away from "
            "its link",
            values={"tag": holder.tag, "distance": math.hypot(*xyz)},
            hint="Is the position in millimetres?",
            **edits.attribute(origin, "xyz", metres),
        )


def _is_degrees(value: float) -> bool:
    """Whether an angle exceeds a turn by more than an editor accumulates."""
    return abs(value) > 2 * math.pi + 0.01 and (
        abs(value) >= _ADDED or value == int(value) or is_converted(value, 0.01)
    )


def _angles(subject: Subject, node: Node) -> tuple[str, bool]:
    if subject.is_urdf and node.tag == "origin":
        return nodes.text_of(node, "rpy"), True
    if node.tag == "pose" and not node.attributes.get("degrees"):
        words = node.text.split()
        if len(words) == 6:
            return " ".join(words[3:]), False
    return "", True
