"""Links that collide with each other while all joints are at 0."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Mesh
from cartwheel.description.solids import Floats, hull, overlap
from cartwheel.errors import Diagnostic

PENETRATION = 0.002
"""Minimum penetration of two collisions that is reported, m."""


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
