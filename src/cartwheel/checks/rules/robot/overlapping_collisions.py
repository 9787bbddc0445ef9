"""Links that collide with each other while all joints are at 0."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.self_collision import MOST_LINKS, collides, has_mesh, overlapping
from cartwheel.errors import Diagnostic


@rule(robot_codes.OVERLAPPING_COLLISIONS)
def collisions_overlap(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        able = [
            link
            for link in robot.description.links
            if collides(robot.description, link) and link.collisions and link.name not in robot.cut
        ]
        if len(able) > MOST_LINKS or robot.description.static or not robot.is_placed:
            continue
        pairs = [
            each for each in combinations(able, 2) if not _joined(robot, each[0].name, each[1].name)
        ]
        for a, b in overlapping(pairs, robot.collisions):
            meshes = has_mesh(a) or has_mesh(b)
            subjects = "the convex hulls of" if meshes else "the collisions of"
            result = "do not collide with each other" if meshes else "push each other apart"
            yield robot_codes.OVERLAPPING_COLLISIONS.diagnostic(
                # Gazebo collides with the mesh itself, not with its convex hull.
                severity="info" if meshes else None,
                message=f'{subjects} "{a.name}" and "{b.name}" overlap when all joints are at 0, '
                f"so the links {result}",
                values={"link": a.name, "other": b.name},
                origin=b.collisions[0].origin,
                hint="Make one of the collisions smaller, or disable <selfCollide> for one of the "
                "links.",
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
