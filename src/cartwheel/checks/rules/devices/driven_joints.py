"""Joints that several plugins drive."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from cartwheel.checks import plugin_tags
from cartwheel.checks.controller_claims import (
    claims,
    has_standard_hardware,
    managers,
    offers,
    table,
)
from cartwheel.checks.naming import joints_named
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import running
from cartwheel.description.model import PluginTag
from cartwheel.dialects.catalogue import plugin_named, short_name
from cartwheel.dialects.classic.drives.planar_move import PlanarMove
from cartwheel.dialects.ros_control.parameters import SIZES
from cartwheel.dialects.ros_control.selection import launched
from cartwheel.dialects.tag_roles import DRIVEN_ROLES
from cartwheel.errors import Diagnostic, Origin

_HOLDING = ("position", "velocity")
"""Interfaces by which ROS 1's hardware holds a joint without a controller."""


@dataclass(frozen=True, slots=True)
class _Driver:
    """What drives a joint."""

    text: str
    """A noun phrase."""
    origin: Origin
    shares: bool = False
    """Whether only one of all such drivers acts at a time."""
    efforts: Literal["set", "added"] | None = None
    """How it combines its efforts with those of another driver; None if it commands more."""


@rule(running.JOINT_DRIVEN_TWICE)
def joint_driven_twice(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        drivers: dict[str, list[_Driver]] = {}
        for joint, driver in (*_plugins(robot), *_managers(robot)):
            drivers.setdefault(joint, []).append(driver)
        for joint, driver in _controllers(subject, robot, set(drivers)):
            known = drivers.setdefault(joint, [])
            if not any(each.shares for each in known):
                known.append(driver)
        pairs: dict[tuple[_Driver, _Driver], list[str]] = {}
        for joint, (first, *others) in drivers.items():
            for other in others:
                if {first.efforts, other.efforts} == {"set", "added"}:
                    continue
                pairs.setdefault((first, other), []).append(joint)
        for (first, other), joints in pairs.items():
            yield running.JOINT_DRIVEN_TWICE.diagnostic(
                f"{joints_named(joints)} {'are' if len(joints) > 1 else 'is'} driven by "
                f"{first.text} and by {other.text}",
                values={"joint": joints[0], "joints": tuple(joints)},
                origin=other.origin,
                hint="Remove one of them, or let it drive other joints.",
            )
        yield from _overridden(subject, robot)


def _overridden(subject: Subject, robot: Robot) -> Iterator[Diagnostic]:
    """Drives with wheels of a robot whose velocity another plugin sets, on another topic.

    It sets that of the whole model, also to 0 as long as it receives no command. Source:
    gazebo_ros_planar_move of gazebo_plugins, for ROS 1 and ROS 2.
    """
    tags = robot.description.plugins
    movers = [each for each in tags if plugin_named(each.filename) is PlanarMove]
    topics = {plugin_tags.command_topic(each) for each in movers}
    if not movers or "" in topics:
        return
    drivers = [
        (f'plugin "{each.tag.filename}"', each.tag.origin)
        for each in robot.drives
        if plugin_tags.command_topic(each.tag) not in (*topics, "")
    ]
    remapped = {name for _, each in subject.launched for name, _ in each.arguments}
    drivers += [
        (f'controller "{each.name}"', each.type.origin)
        for owner, file in subject.control
        for each in file.controllers
        if owner is robot
        and each.name not in remapped
        and table(each, *SIZES)
        and any(claim.joint in robot.joints for claim in claims(each))
    ]
    for driver, origin in drivers:
        yield running.JOINT_DRIVEN_TWICE.diagnostic(
            f'plugin "{movers[0].filename}" sets the velocity of the whole robot, also without a '
            f"command, so {driver} turns the wheels, but hardly moves the robot",
            values={"plugin": movers[0].filename, "overridden": driver},
            origin=origin,
            hint="Remove one of them.",
        )


def _plugins(robot: Robot) -> Iterator[tuple[str, _Driver]]:
    """The joints that supported plugins drive."""
    for tag in robot.description.plugins:
        if plugin_named(tag.filename) is None:
            continue
        names = dict.fromkeys(
            name.strip()
            for role in plugin_tags.roles(tag.filename)
            if role.role in DRIVEN_ROLES
            for name in role.joints(tag.element)
        )
        driver = _Driver(f'plugin "{tag.filename}"', tag.origin, efforts=_efforts(tag))
        yield from ((name, driver) for name in names if name in robot.joints)


def _efforts(tag: PluginTag) -> Literal["set", "added"] | None:
    """How gz-sim combines the efforts of a plugin with those of another one.

    A PID controller sets the effort of its joint, and ApplyJointForce adds to it.
    """
    name = short_name(tag.filename)
    if name == "gz-sim-apply-joint-force-system":
        return "added"
    if name == "gz-sim-joint-position-controller-system":
        return None if _is_on(tag, "use_velocity_commands") else "set"
    by_force = name == "gz-sim-joint-controller-system" and _is_on(tag, "use_force_commands")
    return "set" if by_force else None


def _is_on(tag: PluginTag, name: str) -> bool:
    found = tag.element.find(name)
    return found is not None and found.text.strip().lower() in ("1", "true")


def _managers(robot: Robot) -> Iterator[tuple[str, _Driver]]:
    """The joints that controller managers hold, although no controller commands them.

    Without another manager, those of ROS 2 leave joints to plugins, and that of ROS 1 those with an
    effort interface.
    """
    for ros2 in (False, True):
        tags = managers(robot, ros2=ros2)
        offered = offers(robot, ros2=ros2)
        if len(tags) == 1 and (ros2 or not has_standard_hardware(robot, ros2=False)):
            continue
        for tag in tags:
            driver = _Driver(f'plugin "{tag.filename}"', tag.origin, shares=True)
            for joint, interfaces in offered.items():
                holds = any(name in _HOLDING for name, _ in interfaces)
                if joint in robot.joints and (holds or len(tags) > 1):
                    yield joint, driver


def _controllers(subject: Subject, robot: Robot, driven: set[str]) -> Iterator[tuple[str, _Driver]]:
    """Those of the joints that controllers command.

    A file that was only found near the robot counts if a launch file starts the controller. Joints
    without any interface do not count: their controllers cannot start.
    """
    starts: tuple[str, ...] | None = None
    offered = {ros2: set(offers(robot, ros2=ros2)) for ros2 in (True, False)}
    standard = {ros2: has_standard_hardware(robot, ros2=ros2) for ros2 in (True, False)}
    for owner, file in subject.control:
        if owner is not robot:
            continue
        for controller in file.controllers:
            joints = {each.joint for each in claims(controller)} & driven
            if standard[file.is_ros2]:
                joints &= offered[file.is_ros2]
            if joints and not file.named:
                starts = launched(robot.description) if starts is None else starts
                if controller.name not in starts:
                    continue
            driver = _Driver(f'controller "{controller.name}"', controller.type.origin, shares=True)
            yield from ((joint, driver) for joint in sorted(joints))
