"""Names and the kinematic tree: references and whether their targets exist."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cartwheel.checks import nodes, spelling
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.node import Node
from cartwheel.errors import Diagnostic

WORLD = "world"
JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")


@rule(robot_codes.DUPLICATE_NAME)
def name_twice(subject: Subject) -> Iterator[Diagnostic]:
    for tag in ("link", "joint"):
        seen: dict[str, Node] = {}
        taken = {nodes.name_of(node) for node in _parts(subject, tag)}
        for node in _parts(subject, tag):
            name = nodes.name_of(node)
            if not name or name not in seen:
                seen[name] = node
                continue
            new = next(f"{name}_{i}" for i in range(2, 99) if f"{name}_{i}" not in taken)
            taken.add(new)
            yield robot_codes.DUPLICATE_NAME.diagnostic(
                message=f'two {tag}s have the name "{name}"',
                values={"tag": tag, "name": name},
                hint=f"The first is at {seen[name].origin}.",
                origin=node.origin,
                instead=f'name="{new}"',
                place="attribute",
                mark=f'name="{node.attributes["name"]}"',
            )


@rule(robot_codes.NAME_MISSING)
def name_missing(subject: Subject) -> Iterator[Diagnostic]:
    parts = [*_parts(subject, "link"), *_parts(subject, "joint")]
    sensors = [node for node in nodes.walk(subject.root) if node.tag == "sensor"]
    for node in (*parts, *(each for each in sensors if each.children)):
        if not nodes.name_of(node):
            new = f"{nodes.text_of(node, 'type') or 'new'}_{node.tag}"
            yield robot_codes.NAME_MISSING.diagnostic(
                message=f"this <{node.tag}> has no name",
                values={"tag": node.tag},
                origin=node.origin,
                instead=f'name="{new}"',
                place="attribute",
            )


@rule(robot_codes.JOINT_LINK_UNKNOWN)
def joint_link_unknown(subject: Subject) -> Iterator[Diagnostic]:
    known = link_names(subject)
    for joint in _parts(subject, "joint"):
        name = nodes.name_of(joint)
        for which in ("parent", "child"):
            end = nodes.child(joint, which)
            if end is None:
                yield robot_codes.JOINT_LINK_UNKNOWN.diagnostic(
                    message=f'joint "{name}" has no <{which}>',
                    values={"joint": name, "tag": which},
                    origin=joint.origin,
                    hint=f'Add <{which} link="…"/> to the joint.',
                )
                continue
            link = nodes.text_of(end, "link")
            if link in known:
                continue
            if link == WORLD and which == "parent":
                yield robot_codes.JOINT_LINK_UNKNOWN.diagnostic(
                    message=f'the parent of joint "{name}" is "world", but the robot has no '
                    "such link",
                    values={"joint": name, "link": link, "tag": which},
                    origin=end.origin,
                    instead='<link name="world"/>',
                    mark=link,
                    hint="Add it to fix the robot to the world.",
                )
                continue
            yield spelling.misspelt(
                robot_codes.JOINT_LINK_UNKNOWN,
                link,
                known,
                attribute="link",
                message=f'the {which} of joint "{name}" is "{link}", which is not a link',
                values={"link": link, "joint": name, "tag": which},
                origin=end.origin,
                mark=f'link="{end.attributes.get("link", "")}"',
            )


@rule(robot_codes.JOINT_TYPE_UNKNOWN)
def joint_type_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for joint in _parts(subject, "joint"):
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


@rule(robot_codes.MULTIPLE_PARENTS)
def two_parents(subject: Subject) -> Iterator[Diagnostic]:
    holders: dict[str, Node] = {}
    known = link_names(subject)
    for joint in _parts(subject, "joint"):
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
                f'"{nodes.name_of(first)}" is at {first.origin}.',
            )
        holders.setdefault(child, joint)


@rule(robot_codes.KINEMATIC_LOOP)
def links_in_a_ring(subject: Subject) -> Iterator[Diagnostic]:
    holders = inbound(_parts(subject, "joint"), link_names(subject))
    for ring in rings(holders):
        yield robot_codes.KINEMATIC_LOOP.diagnostic(
            message=f"joints connect links in a loop: {' -> '.join(reversed([*ring, ring[0]]))}",
            values={"links": tuple(reversed(ring))},
            origin=holders[ring[0]].origin,
            hint="Reverse or remove one of these joints.",
        )


@rule(robot_codes.MULTIPLE_ROOTS)
def several_roots(subject: Subject) -> Iterator[Diagnostic]:
    links = _parts(subject, "link")
    holders = inbound(_parts(subject, "joint"), link_names(subject), all_of_them=True)
    roots = [node for node in links if nodes.name_of(node) not in holders]
    first = main_root(roots, _parts(subject, "joint"))
    known = link_names(subject)
    # A joint with a misspelt child link is reported by another rule.
    misspelt = {spelling.meant(ends(joint)[1], known) for joint in _parts(subject, "joint")}
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


@rule(robot_codes.MIMIC_UNKNOWN)
def mimic_unknown(subject: Subject) -> Iterator[Diagnostic]:
    joints = {nodes.name_of(node): node for node in _parts(subject, "joint")}
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
    known = link_names(subject) | {nodes.name_of(node) for node in _parts(subject, "joint")}
    for node in _parts(subject, "gazebo"):
        reference = nodes.text_of(node, "reference")
        if not reference or reference in known:
            continue
        yield spelling.misspelt(
            robot_codes.REFERENCE_UNKNOWN,
            reference,
            known,
            attribute="reference",
            message=f'<gazebo> refers to "{reference}", which is neither a link nor a joint, '
            "so Gazebo ignores it",
            values={"reference": reference},
            origin=node.origin,
            mark=f'reference="{node.attributes["reference"]}"',
        )


def link_names(subject: Subject) -> set[str]:
    """Names of all links in a URDF."""
    return {nodes.name_of(node) for node in _parts(subject, "link")}


def ends(joint: Node) -> tuple[str, str]:
    """Parent and child link of a joint."""
    return (
        nodes.text_of(nodes.child(joint, "parent"), "link"),
        nodes.text_of(nodes.child(joint, "child"), "link"),
    )


def rings(holders: Mapping[str, Node]) -> list[list[str]]:
    """Loops of joints, each as a list of links from child to parent.

    Args:
        holders: The parent joint of each link, as returned by `inbound`.
    """
    parents = {link: ends(joint)[0] for link, joint in holders.items()}
    found: list[list[str]] = []
    seen: set[str] = set()
    for start in parents:
        path: dict[str, None] = {}
        link = start
        while link in parents and link not in seen and link not in path:
            path[link] = None
            link = parents[link]
        if link in path:
            ring = list(path)
            found.append(ring[ring.index(link) :])
        seen.update(path)
    return found


def inbound(joints: list[Node], links: set[str], *, all_of_them: bool = False) -> dict[str, Node]:
    """The parent joint of each link; joints to unknown links only with `all_of_them`."""
    found: dict[str, Node] = {}
    for joint in joints:
        parent, child = ends(joint)
        if all_of_them or (parent in links and child in links and parent != child):
            found.setdefault(child, joint)
    return found


def main_root(roots: list[Node], joints: list[Node]) -> Node | None:
    """The root link with the largest subtree; the other roots are disconnected."""
    if not roots:
        return None
    below: dict[str, list[str]] = {}
    for joint in joints:
        parent, child = ends(joint)
        below.setdefault(parent, []).append(child)

    def carried(node: Node) -> int:
        seen = {nodes.name_of(node)}
        stack = list(seen)
        while stack:
            for child in below.get(stack.pop(), ()):
                if child not in seen:
                    seen.add(child)
                    stack.append(child)
        return len(seen)

    return max(roots, key=carried)


def mimic_chain(joints: dict[str, Node], leader: str) -> list[str]:
    """The chain of joints that a mimic joint follows, starting with `leader`."""
    chain: list[str] = []
    while leader in joints and leader not in chain:
        chain.append(leader)
        mimic = nodes.child(joints[leader], "mimic")
        if mimic is None:
            break
        leader = nodes.text_of(mimic, "joint")
    return chain


def _parts(subject: Subject, tag: str) -> list[Node]:
    return nodes.children(subject.root, tag) if subject.is_urdf else []


RULES = (
    name_twice,
    name_missing,
    joint_link_unknown,
    joint_type_unknown,
    two_parents,
    links_in_a_ring,
    several_roots,
    mimic_unknown,
    reference_unknown,
)
