"""Whether wheels are round."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import nodes
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import ROUND, is_across, passive_axle, wheel_joints, wheel_widths
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Cylinder, Joint
from cartwheel.errors import Diagnostic

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


def _lying(robot: Robot) -> Iterator[Joint]:
    """The joints of undriven wheels on an axle whose only collision is a disc that lies flat."""
    for joint in (robot.joints[name] for name in passive_axle(robot, ())):
        for disc in robot.links[joint.child].collisions[:1]:
            shape = disc.shape
            if isinstance(shape, Cylinder) and shape.length < 2.0 * shape.radius:
                yield joint
