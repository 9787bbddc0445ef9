"""Wheel separations and sizes that plugins and controllers state, compared with the robot."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np

from cartwheel.checks import controller_claims as claimed
from cartwheel.checks import nodes, plugin_tags
from cartwheel.checks.controller_files import Controller, Value
from cartwheel.checks.robot import Robot, Sides
from cartwheel.checks.subject import Subject
from cartwheel.checks.units import FARTHEST
from cartwheel.checks.wheels import axle_of, passive_axle, wheel_axis, wheel_place, wheel_tread
from cartwheel.description.model import PluginTag
from cartwheel.description.solids import Floats
from cartwheel.dialects.ros_control.controllers.wheels import wheel_radius as radius_in
from cartwheel.dialects.ros_control.parameters import SIZES
from cartwheel.dialects.ros_control.steer_bot import PARAMETERS, SIM_TYPE
from cartwheel.dialects.tag_roles import TagRole
from cartwheel.errors import Origin, Place

TOLERANCE = 0.02
"""Relative tolerance for tyre compression and rounded numbers."""
LEAST = 0.001
"""Minimum difference in a distance, m; half of it for a wheel."""
_VERTICAL = 0.9
"""Minimum vertical component of a steering axis."""

Measure = Literal["apart", "base", "reach", "radius", "diameter"]
"""``apart`` is along the axles, ``base`` is at right angles, and ``reach`` is half of their sum."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Stated:
    """A stated size."""

    robot: Robot
    measure: Measure
    label: str
    """The parameter's name in the file."""
    value: float
    written: bool
    """False for a plugin's default."""
    first: tuple[str, ...]
    """Joints of the left or front wheels; for a radius or diameter, of all wheels."""
    second: tuple[str, ...] = ()
    skids: bool = False
    """Whether several wheels on a side slide during turns."""
    origin: Origin
    mark: str
    factor: float = 1.0
    """Factor by which a controller multiplies the value."""
    multiplier: str = ""
    """Name of the parameter with this factor; empty if there is none, or one for each side."""
    measured: bool = False
    """Whether a controller measures the value itself, so that only the factor is stated."""
    write: Callable[[str], str]
    """Formats a number as replacement text."""
    place: Place
    controller: str = ""
    """The name of the controller that states it; empty if it is a plugin."""
    topic: str = ""
    """The topic of the commands of the plugin that states it; empty if it is unknown."""

    @property
    def used(self) -> float:
        """The value with which the controller computes, m."""
        return self.value * self.factor

    @property
    def owner(self) -> dict[str, str]:
        """The controller that states it, as a value of diagnostics; empty if it is a plugin."""
        return {"controller": self.controller} if self.controller else {}

    def steered_by(self, other: Stated) -> bool:
        """Whether one of the wheels is mounted on a steering joint, from which `other` measures the
        wheelbase. Such wheels do not slide, even if there are several on a side.
        """
        wheels = self.first + self.second
        steering = [name for name in other.first if name not in wheels]
        return (
            other.measure == "base"
            and other.robot is self.robot
            and any(_is_steered(self.robot, name, steering) for name in wheels)
        )


_SIDES = ("left", "right")
_MEASURES: Mapping[str, Measure] = {
    "wheel_separation": "apart",
    "wheel_base": "base",
    "wheel_radius": "radius",
    "wheel_diameter": "diameter",
    "wheel_reach": "reach",
}
"""Measures by the role of a plugin's tag or a controller's parameter."""


def stated_sizes(subject: Subject) -> Iterator[Stated]:
    """All wheel sizes stated in a description."""
    for robot in subject.robots:
        for tag in robot.description.plugins:
            for size in plugin_tags.roles(tag.filename):
                if size.role in _MEASURES:
                    yield from _of_plugin(robot, tag, size)
    for robot, file in subject.control:
        sizes = (one for each in file.controllers for one in _of_controller(robot, each))
        if any(_moves_other_joints(tag) for tag in robot.description.plugins):
            wheels = tuple(_moved_wheels(subject, robot))
            sizes = (
                replace(one, first=wheels)
                for each in file.controllers
                for one in _of_controller(robot, each, stands_in=wheels[:1])
                if wheels and one.measure == "radius"
            )
        yield from sizes


def _moved_wheels(subject: Subject, robot: Robot) -> Iterator[str]:
    """The wheels that the hardware moves, whose radius a controller of another joint states."""
    for owner, file in subject.control:
        if owner is robot:
            names = file.words(PARAMETERS, "virtual_rear_wheels")
            yield from (name for name in names if name in robot.joints)


def _moves_other_joints(tag: PluginTag) -> bool:
    """Whether the hardware moves other joints than those that controllers command."""
    return any(each.text.strip() == SIM_TYPE for each in tag.element.find_all("robotSimType"))


def controlled_sides(subject: Subject, robot: Robot) -> tuple[Sides, ...]:
    """Joints of the left and right wheels of the controllers that drive a robot.

    The joints that a steering controller turns are no wheels.
    """
    found = [
        (one.first, one.second)
        for owner, file in subject.control
        if owner is robot
        for controller in file.controllers
        for one in _of_controller(robot, controller)
        if one.measure == "apart" and one.second
        if all(_is_wheel(robot, name) for name in one.first + one.second)
    ]
    return tuple(dict.fromkeys(found))


def controlled_steering(subject: Subject, robot: Robot) -> tuple[str, ...]:
    """Joints that the steering controllers of a robot turn."""
    found = [
        name
        for owner, file in subject.control
        if owner is robot
        for controller in file.controllers
        for one in _of_controller(robot, controller)
        if one.measure == "base"
        for name in one.first
        if not _is_wheel(robot, name)
    ]
    return tuple(dict.fromkeys(found))


def _is_wheel(robot: Robot, name: str) -> bool:
    """Whether a joint turns without limits, about an axis that is not vertical."""
    joint = robot.joints[name]
    if not joint.turns or joint.child not in robot.placed:
        return joint.turns
    return abs(float(wheel_axis(robot, joint)[2])) < _VERTICAL


def _of_plugin(robot: Robot, tag: PluginTag, size: TagRole) -> Iterator[Stated]:
    measure = _MEASURES[size.role]
    groups = [_joints(robot, tag, names) for names in size.wheels]
    if measure == "base" and len(groups) == 2:
        # Some drives also drive the wheels of the steered axle.
        first, second = groups
        groups[1] = tuple(name for name in second if not _is_steered(robot, name, first)) or second
    name = next((name for name in size.tags if tag.element.find(name) is not None), "")
    written = list(tag.element.find_all(name)) if name else []
    if len({nodes.number(each.text) for each in written}) == 1:
        # Several wheel pairs with the same size.
        written = written[:1]
    for index, element in enumerate(written):
        value = nodes.number(element.text)
        # Different sizes apply to one wheel pair each.
        pick = slice(index, index + 1) if len(written) > 1 else slice(None)
        joints = _measured([group[pick] for group in groups], measure)
        if value is None or joints is None:
            continue
        yield Stated(
            robot=robot,
            measure=measure,
            label=f"<{name}>",
            value=value,
            written=True,
            first=joints[0],
            second=joints[1],
            skids=len(joints[0]) > 1,
            topic=plugin_tags.command_topic(tag),
            origin=element.origin,
            mark=element.text.strip(),
            write=lambda number, name=name: nodes.written(name, {}, number),  # type: ignore[misc]
            place="element",
        )
    joints = _measured(groups, measure)
    if not written and size.default and joints is not None:
        name = size.tags[-1] if "gazebo_ros" in tag.filename and _is_new(tag) else size.tags[0]
        yield Stated(
            robot=robot,
            measure=measure,
            label=f"<{name}>",
            value=float(size.default[0]),
            written=False,
            first=joints[0],
            second=joints[1],
            skids=len(joints[0]) > 1,
            topic=plugin_tags.command_topic(tag),
            origin=tag.origin,
            mark=tag.filename,
            write=lambda number: nodes.written(name, {}, number),
            place="inside",
        )


def _measured(
    groups: Sequence[tuple[str, ...]], measure: Measure
) -> tuple[tuple[str, ...], tuple[str, ...]] | None:
    """The joints of the measured wheels; see `Stated.first`. None if some are unknown.

    Args:
        groups: The joints between which a distance is measured, or of all wheels with a size.
        measure: What is measured.
    """
    if measure in ("radius", "diameter"):
        groups = [tuple(dict.fromkeys(name for group in groups for name in group))]
    if not all(groups):
        return None
    return groups[0], groups[1] if len(groups) == 2 else ()


def _is_steered(robot: Robot, wheel: str, steering: Sequence[str]) -> bool:
    """Whether a wheel's joint is one of the steering joints, or is mounted on one."""
    seen: set[str] = set()
    joint = robot.joints.get(wheel)
    while joint is not None and joint.name not in seen:
        if joint.name in steering:
            return True
        seen.add(joint.name)
        joint = robot.inbound.get(joint.parent)
    return False


def _is_new(tag: PluginTag) -> bool:
    """Whether the plugin uses ROS 2 tag names."""
    return any("_" in child.tag for child in tag.element.children)


def _joints(robot: Robot, tag: PluginTag, names: Sequence[str]) -> tuple[str, ...]:
    """The joints in tags with these names, or those that the plugin uses without the tags."""
    found = [
        word
        for name in names
        for element in tag.element.find_all(name)
        for word in element.text.split()
    ]
    found += [
        joint
        for spellings, joint in plugin_tags.default_joints(tag)
        if set(spellings) <= set(names)
    ]
    return tuple(name for name in found if name in robot.joints)


def _of_controller(
    robot: Robot, controller: Controller, stands_in: Sequence[str] = ()
) -> Iterator[Stated]:
    """The sizes that a controller states.

    Args:
        robot: The robot.
        controller: Its controller.
        stands_in: Joints for those that the robot does not have.
    """
    joints = {
        row.field: claimed.values(controller, row) for row in claimed.table(controller, "joint")
    }
    for row in claimed.table(controller, *SIZES):
        spellings = claimed.names(controller, row)
        value = controller.value(*spellings)
        number = value.number if value is not None else None
        times = controller.value(*(f"{each}_multiplier" for each in spellings))
        # diff_drive_controller prefers the multipliers of the sides.
        sided = [
            controller.value(*(f"{side}_{each}_multiplier" for each in spellings))
            for side in _SIDES
        ]
        groups = [joints[field] for field in row.wheels]
        if len(groups) == 2 and groups[0] is groups[1]:
            # The distance between both wheels of one axle.
            groups = [groups[0][:1], groups[0][1:2]] if len(groups[0]) == 2 else [[], []]
        sides = [tuple(_known(robot, group)) or tuple(stands_in) for group in groups]
        if row.role == "wheel_base" and len(sides) == 1:
            sides.append(passive_axle(robot, sides[0]))
        measured = _measured(sides, _MEASURES[row.role])
        written = value or times or next(filter(None, sided), None)
        if written is None or (value is not None and number is None) or measured is None:
            continue
        name = next((each for each in spellings if controller.has(each)), spellings[0])
        multiplier = f"{name}_multiplier"
        scales = claimed.has_parameter(controller, multiplier) and not any(sided)
        general = times.number if times is not None else None
        # A negative multiplier of a side turns its wheels in the other direction.
        factors = [
            general if one is None or one.number is None else abs(one.number) for one in sided
        ]
        factor = sum(1.0 if one is None else one for one in factors) / len(factors)
        one = Stated(
            robot=robot,
            measure=_MEASURES[row.role],
            label=f'"{name.rpartition("/")[2]}"',
            value=number or 0.0,
            written=True,
            first=measured[0],
            second=measured[1],
            skids=len(measured[0]) > 1,
            factor=factor,
            multiplier=multiplier.rpartition("/")[2] if scales else "",
            origin=written.origin,
            mark=written.text,
            write=written.replaced,
            place="line",
            controller=controller.name,
        )
        if value is not None:
            yield one
        elif one.measure == "apart" and times is not None:
            # The controller measures the distance between the wheels itself.
            apart = mean_between(one, beside=True)
            yield replace(one, value=apart, write=partial(_unscaled, times), measured=True)
        elif one.measure == "radius":
            # It uses the radius of the first wheel.
            radius = radius_in(robot.description, one.first[0])
            if radius is not None:
                write = partial(_unscaled, written)
                yield replace(one, value=radius, write=write, measured=True)


def _unscaled(times: Value, _: str) -> str:
    """A multiplier without effect."""
    return times.replaced("1.0")


def _known(robot: Robot, values: Sequence[Value | None]) -> Iterator[str]:
    for value in values:
        if value is not None and value.text.strip() in robot.joints:
            yield value.text.strip()


def differs(value: float, real: float, least: float) -> bool:
    """Whether two sizes differ by more than `TOLERANCE` and `least`, m."""
    return 0 < real < FARTHEST and abs(value - real) > max(TOLERANCE * real, least)


def mean_between(one: Stated, *, beside: bool, treads: bool = False) -> float:
    """Distance between the means of two sets of joints or wheels, m.

    Args:
        one: The stated size.
        beside: Measure along the axles, not at right angles to them.
        treads: Measure from the part of each wheel that touches the ground, not from its joint.
    """
    axle = axle_of(one.robot, one.first, one.second, beside=beside)
    direction = axle if beside else np.array([axle[1], -axle[0], 0.0])
    first, second = (_mean(one.robot, names, treads) for names in (one.first, one.second))
    return 0.0 if first is None or second is None else float(abs((first - second) @ direction))


def _mean(robot: Robot, names: tuple[str, ...], treads: bool) -> Floats | None:
    places = [
        wheel_tread(robot, joint) if treads else wheel_place(robot, joint).position
        for name in names
        if (joint := robot.joints[name]).child in robot.placed
    ]
    return np.mean(places, axis=0) if places else None
