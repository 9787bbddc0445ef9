"""Whether the velocity limits of wheels let a base drive."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.checks.wheels import gz_wheels, wheel_radius
from cartwheel.codes import robot as robot_codes
from cartwheel.dialects.catalogue import short_name
from cartwheel.errors import Diagnostic

_FREE = "gazebo_ros2_control"
"""The plugin whose controllers do not respect them."""
_SLOW = 0.05
"""m/s; a base that is slower is not meant."""


@rule(robot_codes.WHEEL_SPEED_LIMITED)
def wheel_speed_limited(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for name in _limited(robot):
            joint = robot.joints.get(name)
            if joint is None or not joint.turns or not joint.axis.velocity:
                continue
            radius = wheel_radius(robot, joint)
            if not radius or not robot.whole(joint.child) or joint.axis.velocity < 0:
                continue
            speed = joint.axis.velocity * radius
            if speed >= _SLOW:
                continue
            yield robot_codes.WHEEL_SPEED_LIMITED.diagnostic(
                message=f'the velocity limit of the wheel joint "{name}", '
                f"{joint.axis.velocity:g} rad/s, limits the speed of the robot to {speed:.2g} m/s",
                values={"joint": name, "limit": joint.axis.velocity, "speed": speed},
                origin=joint.origin,
                hint=f"Increase the limit. At 1 m/s, the wheel turns at {1 / radius:.3g} rad/s.",
            )


def _limited(robot: Robot) -> list[str]:
    """The driven wheels whose drive respects their velocity limits."""
    names = gz_wheels(robot)
    plugins = [short_name(tag.filename) for tag in robot.description.plugins]
    managers = [each for each in plugins if "ros_control" in each or "ros2_control" in each]
    if managers and _FREE not in managers:
        names += [name for sides in robot.controlled for side in sides for name in side]
    return list(dict.fromkeys(names))
