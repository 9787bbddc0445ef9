"""Axes of joints."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from cartwheel.checks import edits, nodes
from cartwheel.checks.kinematic_tree import joints_with_types
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.elements.node import Node
from cartwheel.errors import Diagnostic


@rule(robot_codes.AXIS_ZERO)
def axis_zero(subject: Subject) -> Iterator[Diagnostic]:
    wheels = {name for robot in subject.robots for drive in robot.drives for name in drive.joints}
    for joint, axis, xyz in _axes(subject):
        if math.hypot(*xyz) < 1e-6:
            yield robot_codes.AXIS_ZERO.diagnostic(
                message=f'the axis of joint "{nodes.name_of(joint)}" has length 0',
                values={"joint": nodes.name_of(joint)},
                **edits.attribute(
                    axis, "xyz", "0 1 0" if nodes.name_of(joint) in wheels else "0 0 1"
                ),
            )

    yield from _zero_in_sdf(subject)


def _zero_in_sdf(subject: Subject) -> Iterator[Diagnostic]:
    """The reader's warnings about the axes of SDF, with what to write."""
    for diagnostic in subject.read.diagnostics if subject.read is not None else ():
        if diagnostic.code is not robot_codes.AXIS_ZERO or not subject.in_sdf(diagnostic.origin):
            continue
        node = subject.node_at(diagnostic.origin)
        xyz = nodes.child(node, "xyz") if node is not None else None
        if xyz is None:
            yield diagnostic
        else:
            yield replace(diagnostic, **edits.text(xyz, "0 0 1"))


@rule(robot_codes.AXIS_NOT_NORMALIZED)
def axis_not_unit(subject: Subject) -> Iterator[Diagnostic]:
    for joint, axis, xyz in _axes(subject):
        length = math.hypot(*xyz)
        # Three digits, as in 0.577, are close enough to a unit vector.
        if length >= 1e-6 and abs(length - 1) > 0.01:
            unit = " ".join(nodes.short(value / length) for value in xyz)
            yield robot_codes.AXIS_NOT_NORMALIZED.diagnostic(
                message=f'the axis of joint "{nodes.name_of(joint)}" has length {length:.3g} '
                "instead of 1",
                values={"joint": nodes.name_of(joint), "length": length},
                **edits.attribute(axis, "xyz", unit),
            )


def _axes(subject: Subject) -> Iterator[tuple[Node, Node, tuple[float, ...]]]:
    for joint, kind in joints_with_types(subject):
        axis = nodes.child(joint, "axis")
        if axis is None or kind in ("fixed", "floating"):
            continue
        xyz = nodes.numbers(axis.attributes.get("xyz"), 3)
        if xyz is not None:
            yield joint, axis, xyz
