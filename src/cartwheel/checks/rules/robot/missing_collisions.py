"""Wheels and bases without a collision."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cartwheel.checks import nodes
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import wheel_joints, wheel_links, wheel_radius
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Link
from cartwheel.description.solids import Floats
from cartwheel.errors import Diagnostic


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
        falls = any(link.gravity for link in robot.links.values())
        nowhere = falls and not any(link.collisions for link in robot.links.values())
        for root, group in robot.rigid_groups.items():
            links = [robot.links[name] for name in group]
            if root in robot.inbound or any(link.collisions for link in links):
                continue
            seen = max(
                (link for link in links if link.visuals),
                key=lambda link: max((e.extent for e in robot.visuals[link.name]), default=0.0),
                default=None,
            )
            if nowhere and root != "world":
                # Even if it looks like nothing, such as a sensor that other models include.
                seen = seen or links[0]
            if seen is None or not robot.whole(root):
                continue
            node = next(
                (n for n in nodes.children(robot.root, "link") if nodes.name_of(n) == seen.name),
                None,
            )
            yield robot_codes.BASE_WITHOUT_COLLISION.diagnostic(
                message="no link of the robot has a <collision>, so the robot falls through the "
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
