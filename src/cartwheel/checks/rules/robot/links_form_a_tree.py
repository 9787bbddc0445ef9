"""Joints connect all links to one tree."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import nodes, spelling
from cartwheel.checks.kinematic_tree import (
    elements_of,
    ends,
    inbound_joints,
    link_names,
    main_root,
    rings,
)
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.elements.node import Node
from cartwheel.errors import Diagnostic


@rule(robot_codes.MULTIPLE_PARENTS)
def two_parents(subject: Subject) -> Iterator[Diagnostic]:
    holders: dict[str, Node] = {}
    known = link_names(subject)
    for joint in elements_of(subject, "joint"):
        _, child = ends(joint)
        if child not in known:
            continue
        if child in holders:
            first = holders[child]
            yield robot_codes.MULTIPLE_PARENTS.diagnostic(
                message=f'link "{child}" is the child of two joints, "{nodes.name_of(first)}" '
                f'and "{nodes.name_of(joint)}"',
                values={
                    "link": child,
                    "joint": nodes.name_of(joint),
                    "other": nodes.name_of(first),
                },
                origin=joint.origin,
                mark=f'name="{nodes.name_of(joint)}"',
                hint="Remove one of the joints, or give each joint a separate child link. Joint "
                f'"{nodes.name_of(first)}" is defined at {first.origin}.',
            )
        holders.setdefault(child, joint)


@rule(robot_codes.KINEMATIC_LOOP)
def links_in_a_ring(subject: Subject) -> Iterator[Diagnostic]:
    holders = inbound_joints(elements_of(subject, "joint"), link_names(subject))
    for ring in rings(holders):
        yield robot_codes.KINEMATIC_LOOP.diagnostic(
            message=f"joints connect links in a loop: {' -> '.join(reversed([*ring, ring[0]]))}",
            values={"links": tuple(reversed(ring))},
            origin=holders[ring[0]].origin,
            hint="Reverse or remove one of these joints.",
        )


@rule(robot_codes.MULTIPLE_ROOTS)
def several_roots(subject: Subject) -> Iterator[Diagnostic]:
    links = elements_of(subject, "link")
    holders = inbound_joints(elements_of(subject, "joint"), link_names(subject), all_of_them=True)
    roots = [node for node in links if nodes.name_of(node) not in holders]
    first = main_root(roots, elements_of(subject, "joint"))
    known = link_names(subject)
    # A joint with a misspelt child link is reported by another rule.
    misspelt = {spelling.meant(ends(joint)[1], known) for joint in elements_of(subject, "joint")}
    for node in roots:
        name = nodes.name_of(node)
        if node is first or first is None or not name or name == nodes.name_of(first):
            continue
        if name in misspelt:
            continue
        root = nodes.name_of(first)
        yield robot_codes.MULTIPLE_ROOTS.diagnostic(
            message=f'no joint connects link "{name}" to "{root}", the root of the robot',
            values={"link": name, "root": root},
            origin=node.origin,
            instead=f'<joint name="{name}_joint" type="fixed"><parent link="{root}"/>'
            f'<child link="{name}"/></joint>',
            place="after",
            mark=f'name="{node.attributes["name"]}"',
        )
