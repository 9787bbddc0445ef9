"""Whether wheels are round, and their middle is on their axis."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import nodes
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import (
    ROUND,
    is_across,
    passive_axle,
    wheel_joints,
    wheel_offset,
    wheel_widths,
)
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Cylinder, Joint
from cartwheel.description.solids import Floats
from cartwheel.errors import Diagnostic

_CIRCULAR = 0.95
"""Minimum ratio of the widths of a wheel that is a circle."""
_OFF_AXIS = 0.05
"""Part of a wheel's radius by which its middle may be off its axis."""
_UPRIGHT = {"x": 'rpy="0 1.5708 0"', "y": 'rpy="1.5708 0 0"', "z": 'rpy="0 0 0"'}
"""Rotation that aligns a cylinder with the joint axis, by joint axis."""


@rule(robot_codes.WHEEL_NOT_ROUND)
def wheel_not_round(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        driven = wheel_joints(robot)
        what = "driven wheel" if driven else "wheel"
        for joint in driven or _lying(robot):
            link = robot.links[joint.child]
            widths = wheel_widths(robot, joint, robot.collisions)
            # Misaligned axes are reported by another rule.
            if widths is None or not is_across(robot, joint) or not robot.whole(link.name):
                continue
            if widths.min() >= ROUND * widths.max():
                yield from _off_axis(robot, joint, widths, what)
                continue
            collision, text = link.collisions[0] if link.collisions else None, ""
            node = robot.node_at(collision.origin) if collision is not None else None
            origin = nodes.child(node, "origin")
            if collision is not None and isinstance(collision.shape, Cylinder):
                text = _UPRIGHT.get(
                    max("xyz", key=lambda a: abs(joint.axis.xyz["xyz".index(a)])), ""
                )
            alone = node is not None and bool(text) and len(link.collisions) == 1
            yield robot_codes.WHEEL_NOT_ROUND.diagnostic(
                message=f'the collision of the {what} "{link.name}" is not round: seen along '
                f"the joint axis, its width varies from {widths.min():.3g} m to "
                f"{widths.max():.3g} m",
                values={
                    "link": link.name,
                    "widest": float(widths.max()),
                    "narrowest": float(widths.min()),
                },
                origin=origin.origin
                if origin is not None
                else (collision.origin if collision is not None else link.origin),
                instead="" if not alone else text if origin is not None else f"<origin {text}/>",
                place="" if not alone else "attribute" if origin is not None else "inside",
                mark="rpy" if origin is not None else "",
                hint="A cylinder's axis is z. Rotate the collision to align z with the joint axis."
                if text
                else "",
            )


def _off_axis(robot: Robot, joint: Joint, widths: Floats, what: str) -> Iterator[Diagnostic]:
    """A round wheel whose middle is not on its axis, so that the robot rises and sinks."""
    radius, offset = float(widths.max()) / 2, wheel_offset(robot, joint)
    if widths.min() < _CIRCULAR * widths.max() or not _OFF_AXIS * radius < offset < radius:
        return
    link = robot.links[joint.child]
    yield robot_codes.WHEEL_NOT_ROUND.diagnostic(
        message=f'the middle of the collision of the {what} "{link.name}" is {offset:.3g} m off '
        f'the axis of joint "{joint.name}", so the robot rises and sinks when the wheel turns',
        values={"link": link.name, "offset": offset, "radius": radius},
        origin=link.collisions[0].origin if link.collisions else link.origin,
        hint="Move the collision's <origin> so that its middle is on the axis.",
    )


def _lying(robot: Robot) -> Iterator[Joint]:
    """The joints of undriven wheels on an axle whose only collision is a disc that lies flat."""
    for joint in (robot.joints[name] for name in passive_axle(robot, ())):
        for disc in robot.links[joint.child].collisions[:1]:
            shape = disc.shape
            if isinstance(shape, Cylinder) and shape.length < 2.0 * shape.radius:
                yield joint
