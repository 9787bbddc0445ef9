"""How the robot rests on the ground: friction, wheel and base collisions, self-collisions."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from cartwheel.checks import nodes
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.drive import lowest, wheel_joints, wheel_links, wheel_radius
from cartwheel.checks.subject import Robot, Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Link, Mesh
from cartwheel.description.node import Node
from cartwheel.description.solids import Floats, hull, overlap
from cartwheel.errors import Diagnostic

SLIPPERY = 0.01
PENETRATION = 0.002
"""Minimum penetration of two collisions that is reported, m."""


@rule(robot_codes.WHEEL_FRICTIONLESS)
def wheel_frictionless(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for joint in wheel_joints(robot):
            link = robot.links[joint.child]
            for collision in link.collisions[:1]:
                mu = [m for m in (collision.surface.mu1, collision.surface.mu2) if m is not None]
                if not mu or max(mu) >= SLIPPERY:
                    continue
                node = _surface_node(robot, link.name, "mu1")
                yield robot_codes.WHEEL_FRICTIONLESS.diagnostic(
                    message=f'the friction coefficient of the driven wheel "{link.name}" is '
                    f"{max(mu):g}, so the wheel slips",
                    values={"link": link.name, "friction": max(mu)},
                    origin=node.origin if node is not None else collision.origin,
                    instead="<mu1>1.0</mu1>" if node is not None else "",
                    place="element" if node is not None else "",
                    hint="Use the same value for <mu2>.",
                )


@rule(robot_codes.CASTER_FRICTION)
def caster_friction(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        wheels = {name for joint in wheel_joints(robot) for name in wheel_links(robot, joint)}
        if not wheels or not subject.is_urdf:
            continue
        for link in robot.description.links:
            holder = robot.inbound.get(link.name)
            if "caster" not in link.name.lower() or holder is None or holder.type != "fixed":
                continue
            if not _touches_ground(robot, link, wheels):
                continue
            collision = link.collisions[0]
            mu = collision.surface.mu1
            if (mu is not None and mu <= 0.3) or _names_nothing(subject):
                continue
            text = f'<gazebo reference="{link.name}"><mu1>0.0</mu1><mu2>0.0</mu2></gazebo>'
            yield robot_codes.CASTER_FRICTION.diagnostic(
                message=f'the caster "{link.name}" cannot roll, and its friction coefficient is '
                f"{'1, the default' if mu is None else f'{mu:g}'}",
                values={"link": link.name, "friction": mu},
                origin=collision.origin,
                instead=text,
                hint="Add these tags to the robot, or change the existing values.",
            )


@rule(robot_codes.WHEEL_WITHOUT_COLLISION)
def wheel_no_collision(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for joint in wheel_joints(robot):
            link = robot.links[joint.child]
            if any(robot.links[name].collisions for name in wheel_links(robot, joint)):
                continue
            if not robot.whole(link.name) or link.name in robot.cut:
                continue
            radius = wheel_radius(robot, joint) or 0.1
            yield robot_codes.WHEEL_WITHOUT_COLLISION.diagnostic(
                message=f'the driven wheel "{link.name}" has no <collision>, so the wheel does not '
                "touch the ground",
                values={"link": link.name},
                origin=link.origin,
                instead='<collision><origin rpy="1.5708 0 0"/><geometry>'
                f'<cylinder radius="{radius:.4g}" length="{radius / 2:.4g}"/>'
                "</geometry></collision>"
                if link.name not in robot.in_sdf
                else "",
                place="inside" if link.name not in robot.in_sdf else "",
                mark=f'name="{link.name}"',
            )


@rule(robot_codes.BASE_WITHOUT_COLLISION)
def base_no_collision(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        if robot.description.static:
            continue
        nowhere = not any(link.collisions for link in robot.links.values())
        for root, group in robot.rigid_groups.items():
            links = [robot.links[name] for name in group]
            if root in robot.inbound or any(link.collisions for link in links):
                continue
            seen = next((link for link in links if link.visuals), None)
            if seen is None or not robot.whole(root):
                continue
            node = next(
                (n for n in nodes.children(robot.root, "link") if nodes.name_of(n) == seen.name),
                None,
            )
            yield robot_codes.BASE_WITHOUT_COLLISION.diagnostic(
                message="no link in the robot has a <collision>, so the robot falls through the "
                "ground"
                if nowhere
                else f'the body "{seen.name}" has visuals but no <collision>, so it passes '
                "through everything",
                values={"link": seen.name},
                origin=seen.origin,
                instead=_collision_of(robot, seen) if node is not None else "",
                place="inside" if node is not None else "",
                mark=f'name="{seen.name}"',
            )


@rule(robot_codes.WHEELS_OFF_GROUND)
def wheels_off_ground(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        joints = wheel_joints(robot)
        parts = {name for joint in joints for name in wheel_links(robot, joint)}
        heights = [
            lowest(robot, *wheel_links(robot, joint))
            for joint in joints
            if robot.whole(joint.child)
        ]
        wheels = [height for height in heights if height is not None]
        if not wheels or robot.description.static or not robot.is_placed:
            continue
        bottom = min(wheels)
        radius = wheel_radius(robot, joints[0]) or 0.1
        for link in robot.description.links:
            if link.name in parts or link.name in robot.cut or _rolls(robot, link):
                continue
            height = lowest(robot, link.name)
            if height is None or bottom - height <= max(0.1 * radius, 0.005):
                continue
            yield robot_codes.WHEELS_OFF_GROUND.diagnostic(
                message=f'the collision of link "{link.name}" extends '
                f"{1000 * (bottom - height):.3g} mm below the driven wheels, so they do "
                "not touch the ground",
                values={"link": link.name, "depth": bottom - height},
                origin=link.collisions[0].origin,
                hint=f'Raise the collision, or lower the joint of "{joints[0].child}".',
            )


@rule(robot_codes.OVERLAPPING_COLLISIONS)
def collisions_overlap(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        able = [
            link
            for link in robot.description.links
            if (robot.description.self_collide if link.self_collide is None else link.self_collide)
            and link.collisions
            and link.name not in robot.cut
        ]
        if len(able) > 60 or robot.description.static or not robot.is_placed:
            continue
        clouds = {
            link.name: [hull(solid).placed(link.pose) for solid in robot.collisions[link.name]]
            for link in able
        }
        for a, b in combinations(able, 2):
            if _joined(robot, a.name, b.name):
                continue
            if any(
                _boxes_meet(one, other) and overlap(one, other, PENETRATION)
                for one in clouds[a.name]
                for other in clouds[b.name]
            ):
                meshes = any(isinstance(c.shape, Mesh) for c in (*a.collisions, *b.collisions))
                yield robot_codes.OVERLAPPING_COLLISIONS.diagnostic(
                    # Gazebo collides with the mesh itself, not with its convex hull.
                    severity="info" if meshes else None,
                    message=f'the collisions of "{a.name}" and "{b.name}" overlap when all '
                    "joints are at 0, so the links push each other apart",
                    values={"link": a.name, "other": b.name},
                    origin=b.collisions[0].origin,
                    hint="Make one of the collisions smaller, or disable <selfCollide> for one of "
                    "the links.",
                )


def _names_nothing(subject: Subject) -> bool:
    """Whether a <gazebo> with friction has no reference, so that its link is unknown."""
    known = {nodes.name_of(node) for node in subject.root.children if node.tag in ("link", "joint")}
    return any(
        nodes.child(node, "mu1") is not None and nodes.text_of(node, "reference") not in known
        for node in nodes.children(subject.root, "gazebo")
        if nodes.text_of(node, "reference")
    )


def _collision_of(robot: Robot, link: Link) -> str:
    points = np.concatenate(
        [solid.vertices for solid in robot.visuals[link.name]]
        or [np.zeros((1, 3)), np.ones((1, 3)) * 0.1]
    )
    size, middle = np.ptp(points, axis=0), (points.max(axis=0) + points.min(axis=0)) / 2
    return (
        f'<collision><origin xyz="{_words(middle)}"/><geometry>'
        f'<box size="{_words(np.maximum(size, 0.001))}"/></geometry></collision>'
    )


def _words(values: Floats) -> str:
    return " ".join(nodes.short(round(float(value), 4) + 0.0) for value in values)


def _surface_node(robot: Robot, link: str, tag: str) -> Node | None:
    found = None
    for node in nodes.children(robot.root, "gazebo"):
        if nodes.text_of(node, "reference") == link:
            found = nodes.child(node, tag) or found
    return found


def _touches_ground(robot: Robot, link: Link, wheels: set[str]) -> bool:
    height = lowest(robot, link.name)
    bottoms = [h for name in wheels if (h := lowest(robot, name)) is not None]
    return height is not None and bool(bottoms) and abs(height - min(bottoms)) < 0.006


def _rolls(robot: Robot, link: Link) -> bool:
    """Whether the link is an undriven wheel or a caster, which is meant to touch the ground."""
    holder = robot.inbound.get(link.name)
    moves = holder is not None and holder.type in ("continuous", "ball", "revolute", "prismatic")
    name = link.name.lower()
    return moves or any(word in name for word in ("caster", "castor", "wheel", "roller", "ball"))


def _joined(robot: Robot, a: str, b: str) -> bool:
    """Whether at most one movable joint, with any number of fixed joints, connects two links."""
    one, other = robot.rigid_root(a), robot.rigid_root(b)
    if one == other:
        return True
    for child, parent in ((one, other), (other, one)):
        holder = robot.inbound.get(child)
        if holder is None or holder.parent not in robot.links:
            continue
        if robot.rigid_root(holder.parent) == parent:
            return True
    return False


def _boxes_meet(a: Floats, b: Floats) -> bool:
    return bool((a.min(axis=0) <= b.max(axis=0)).all() and (b.min(axis=0) <= a.max(axis=0)).all())


RULES = (
    wheel_frictionless,
    caster_friction,
    wheel_no_collision,
    base_no_collision,
    wheels_off_ground,
    collisions_overlap,
)
