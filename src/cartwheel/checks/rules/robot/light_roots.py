"""Light root links that nothing holds, although the robot's motors push against them."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Joint
from cartwheel.errors import Diagnostic

_LIGHT = 1e-3
"""Maximum mass of such a root relative to the robot's."""


@rule(robot_codes.ROOT_NOT_HELD)
def light_roots(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        if robot.description.static or any(
            joint.parent == "world" for joint in robot.description.joints
        ):
            continue
        roots = [name for name in robot.links if name not in robot.inbound]
        if len(roots) != 1 or robot.description.mass <= 0:
            continue
        joints = _chain(robot, roots[0])
        if not any(joint.name in robot.driven for joint in joints):
            continue
        first = joints[0]
        yield robot_codes.ROOT_NOT_HELD.diagnostic(
            message=f'nothing holds the root link "{first.parent}", which has no collision and '
            f'almost no mass, so the motor of "{joints[-1].name}" turns the root instead of the '
            "robot",
            values={"link": first.parent, "joints": tuple(joint.name for joint in joints)},
            origin=robot.links[roots[0]].origin,
            hint=f'Add a link named "world" and a fixed joint from it to "{roots[0]}".',
        )


def _chain(robot: Robot, root: str) -> list[Joint]:
    """The movable joints from the root up to the first link with a collision or with a mass."""
    found: list[Joint] = []
    part = root
    while True:
        group = robot.rigid_groups[robot.rigid_root(part)]
        mass = sum(each.mass for name in group if (each := robot.links[name].inertial) is not None)
        heavy = mass > _LIGHT * robot.description.mass
        if heavy or any(robot.links[name].collisions for name in group):
            return found
        below = [
            joint
            for joint in robot.description.joints
            if joint.parent in group and joint.type != "fixed" and joint.child in robot.links
        ]
        if len(below) != 1 or below[0] in found:
            return []
        found.append(below[0])
        part = below[0].child
