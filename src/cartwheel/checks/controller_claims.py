"""What controllers command and state, by the tables in which the dialects declare parameters."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from cartwheel.checks import nodes
from cartwheel.checks.controller_files import ControlFile, Controller, Value
from cartwheel.checks.robot import Robot
from cartwheel.checks.subject import Subject
from cartwheel.codes.devices import CONTROLLERS_NOT_FOUND
from cartwheel.description.model import Element, PluginTag
from cartwheel.dialects.catalogue import OF_FETCH, ROS_CONTROL, plugin_named
from cartwheel.dialects.ros_control.catalogue import controller_types, find_type
from cartwheel.dialects.ros_control.control_plugin import ControlPlugin
from cartwheel.dialects.ros_control.interfaces import COMMANDS, PLAIN, SYSTEMS, hardware_of
from cartwheel.dialects.ros_control.parameters import OWN, SIZES, Role, Row, rows
from cartwheel.errors import Diagnostic, Severity, UnknownNameError

_INTERFACES = {
    "PositionJointInterface": ("position",),
    "VelocityJointInterface": ("velocity",),
    "EffortJointInterface": ("effort",),
    "PosVelJointInterface": ("position", "velocity"),
    "PosVelAccJointInterface": ("position", "velocity"),
}
_SIMULATED = re.compile(
    r"(?i:gazebo|gz_ros2|ign_ros2|ignition|mock|fake|generic|simul)|Sim(System)?$"
)
"""Simulated ros2_control hardware: a real robot's tags may describe different interfaces."""
_BROADCASTER = "Broadcaster"
"""End of the types of ROS 2's controllers that command nothing."""
_SHOWN = 3
"""Maximum number of controllers that a message lists."""
_GAINS = ("p", "i", "ff_velocity_scale")
"""Gains of ROS 2, one of which moves a joint."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Claim:
    """A joint that a controller commands."""

    joint: str
    interface: str
    """``position``, ``velocity`` or ``effort``."""
    value: Value
    """The value that contains the joint's name."""
    controller: Controller


def table(controller: Controller, *roles: Role) -> tuple[Row, ...]:
    """The parameters of a controller that have one of these roles; empty for an unknown type."""
    try:
        family = find_type(controller.kind, ros2=controller.file.is_ros2)
    except UnknownNameError:
        return ()
    found = rows(family.parameters, ros2=controller.file.is_ros2)
    return tuple(each for each in found if each.role in roles)


def has_parameter(controller: Controller, name: str) -> bool:
    """Whether the type of a controller has a parameter; False for an unknown type."""
    try:
        family = find_type(controller.kind, ros2=controller.file.is_ros2)
    except UnknownNameError:
        return False
    return any(name in row.names for row in rows(family.parameters, ros2=controller.file.is_ros2))


@cache
def names_of(role: Role) -> frozenset[str]:
    """The last parts of all parameter names that have a role in any controller."""
    return frozenset(
        name.rpartition("/")[2]
        for family in set(controller_types().values())
        for ros2 in (True, False)
        for row in rows(family.parameters, ros2=ros2)
        if row.role == role
        for front in (True, False)
        for name in row.spelled(front_steering=front)
    )


def names(controller: Controller, row: Row) -> tuple[str, ...]:
    """The spellings of a parameter in a controller."""
    front = True
    for each in table(controller, "front_steering"):
        value = controller.value(*each.names)
        front = value is None or value.text.strip().lower() != "false"
    return row.spelled(front_steering=front)


def values(controller: Controller, row: Row) -> list[Value]:
    """The scalars of a parameter; its default is not included."""
    return controller.values(*names(controller, row))


def claims(controller: Controller) -> list[Claim]:
    """The joints that a controller commands; joints set by a launch file are omitted."""
    return [
        Claim(joint=value.text.strip(), interface=interface, value=value, controller=controller)
        for row in table(controller, "joint")
        for value in values(controller, row)
        for interface in _interfaces(controller, row)
        if value.text.strip() and "$" not in value.text
    ]


def wheel_sides(controller: Controller) -> list[list[Value]]:
    """The joints of the left and right wheels of a drive that turns by their speeds.

    Empty for other controllers, also for those that steer.
    """
    if table(controller, "wheel_base", "wheel_reach"):
        return []
    joints = {row.field: values(controller, row) for row in table(controller, "joint")}
    for row in table(controller, "wheel_separation"):
        groups = [joints[field] for field in row.wheels]
        if len(groups) == 2 and all(groups) and groups[0] is not groups[1]:
            return groups
    return []


def base_controllers(subject: Subject) -> Iterator[tuple[Robot, Controller]]:
    """The controllers that drive a robot by its wheels, each with its robot."""
    for robot, file in subject.control:
        for controller in file.controllers:
            if table(controller, *SIZES) and wheels_of(robot, controller):
                yield robot, controller


def wheels_of(robot: Robot, controller: Controller) -> list[str]:
    """Those of a controller's joints that a robot has."""
    named = (claim.joint for claim in claims(controller))
    return list(dict.fromkeys(name for name in named if name in robot.joints))


def idle_joints(subject: Subject, robot: Robot) -> frozenset[str]:
    """Joints that are available to controllers by efforts only, but that no controller commands.

    Nothing holds such a joint, so a wheel on it rolls freely. Empty if the controllers are unknown.
    """
    tags = [*managers(robot, ros2=True), *managers(robot, ros2=False)]
    files = [file for owner, file in subject.control if owner is robot]
    selected = [each for owner, each in subject.launched if owner is robot]
    lost = {
        str(name)
        for each in selected
        for problem in each.problems
        for name in _listed(problem, "controllers") or (problem.values.get("controller"),)
    }
    started = [
        controller
        for file in files
        for controller in file.controllers
        if controller.name not in lost
        and all(not each.names or controller.name in each.names for each in selected)
    ]
    if tags and (not files or any(file.problem is not None for file in files)):
        return frozenset()
    if any(commands_joints(each) and not is_supported(each) for each in started):
        return frozenset()
    claimed = {claim.joint for each in started for claim in claims(each)}
    claimed |= {name for each in robot.drives for name in each.joints}
    offered = [offers(robot, ros2=ros2) for ros2 in (True, False)]
    return frozenset(
        name
        for each in offered
        for name, interfaces in each.items()
        if name not in claimed and {kind for kind, _ in interfaces} <= {"effort", ""}
        if all({kind for kind, _ in other.get(name, ())} <= {"effort", ""} for other in offered)
    )


def _listed(each: Diagnostic, key: str) -> tuple[object, ...]:
    values = each.values.get(key)
    return values if isinstance(values, tuple) else ()


def _interfaces(controller: Controller, row: Row) -> list[str]:
    """The interfaces by which a controller commands the joints of a parameter."""
    if row.interface != OWN:
        return [row.interface]
    own = controller.kind.partition("_")[0]
    if own in COMMANDS:
        return [own]
    return [
        value.text.strip()
        for each in table(controller, "interface")
        for value in values(controller, each)
    ]


def offers(robot: Robot, *, ros2: bool) -> dict[str, list[tuple[str, Element]]]:
    """The interfaces that the robot offers to controllers, by joint, each with its element."""
    found: dict[str, list[tuple[str, Element]]] = {}
    described = robot.description
    for held in described.ros2_control if ros2 else described.transmissions:
        for joint in held.find_all("joint"):
            offered = found.setdefault((joint.attribute("name") or "").strip(), [])
            if ros2:
                in_gazebo = hardware_of(held) in SYSTEMS
                offered += [
                    (name, each)
                    for each in joint.find_all("command_interface")
                    if (name := (each.attribute("name") or "").strip().removesuffix("_pid"))
                    in COMMANDS
                    or not in_gazebo
                ]
                offered.append(("", joint))
                continue
            written = [*joint.find_all("hardwareInterface")] or [
                each
                for actuator in held.find_all("actuator")
                for each in actuator.find_all("hardwareInterface")
            ]
            for each in written:
                short = each.text.strip().rpartition("/")[2]
                offered += [(name, each) for name in _INTERFACES.get(short, ())]
            offered.append(("", joint))
    return found


def managers(robot: Robot, *, ros2: bool) -> list[PluginTag]:
    """The plugins that run the controllers of ROS 1 or of ROS 2."""
    return [
        tag
        for tag in robot.description.plugins
        if (plugin := plugin_named(tag.filename)) is not None
        and issubclass(plugin, ControlPlugin)
        and ros2 != (plugin in (plugin_named(ROS_CONTROL), plugin_named(OF_FETCH)))
    ]


def commands_joints(controller: Controller) -> bool:
    """Whether a controller may command joints; a publisher of states does not."""
    try:
        family = find_type(controller.kind, ros2=controller.file.is_ros2)
    except UnknownNameError:
        return not controller.kind.endswith(_BROADCASTER)
    return any(
        each.role == "joint" for each in rows(family.parameters, ros2=controller.file.is_ros2)
    )


def is_supported(controller: Controller) -> bool:
    """Whether Cartwheel simulates the type of a controller."""
    try:
        find_type(controller.kind, ros2=controller.file.is_ros2)
    except UnknownNameError:
        return False
    return True


def unstarted(tag: PluginTag, launch: Path, controllers: Sequence[Controller]) -> Diagnostic:
    """The diagnostic that nothing starts the controllers of a manager.

    Args:
        tag: The controller manager.
        launch: The launch file that starts the robot in Gazebo.
        controllers: The controllers that could move it.
    """
    names = list(dict.fromkeys(each.name for each in controllers))
    program = "ros2 run" if controllers[0].file.is_ros2 else "rosrun"
    listed = ", ".join(f'"{name}"' for name in names[:_SHOWN])
    more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    return CONTROLLERS_NOT_FOUND.diagnostic(
        f'"{launch.name}" starts the robot in Gazebo, but no launch file starts a controller that '
        f"moves it, such as {listed}{more}, so nothing commands its joints",
        origin=tag.origin,
        values={"plugin": tag.filename, "controllers": tuple(names), "launch": str(launch)},
        hint=f"Add spawners to the launch file, or start them: {program} controller_manager "
        f"spawner {' '.join(names[:_SHOWN])}",
    )


def uncommanded(
    tag: PluginTag, launch: Path | None, started: Sequence[str], files: Sequence[Path] = ()
) -> Diagnostic:
    """The diagnostic that no controller of a manager commands a joint.

    Args:
        tag: The controller manager.
        launch: The launch file that starts its controllers.
        started: Their names.
        files: The YAML files that it loads.
    """
    layout = other_layout(tag, started, files)
    if layout is not None:
        return layout
    message = "no file contains controllers for this controller manager"
    if started and launch is not None:
        names = ", ".join(f'"{name}"' for name in started)
        verb = "which commands" if len(started) == 1 else "which command"
        message = f'"{launch.name}" starts only {names}, {verb} no joint'
    return CONTROLLERS_NOT_FOUND.diagnostic(
        message, origin=tag.origin, values={"started": tuple(started)}
    )


def other_layout(
    tag: PluginTag, started: Sequence[str], files: Sequence[Path]
) -> Diagnostic | None:
    """The diagnostic that a launch file loads a file for ROS 2 for a manager of ROS 1; None if it
    does not. See `uncommanded` for the arguments.
    """
    if plugin_named(tag.filename) is not plugin_named(ROS_CONTROL):
        return None
    for path in files:
        file = ControlFile(path=path, named=True)
        if path.is_file() and file.is_ros2:
            return CONTROLLERS_NOT_FOUND.diagnostic(
                'the controllers are below "ros__parameters", as in ROS 2, where the '
                "controller manager of ROS 1 does not find them",
                origin=file.origin(file.root),
                values={"started": tuple(started)},
                hint='Write them without "controller_manager" and "ros__parameters".',
            )
    return None


def has_standard_hardware(robot: Robot, *, ros2: bool) -> bool:
    """Whether the hardware provides the interfaces listed in the tags, as in simulation."""
    if ros2:
        plugins = [each.find("hardware/plugin") for each in robot.description.ros2_control]
        return any(each is None or _SIMULATED.search(each.text) for each in plugins)
    for tag, _ in robot.plugins():
        if "ros_control" in tag.filename and "ros2" not in tag.filename:
            kind = next(tag.element.find_all("robotSimType"), None)
            if kind is not None and kind.text.strip() not in PLAIN:
                return False
    return True


def gains_missing(controller: Controller) -> list[tuple[str, Value, str]]:
    """Joints without PID gains, for controllers that need them.

    Returns:
        For each joint its name, or "" if the gains are not listed by joint; the value with its
        name; and the path of its gains.
    """
    ros2 = controller.file.is_ros2
    if {claim.interface for claim in claims(controller)} not in ({"effort"}, {"velocity"}):
        return []
    joints = [each for row in table(controller, "joint") for each in values(controller, row)]
    missing = []
    for row in table(controller, "gains"):
        for value in joints:
            joint = value.text.strip()
            path = row.names[0].replace("{joint}", joint)
            if ros2:
                has_gains = any(_positive(controller, f"{path}/{key}") for key in _GAINS)
            else:
                has_gains = controller.has(f"{path}/p")
            if not has_gains:
                missing.append((joint if path != row.names[0] else "", value, path))
    return missing


def gains_zero(controller: Controller) -> list[Value]:
    """The joints of a ROS 1 controller whose PID gains are stated, but all 0.

    Returns:
        For each joint the value with its name.
    """
    if controller.file.is_ros2 or {each.interface for each in claims(controller)} != {"effort"}:
        return []
    joints = [each for row in table(controller, "joint") for each in values(controller, row)]
    return [
        value
        for row in table(controller, "gains")
        for value in joints
        if controller.has(f"{(path := row.names[0].replace('{joint}', value.text.strip()))}/p")
        and not any(_positive(controller, f"{path}/{key}") for key in ("p", "i", "d"))
    ]


def _positive(controller: Controller, path: str) -> bool:
    value = controller.value(path)
    # A value set by a launch file is unknown here.
    return value is not None and ("$" in value.text or bool(nodes.number(value.text)))


def severity_in(file: ControlFile, severity: Severity = "error") -> Severity:
    """The severity for a file: a file that was only found nearby may be for a different robot."""
    return severity if file.named else "warning"


def used_controllers(subject: Subject) -> Iterator[Controller]:
    """The controllers of all robots, except those in nearby files for other robots."""
    for robot, file in subject.control:
        for controller in file.controllers:
            held = claims(controller)
            # Nearby files are used only if they refer to a joint of this robot.
            if file.named or not held or any(claim.joint in robot.joints for claim in held):
                yield controller
