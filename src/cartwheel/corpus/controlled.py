"""The wheels on both sides of a base that controllers drive."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cartwheel.checks.robot import Robot, Sides
from cartwheel.dialects.ros_control.controller import Controller
from cartwheel.dialects.ros_control.parameters import Row, rows


def controlled_sides(robot: Robot, started: Sequence[Controller]) -> tuple[Sides, ...]:
    """Joints of the left and right wheels of each controller that drives a base.

    Args:
        robot: The robot.
        started: The controllers that run.
    """
    found = (sides for each in started for sides in _sides(robot, each))
    return tuple(dict.fromkeys(found))


def _sides(robot: Robot, controller: Controller) -> Iterator[Sides]:
    table = rows(type(controller).parameters, ros2=controller.robot.ros2)
    fields = {row.field: row for row in table}
    for row in table:
        if row.role != "wheel_separation" or len(set(row.wheels)) != 2:
            continue
        left, right = (_joints(controller, fields[field]) for field in row.wheels)
        known = all(robot.joints[name].turns for name in left + right if name in robot.joints)
        if left and right and known and {*left, *right} <= robot.joints.keys():
            yield left, right


def _joints(controller: Controller, row: Row) -> tuple[str, ...]:
    """The names of joints in a parameter."""
    values = (controller.settings.raw(name) for name in row.spelled())
    stated = next((value for value in values if value), ())
    names = [stated] if isinstance(stated, str) else stated
    return tuple(map(str, names)) if isinstance(names, list | tuple) else ()
