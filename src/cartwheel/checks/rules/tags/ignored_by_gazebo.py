"""Tags that Cartwheel reads, but Gazebo ignores."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import edits, nodes
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import tags as codes
from cartwheel.errors import Diagnostic


@rule(codes.GAZEBO_IGNORES)
def gazebo_ignores(subject: Subject) -> Iterator[Diagnostic]:
    if not subject.is_urdf:
        return
    for node in nodes.children(subject.root, "gazebo"):
        on_link = bool(nodes.text_of(node, "reference"))
        for child in node.children:
            value = child.text or child.attributes.get("value", "")
            stated = [each for each in ("mu1", "mu2") if nodes.child(node, each) is not None]
            if on_link and child.tag == "mu" and stated:
                yield codes.GAZEBO_IGNORES.diagnostic(
                    message="Gazebo ignores <mu> in this element, and uses "
                    f"{' and '.join(f'<{each}>' for each in stated)}",
                    severity="info",
                    origin=child.origin,
                    hint="Remove <mu>.",
                )
            elif on_link and child.tag == "mu":
                yield codes.GAZEBO_IGNORES.diagnostic(
                    message="Gazebo ignores <mu> in this element, so the friction coefficient is 1",
                    **edits.whole(child, f"<mu1>{value}</mu1><mu2>{value}</mu2>"),
                )
            elif not on_link and child.tag == "selfCollide":
                yield codes.GAZEBO_IGNORES.diagnostic(
                    message="Gazebo supports <selfCollide> only for links; for the whole robot, "
                    "use <self_collide>",
                    **edits.whole(child, f"<self_collide>{value}</self_collide>"),
                )
