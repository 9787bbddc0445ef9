"""Collisions to which contact sensors refer."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import edits, nodes, spelling
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element, Sensor
from cartwheel.errors import Diagnostic

_LUMP = "_fixed_joint_lump__"


@rule(devices_codes.CONTACT_COLLISION_UNKNOWN)
def contact_collision_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot, sensor, asked in _watched(subject):
        name = asked.text.strip()
        if robot.uncovered or sensor.link in robot.cut or not robot.is_placed:
            continue  # the name may belong to a missing mesh or an unreadable element
        if name.rpartition("::")[2] in _spellings(robot):
            continue
        known = {one for names in _gazebo_names(robot).values() for one in names}
        own = _gazebo_names(robot).get(sensor.link, [])
        near = spelling.meant(name, known) or (own[0] if own else "")
        yield devices_codes.CONTACT_COLLISION_UNKNOWN.diagnostic(
            message=f'contact sensor "{sensor.name}" refers to the collision "{name}", which does '
            "not exist, so it never reports a contact",
            values={"sensor": sensor.name, "collision": name, "meant": near},
            origin=asked.origin,
            instead=nodes.written("collision", {}, near) if near else "",
            place="element" if near else "",
            mark=name,
            hint=_all_spellings(robot, sensor.link),
        )


@rule(devices_codes.CONTACT_NEVER_FIRES)
def contact_never_fires(subject: Subject) -> Iterator[Diagnostic]:
    if not subject.is_urdf:
        return
    for robot, sensor, asked in _watched(subject):
        name = asked.text.strip().rpartition("::")[2]
        if _LUMP in name or any(name in names for names in _gazebo_names(robot).values()):
            continue
        target = _spellings(robot).get(name)
        if target is None or not robot.is_placed:
            continue
        link, index = target
        root = robot.merged_root(link)
        if root == link:
            continue  # a variant of the collision's own name, which Gazebo may or may not accept
        right = _gazebo_names(robot)[link][index]
        yield devices_codes.CONTACT_NEVER_FIRES.diagnostic(
            message=f'Gazebo 11 merges "{link}" into "{root}" and renames the collision '
            f'"{name}", so sensor "{sensor.name}" never reports a contact',
            values={"sensor": sensor.name, "collision": name, "link": link, "root": root},
            **edits.whole(asked, nodes.written("collision", {}, right), mark=name),
        )


def _watched(subject: Subject) -> Iterator[tuple[Robot, Sensor, Element]]:
    for robot in subject.robots:
        for _, sensor in robot.sensors():
            contact = sensor.element.find("contact")
            for asked in contact.find_all("collision") if contact is not None else ():
                if asked.text.strip() not in ("", "__default__"):
                    yield robot, sensor, asked


def _spellings(robot: Robot) -> dict[str, tuple[str, int]]:
    """The link and collision index for each accepted spelling of a name."""
    return {
        name: (link.name, index)
        for link in robot.description.links
        for index, collision in enumerate(link.collisions)
        for name in (*collision.aliases, collision.name)
    }


def _gazebo_names(robot: Robot) -> dict[str, list[str]]:
    """Names of the collisions in Gazebo 11, by link."""
    if robot.root is None:
        return {
            link.name: [collision.name for collision in link.collisions]
            for link in robot.description.links
        }
    names: dict[str, list[str]] = {}
    counts: dict[str, int] = {}
    for link in _parents_first(robot):
        root = robot.merged_root(link)
        for collision in robot.links[link].collisions:
            count = counts.get(root, 0)
            counts[root] = count + 1
            number = f"_{count}" if count else ""
            name = collision.name if root == link else f"{root}{_LUMP}{link}_collision{number}"
            names.setdefault(link, []).append(name)
    return names


def _parents_first(robot: Robot) -> list[str]:
    order = [name for name in robot.links if name not in robot.inbound]
    order += [
        n for n, j in robot.inbound.items() if j.parent not in robot.links and n in robot.links
    ]
    for name in order:
        order.extend(
            joint.child
            for joint in robot.description.joints
            if joint.parent == name and joint.child in robot.links and joint.child not in order
        )
    return order


def _all_spellings(robot: Robot, link: str) -> str:
    found = robot.links[link].collisions if link in robot.links else ()
    if not found:
        return f'The link "{link}" has no collision.'
    right = _gazebo_names(robot).get(link, [])
    others = [name for c in found for name in (c.name, *c.aliases) if name not in right][:4]
    text = f'In Gazebo 11, the collision of "{link}" is named {", ".join(right[:4])}.'
    return text + (f" Cartwheel also accepts {', '.join(others)}." if others else "")
