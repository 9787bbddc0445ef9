"""Tags that Cartwheel reads, but Gazebo ignores."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cartwheel.checks import edits, nodes
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import tags as codes
from cartwheel.description.elements.node import Node
from cartwheel.errors import Diagnostic, enumerated

_TAGS = {
    "collision": (
        "mu1", "mu2", "fdir1", "kp", "kd", "maxVel", "minDepth", "maxContacts", "laserRetro",
        "collision",
    ),
    "visual": ("material", "visual"),
}  # fmt: skip
"""The tags in a ``<gazebo>`` that refers to a link, by the part of the link that they are for."""
_FRICTION = ("mu1", "mu2")


@rule(codes.GAZEBO_IGNORES)
def gazebo_ignores(subject: Subject) -> Iterator[Diagnostic]:
    if not subject.is_urdf:
        return
    yield from _of_named_shapes(subject)
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


def _of_named_shapes(subject: Subject) -> Iterator[Diagnostic]:
    """Visuals and collisions to which sdformat does not apply the tags of their link.

    It recognises them by their names in SDF: NAME_collision, with the name of the link as default,
    or ROOT_fixed_joint_lump__NAME_collision if NAME does not begin with the name of the link ROOT,
    into which it has merged the link. The second form is for merged links only, and must contain
    the name of the merged link; a name that does not begin with the own link's has it as well.
    """
    stated: dict[str, list[Node]] = {}
    for node in nodes.children(subject.root, "gazebo"):
        stated.setdefault(nodes.text_of(node, "reference"), []).extend(node.children)
    for robot in subject.robots:
        for link in nodes.children(subject.root, "link"):
            name = nodes.name_of(link)
            if name in stated and name in robot.links:
                yield from _ignored(robot, link, stated[name])


def _ignored(robot: Robot, link: Node, stated: Sequence[Node]) -> Iterator[Diagnostic]:
    name = nodes.name_of(link)
    root = robot.merged_root(name)
    for kind, known in _TAGS.items():
        used = [each for each in stated if each.tag in known]
        parts = nodes.children(link, kind)
        lost = [each for each in parts if not _is_found(nodes.name_of(each), name, root, kind)]
        if not used or not lost:
            continue
        first = lost[0]
        own = nodes.name_of(first)
        called = f'the {kind} "{own}"' if own else f"the {kind}"
        more = f" and {len(lost) - 1} more" if len(lost) > 1 else ""
        tags = tuple(dict.fromkeys(each.tag for each in used))
        yield codes.GAZEBO_IGNORES.diagnostic(
            f"Gazebo ignores {enumerated(f'<{tag}>' for tag in tags)} for {called} of link "
            f'"{name}"{more}, because of its name',
            severity="warning" if any(map(_matters, used)) else "info",
            origin=first.origin,
            hint=_advice(name, root, kind),
            mark="name" if own else "",
            values={"link": name, "name": own, "tags": tags},
        )


def _is_found(own: str, link: str, root: str, kind: str) -> bool:
    """Whether sdformat applies the tags of a link to a visual or collision.

    Args:
        own: The name of the visual or collision; may be empty.
        link: The link.
        root: The link into which this one is merged; the link itself if it remains.
        kind: ``visual`` or ``collision``.
    """
    own = own or link
    if root == link:
        return own.startswith(link)
    return not own.startswith(root) and f"{own}_{kind}".startswith(f"{link}_{kind}")


def _advice(link: str, root: str, kind: str) -> str:
    if _is_found("", link, root, kind):
        return f'Remove the name of the <{kind}>, or write name="{link}".'
    return (
        f'Gazebo merges link "{link}" into "{root}", whose name is the beginning of "{link}". '
        "Rename one of the two links, or give the fixed joint <preserveFixedJoint>."
    )


def _matters(tag: Node) -> bool:
    """Whether a tag states another friction than Gazebo's default."""
    value = nodes.number(tag.text or tag.attributes.get("value", ""))
    return tag.tag in _FRICTION and value is not None and value != 1.0
