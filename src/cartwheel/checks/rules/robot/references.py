"""Joints and links to which mimic joints and <gazebo> elements refer."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import nodes, spelling
from cartwheel.checks.kinematic_tree import elements_of, link_names, mimic_chain
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import WITHOUT_POSITION
from cartwheel.description.urdf.gazebo_tags import referable
from cartwheel.errors import Diagnostic


@rule(robot_codes.MIMIC_UNKNOWN)
def mimic_unknown(subject: Subject) -> Iterator[Diagnostic]:
    joints = {nodes.name_of(node): node for node in elements_of(subject, "joint")}
    types = {name: nodes.text_of(joint, "type") for name, joint in joints.items()}
    for name, joint in joints.items():
        mimic = nodes.child(joint, "mimic")
        if mimic is None:
            continue
        leader = nodes.text_of(mimic, "joint")
        if leader not in joints:
            yield spelling.misspelt(
                robot_codes.MIMIC_UNKNOWN,
                leader,
                set(joints) - {name},
                attribute="joint",
                message=f'joint "{name}" mimics "{leader}", which is not a joint',
                values={"joint": name, "leader": leader},
                origin=mimic.origin,
                mark=f'joint="{mimic.attributes.get("joint", "")}"',
            )
        elif types[name] == "fixed":
            continue  # it does not move in any case
        elif types[name] in WITHOUT_POSITION or types[leader] in WITHOUT_POSITION:
            yield robot_codes.MIMIC_UNKNOWN.diagnostic(
                message=f'joint "{name}" is {types[name]}, so it cannot mimic "{leader}"'
                if types[name] in WITHOUT_POSITION
                else f'joint "{name}" mimics "{leader}", which is {types[leader]}',
                values={"joint": name, "leader": leader},
                origin=mimic.origin,
                mark=f'joint="{leader}"',
                hint="Only joints that turn about or slide along an axis can mimic each other.",
            )
        elif name in mimic_chain(joints, leader):
            yield robot_codes.MIMIC_UNKNOWN.diagnostic(
                message=f'joint "{name}" mimics itself'
                + (f' through "{leader}"' if leader != name else ""),
                values={"joint": name, "leader": leader},
                origin=mimic.origin,
                mark=f'joint="{leader}"',
                hint="One joint in the loop must be free to move.",
            )


@rule(robot_codes.REFERENCE_UNKNOWN)
def reference_unknown(subject: Subject) -> Iterator[Diagnostic]:
    links = link_names(subject)
    joints = {nodes.name_of(node) for node in elements_of(subject, "joint")}
    for node in elements_of(subject, "gazebo"):
        reference = nodes.text_of(node, "reference")
        if not reference or reference in links | joints:
            continue
        yield spelling.misspelt(
            robot_codes.REFERENCE_UNKNOWN,
            reference,
            referable(node, links, joints),
            attribute="reference",
            message=f'<gazebo> refers to "{reference}", which is neither a link nor a joint, '
            "so Gazebo ignores it",
            values={"reference": reference},
            origin=node.origin,
            mark=f'reference="{node.attributes["reference"]}"',
        )
