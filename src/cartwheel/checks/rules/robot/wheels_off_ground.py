"""Whether the driven wheels touch the ground."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import lowest, wheel_joints, wheel_links, wheel_radius
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Link
from cartwheel.errors import Diagnostic


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


def _rolls(robot: Robot, link: Link) -> bool:
    """Whether the link is an undriven wheel or a caster, which is meant to touch the ground."""
    holder = robot.inbound.get(link.name)
    moves = holder is not None and holder.type in ("continuous", "ball", "revolute", "prismatic")
    name = link.name.lower()
    return moves or any(word in name for word in ("caster", "castor", "wheel", "roller", "ball"))
