"""Whether the base that wheels drive is free to move."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cartwheel.checks.controller_claims import base_controllers, wheels_of
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import drives_in
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Joint
from cartwheel.errors import Diagnostic, Origin

_WORLD = "world"


@rule(robot_codes.BASE_FIXED)
def base_fixed(subject: Subject) -> Iterator[Diagnostic]:
    for robot, drive in drives_in(subject):
        name = drive.tag.filename
        wheels = [robot.joints[each] for each in drive.joints if each in robot.joints]
        yield from _held(
            subject, robot, wheels, f'plugin "{name}"', {"plugin": name}, drive.tag.origin
        )
    for robot, controller in base_controllers(subject):
        wheels = [robot.joints[each] for each in wheels_of(robot, controller)]
        name = controller.name
        values = {"controller": name, "type": controller.kind}
        origin = controller.type.origin
        yield from _held(subject, robot, wheels, f'controller "{name}"', values, origin)


def _held(
    subject: Subject,
    robot: Robot,
    wheels: Sequence[Joint],
    what: str,
    values: dict[str, str],
    origin: Origin,
) -> Iterator[Diagnostic]:
    """The finding that something cannot drive a robot.

    Args:
        subject: The description.
        robot: The robot.
        wheels: The joints that turn its wheels; nothing is reported without any.
        what: A noun phrase for what drives it.
        values: The values of the finding.
        origin: The place that states what drives it.
    """
    holder = next(filter(None, (_holder(robot, each.parent) for each in wheels)), None)
    if not wheels or (holder is None and not robot.description.static):
        return
    if holder is None:
        why, hint = "the model is static", "Remove <static>."
    else:
        why = f'joint "{holder.name}" fixes it to the world'
        link = "" if subject.in_sdf(holder.origin) else f' and the link "{_WORLD}"'
        hint = f"Remove the joint{link}."
        values, origin = {**values, "joint": holder.name}, holder.origin
    yield robot_codes.BASE_FIXED.diagnostic(
        message=f"{what} cannot drive the robot, because {why}",
        values=values,
        origin=origin,
        hint=hint,
    )


def _holder(robot: Robot, link: str) -> Joint | None:
    """The fixed joint between the world and the links that are rigidly connected to a link."""
    seen = set[str]()
    while link not in seen and link in robot.inbound and robot.inbound[link].type == "fixed":
        seen.add(link)
        joint = robot.inbound[link]
        if joint.parent == _WORLD:
            return joint
        link = joint.parent
    return None
