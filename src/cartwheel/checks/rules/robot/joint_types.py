"""Types of joints."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import nodes, spelling
from cartwheel.checks.kinematic_tree import JOINT_TYPES, elements_of
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.errors import Diagnostic


@rule(robot_codes.JOINT_TYPE_UNKNOWN)
def joint_type_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for joint in elements_of(subject, "joint"):
        kind = joint.attributes.get("type")
        if kind is None or kind.strip() in JOINT_TYPES:
            continue
        yield spelling.misspelt(
            robot_codes.JOINT_TYPE_UNKNOWN,
            kind,
            JOINT_TYPES,
            attribute="type",
            message=f'joint "{nodes.name_of(joint)}" has the type "{kind}", which URDF does '
            "not define",
            values={"joint": nodes.name_of(joint), "type": kind},
            origin=joint.origin,
            mark="type",
        )
