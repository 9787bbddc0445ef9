"""Tags that belong in a link or joint."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import nodes
from cartwheel.checks.reported import diagnostics_of, has_place
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import tags as codes
from cartwheel.description.elements.node import Node
from cartwheel.errors import Diagnostic


@rule(codes.TAG_MISPLACED)
def tag_misplaced(subject: Subject) -> Iterator[Diagnostic]:
    blocks: dict[tuple[int, str], list[tuple[Node, Diagnostic]]] = {}
    for diagnostic in diagnostics_of(subject):
        if not has_place(diagnostic):
            continue
        node = subject.node_at(diagnostic.origin)
        block = subject.holder_of(node) if node is not None else None
        if node is not None and block is not None:
            key = (id(block), str(diagnostic.values["needs"]))
            blocks.setdefault(key, []).append((node, diagnostic))
    for (_, needs), misplaced in blocks.items():
        first, diagnostic = misplaced[0]
        block = subject.holder_of(first) or first
        reference = str(diagnostic.values["reference"])
        meant = _meant_by(subject, nodes.text_of(block, "reference"), needs)
        alone = len(misplaced) == len(block.children)
        tags = tuple(dict.fromkeys(node.tag for node, _ in misplaced))
        message = diagnostic.message
        if len(misplaced) > 1:
            names = ", ".join(f"<{tag}>" for tag in tags)
            other = "joint" if needs == "link" else "link"
            message = f"{names} have no effect in a <gazebo> without a reference"
            if reference:
                message = f"{names} have no effect because they apply only to {needs}s, but "
                message += f'"{reference}" is a {other}'
        yield codes.TAG_MISPLACED.diagnostic(
            message,
            origin=block.origin if meant and alone else first.origin,
            instead=f'reference="{meant}"' if meant else "",
            place="attribute" if meant and alone else "",
            mark="reference" if meant and alone else "",
            hint="" if meant else 'Write a separate <gazebo reference="…"> for this.',
            values={"tags": tags, "needs": needs, "reference": reference, "meant": meant},
        )


def _meant_by(subject: Subject, reference: str, needs: str) -> str:
    """The link that a joint moves, or the joint that moves a link."""
    for joint in nodes.children(subject.root, "joint"):
        child = nodes.text_of(nodes.child(joint, "child"), "link")
        if needs == "link" and nodes.name_of(joint) == reference:
            return child
        if needs == "joint" and child == reference:
            return nodes.name_of(joint)
    return ""
