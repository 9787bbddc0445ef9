"""What is valid in a description, but cannot be simulated."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import world as world_codes
from cartwheel.description.idle_settings import OF_SOLVER, VELOCITY_LIMIT, idle_settings
from cartwheel.description.model import Plane
from cartwheel.errors import Diagnostic


@rule(world_codes.PLANE_NOT_STATIC)
def plane_not_static(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for link in robot.description.links:
            planes = [each for each in link.collisions if isinstance(each.shape, Plane)]
            if planes and _moves(robot, link.name):
                yield world_codes.PLANE_NOT_STATIC.diagnostic(
                    f'collision "{planes[0].name}" is an infinite plane, but link "{link.name}" '
                    "can move, so the model cannot be simulated",
                    origin=planes[0].origin,
                    values={"collision": planes[0].name, "link": link.name},
                    hint="Use a flat box instead, <static>true</static>, or a fixed joint to the "
                    "world.",
                )


def _moves(robot: Robot, name: str) -> bool:
    """Whether a link is known to be free to move."""
    root = robot.rigid_root(name)
    if robot.description.static or name not in robot.placed or root in robot.cut:
        return False
    holder = robot.inbound.get(root)
    if holder is not None:
        return holder.type != "fixed"
    return not robot.links[root].kinematic


@rule(world_codes.PHYSICS_SETTING_IGNORED)
def physics_setting_ignored(subject: Subject) -> Iterator[Diagnostic]:
    # URDF requires a velocity limit.
    usual = OF_SOLVER | {VELOCITY_LIMIT} if subject.is_urdf else OF_SOLVER
    for each in idle_settings(robot.description for robot in subject.robots):
        if each.values["setting"] not in usual:
            yield each
