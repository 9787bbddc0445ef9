"""Names of links, joints and sensors."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import edits, nodes
from cartwheel.checks.kinematic_tree import elements_of
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.elements.node import Node
from cartwheel.errors import Diagnostic


@rule(robot_codes.DUPLICATE_NAME)
def name_twice(subject: Subject) -> Iterator[Diagnostic]:
    for tag in ("link", "joint"):
        seen: dict[str, Node] = {}
        taken = {nodes.name_of(node) for node in elements_of(subject, tag)}
        for node in elements_of(subject, tag):
            name = nodes.name_of(node)
            if not name or name not in seen:
                seen[name] = node
                continue
            new = next(f"{name}_{i}" for i in range(2, 99) if f"{name}_{i}" not in taken)
            taken.add(new)
            yield robot_codes.DUPLICATE_NAME.diagnostic(
                message=f'two {tag}s have the name "{name}"',
                values={"tag": tag, "name": name},
                hint=f"The first definition is at {seen[name].origin}.",
                **edits.attribute(node, "name", new, mark=f'name="{node.attributes["name"]}"'),
            )


@rule(robot_codes.NAME_MISSING)
def name_missing(subject: Subject) -> Iterator[Diagnostic]:
    parts = [*elements_of(subject, "link"), *elements_of(subject, "joint")]
    sensors = [node for node in nodes.walk(subject.root) if node.tag == "sensor"]
    for node in (*parts, *(each for each in sensors if each.children)):
        if not nodes.name_of(node):
            new = f"{nodes.text_of(node, 'type') or 'new'}_{node.tag}"
            yield robot_codes.NAME_MISSING.diagnostic(
                message=f"this <{node.tag}> has no name",
                values={"tag": node.tag},
                **edits.attribute(node, "name", new, mark=""),
            )
