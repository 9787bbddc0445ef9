"""Whether the base that wheels drive is free to move."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import drives_in
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Joint
from cartwheel.errors import Diagnostic

_WORLD = "world"


@rule(robot_codes.BASE_FIXED)
def base_fixed(subject: Subject) -> Iterator[Diagnostic]:
    for robot, drive in drives_in(subject):
        wheels = [robot.joints[name] for name in drive.joints if name in robot.joints]
        if not wheels:
            continue
        holder = _holder(robot, wheels[0].parent)
        if holder is None and not robot.description.static:
            continue
        if holder is None:
            why, hint = "the model is static", "Remove <static>."
            values = {"plugin": drive.tag.filename}
        else:
            why = f'joint "{holder.name}" fixes it to the world'
            link = "" if subject.in_sdf(holder.origin) else f' and the link "{_WORLD}"'
            hint = f"Remove the joint{link}."
            values = {"plugin": drive.tag.filename, "joint": holder.name}
        yield robot_codes.BASE_FIXED.diagnostic(
            message=f'plugin "{drive.tag.filename}" cannot drive the robot, because {why}',
            values=values,
            origin=drive.tag.origin if holder is None else holder.origin,
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
