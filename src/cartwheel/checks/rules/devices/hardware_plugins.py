"""Whether a plugin runs the hardware of ``<ros2_control>`` that is made for Gazebo."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import replace
from pathlib import Path, PurePath

from cartwheel.checks import nodes, plugin_tags
from cartwheel.checks.controller_claims import claims, managers
from cartwheel.checks.controller_files import ControlFile
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.devices.undriven_joints import drives_joints
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.codes import files
from cartwheel.description.elements.node import Node
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.files.ros_version import ros_version
from cartwheel.description.launches import LaunchUse, moves
from cartwheel.description.model import Element, RobotDescription
from cartwheel.dialects.catalogue import ROS_CONTROL, short_name
from cartwheel.dialects.ros2_control.unloaded import misspelt, unloaded_systems
from cartwheel.dialects.ros2_control.unstarted import without_parameters
from cartwheel.dialects.ros_control.files import name_and_file
from cartwheel.dialects.ros_control.interfaces import (
    MANAGERS,
    SYSTEMS,
    hardware_of,
    is_unknown,
    loaded_by,
    package_system,
    unknown_hardware,
)
from cartwheel.dialects.ros_control.launched.own_managers import own_managers
from cartwheel.dialects.ros_control.launched.problems import manager_place
from cartwheel.dialects.tag_roles import DRIVEN_ROLES
from cartwheel.errors import Diagnostic, Origin, Value

_STATES = "joint_state"
"""Part of the names of controllers that only publish."""
_SHOWN = 3
"""Maximum number of joints that a message lists."""
_MOST_LAUNCHES = 50
"""Maximum number of launch files that are considered."""
_ABSENT = (files.INCLUDE_ABSENT, files.MACRO_ABSENT)
"""Parts that may contain the plugin."""
CONDITIONS = ("xacro:if", "xacro:unless")
"""Elements of a xacro whose contents depend on its arguments."""


@rule(devices_codes.HARDWARE_WITHOUT_PLUGIN)
def hardware_without_plugin(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        description = robot.description
        yield from _unloaded(subject, robot)
        for use in _uses(subject):
            found = [*_without_manager(subject, robot, use)]
            yield from found
            if found:
                break
        if any("control" in short_name(tag.filename) for tag in description.plugins):
            continue  # perhaps a controller manager under another name
        for system in description.ros2_control:
            hardware = hardware_of(system)
            if hardware not in MANAGERS:
                continue
            name, file = system.attribute("name") or "", MANAGERS[hardware]
            yield devices_codes.HARDWARE_WITHOUT_PLUGIN.diagnostic(
                f'<ros2_control name="{name}"> has the hardware "{hardware}", but the description '
                f'does not contain the plugin "{file}", which runs it, so no controller starts',
                origin=system.origin,
                values={"hardware": hardware, "plugin": file, "name": name},
                hint=f'Add <gazebo><plugin filename="{file}" name="…"/></gazebo>.',
            )


@rule(devices_codes.HARDWARE_UNKNOWN)
def hardware_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for tag in managers(robot, ros2=False):
            kind = tag.element.find("robotSimType")
            if kind is not None and is_unknown(kind.text):
                yield replace(unknown_hardware(tag, kind.text), origin=kind.origin)


@rule(devices_codes.MANAGER_STARTED_TWICE)
def second_manager(subject: Subject) -> Iterator[Diagnostic]:
    """A manager outside of Gazebo with the name of the robot's manager in Gazebo."""
    use = subject.launch
    if use is None or not use.simulated or not use.sure_managers:
        return
    for robot in subject.robots:
        place = manager_place(robot.description, (use,), ros2=True)
        if place is None or place[0] not in use.sure_managers:
            continue
        for tag in managers(robot, ros2=True):
            stated = (tag.element.find(f"controller_manager{e}") for e in ("_name", "_node_name"))
            if any(each is not None for each in stated) or without_parameters(tag) is not None:
                continue
            name = f"/{place[0]}/controller_manager".replace("//", "/")
            yield devices_codes.MANAGER_STARTED_TWICE.diagnostic(
                f'"{use.file.name}" starts ros2_control_node, but "{tag.filename}" already starts '
                f'the controller manager "{name}" in Gazebo, so there are two of this name, and '
                "either one may answer a spawner",
                origin=Origin(file=shown_path(use.file)),
                values={"manager": name, "plugin": tag.filename},
                hint="Do not start ros2_control_node together with Gazebo.",
            )


def _uses(subject: Subject) -> list[LaunchUse]:
    """The launch files that start the description, first the one whose arguments are used."""
    first, file = subject.launch, Path(subject.files[0]).resolve()
    others = (
        each
        for each in subject.own_launches.launches
        if each.description is not None
        and each.description.resolve() == file
        and each.alone
        and _starts(each, subject)
    )
    found = {} if first is None else {first.file: first}
    for each in others:
        found.setdefault(each.file, each)
    return list(found.values())[:_MOST_LAUNCHES]


def _without_manager(subject: Subject, robot: Robot, use: LaunchUse) -> Iterator[Diagnostic]:
    """As `_unmanaged`. It is a note if the launch file starts a program of the repository that has
    a controller manager of its own: what it moves is unknown.
    """
    for found in _unmanaged(subject, robot, use):
        programs = own_managers(use)
        if not programs:
            yield found
            continue
        package = next(iter(programs.values()))
        yield replace(
            found,
            severity="info",
            values={**found.values, "program": package},
            hint=f'A program of the package "{package}" has a controller manager, too. If it moves '
            "the robot in Gazebo, nothing is wrong.",
        )


def _unmanaged(subject: Subject, robot: Robot, use: LaunchUse) -> Iterator[Diagnostic]:
    """Controllers that a launch file starts for a robot in Gazebo, although no plugin runs them.

    Hardware of ``<ros2_control>`` for Gazebo is left out, which is reported otherwise.
    """
    description = robot.description
    if (
        not use.simulated
        or use.guessed
        or all(_STATES in name for name in use.spawned)
        or any("control" in short_name(tag.filename) for tag in description.plugins)
        or managers(robot, ros2=True)
        or managers(robot, ros2=False)
        or any(each.code in _ABSENT for each in description.diagnostics)
    ):
        return
    lost = _lost_joints(robot, use)
    if not lost and any(map(drives_joints, description.plugins)):
        return
    first = next(name for name in use.spawned if _STATES not in name)
    names = ", ".join(f'"{name}"' for name in use.spawned)
    starts = f'"{use.file.name}" starts the controllers {names}, but the description'
    movable = {each.name for each in description.joints if each.type != "fixed"}
    values: dict[str, Value] = {"name": first, "spawned": True}
    if description.ros2_control:
        # An argument that is unknown, or that the user states, may select a plugin.
        started = _starts(use, subject)
        systems = _listing(description.ros2_control, movable) if started else []
        hardware = hardware_of(systems[0]) if systems else ""
        if not hardware or hardware in MANAGERS:
            return
        usable = (f'<plugin>{each}</plugin> with "{file}"' for each, file in MANAGERS.items())
        yield devices_codes.HARDWARE_WITHOUT_PLUGIN.diagnostic(
            f"{starts} does not contain a plugin that runs controllers in Gazebo, and its hardware "
            f'"{hardware}" is not for Gazebo, so no controller moves its joints there',
            origin=(systems[0].find("hardware/plugin") or systems[0]).origin,
            values={"hardware": hardware, "plugin": "", **values},
            hint=f"In Gazebo, use {' or '.join(usable)}.",
            mark=hardware,
        )
        return
    listed = _listing(description.transmissions, movable)
    is_ros2 = (ros_version(Path(description.origin.file)) or 1 + (use.file.suffix == ".py")) == 2
    if listed and not is_ros2:
        file = f"lib{ROS_CONTROL}.so"
        yield devices_codes.HARDWARE_WITHOUT_PLUGIN.diagnostic(
            f'{starts} does not contain the plugin "{file}", which runs them, so no controller '
            "starts",
            origin=listed[0].origin,
            values={"hardware": "transmission", "plugin": file, **values},
            hint=f'Add <gazebo><plugin filename="{file}" name="…"/></gazebo>.',
        )
    elif _starts(use, subject) and (lost or _is_alone(description, use)):
        tag, files = "<transmission>", [f"lib{ROS_CONTROL}.so"]
        if is_ros2:
            tag, files = "<ros2_control>", list(MANAGERS.values())
        usable = (f'<plugin filename="{file}" name="…">' for file in files)
        moved = f"starts and nothing moves {_named(lost)}" if lost else "starts"
        yield devices_codes.HARDWARE_WITHOUT_PLUGIN.diagnostic(
            f"{starts} contains neither a plugin that runs them nor a {tag}, so no controller "
            f"{moved}",
            origin=robot.joints[lost[0]].origin if lost else description.origin,
            values={"hardware": "", "plugin": files[0], "joints": tuple(lost), **values},
            hint=f"Add a {tag} with the joints, and {' or '.join(usable)} in a <gazebo>.",
        )


def _is_alone(description: RobotDescription, use: LaunchUse) -> bool:
    """Whether the controllers that a launch file starts, of which no joint is known, have no
    manager: only the robot itself could contain it, and all of its plugins are known.
    """
    return (
        use.alone
        and any(map(moves, use.spawned))
        and any(joint.type != "fixed" for joint in description.joints)
        and all(map(plugin_tags.is_simulated, description.plugins))
    )


def _lost_joints(robot: Robot, use: LaunchUse) -> list[str]:
    """The joints of the controllers that a launch file starts, except those that plugins drive."""
    driven = {
        name.strip()
        for tag in robot.description.plugins
        for role in plugin_tags.roles(tag.filename)
        if role.role in DRIVEN_ROLES
        for name in role.joints(tag.element)
    }
    files = (name_and_file(path) for path in use.controllers)
    wanted = (
        claim.joint
        for name, path in files
        for each in ControlFile(path=path, named=True, robot=robot.description, name=name).written
        if each.name.rpartition("/")[2] in {one.rpartition("/")[2] for one in use.spawned}
        for claim in claims(each)
    )
    return [name for name in dict.fromkeys(wanted) if name in robot.joints and name not in driven]


def _named(joints: Sequence[str]) -> str:
    """Joints in a message."""
    more = f" and {len(joints) - _SHOWN} more" if len(joints) > _SHOWN else ""
    return ", ".join(f'"{name}"' for name in joints[:_SHOWN]) + more


def _listing(elements: Iterable[Element], joints: Set[str]) -> list[Element]:
    """The transmissions, or tags of ros2_control, that list one of the joints."""
    return [
        each
        for each in elements
        if any((one.attribute("name") or "").strip() in joints for one in each.find_all("joint"))
    ]


def _unloaded(subject: Subject, robot: Robot) -> Iterator[Diagnostic]:
    """Hardware that the robot's plugin does not load.

    It is a note if an argument of the xacro decides about it, and no launch file starts Gazebo with
    the arguments that the user states.
    """
    systems = unloaded_systems(robot.description)
    choices = _Choices(subject.written if systems else ())
    for system, manager in systems:
        hardware, name = hardware_of(system), system.attribute("name") or ""
        element = system.find("hardware/plugin") or system
        chosen = choices.concern(element.origin) and not is_started(subject)
        near = misspelt(hardware, Path(robot.description.origin.file))
        own = near or package_system(hardware)
        meant = own if own in loaded_by(robot.description) else ""
        why = f'"{manager.filename}" does not load it'
        if own and hardware != own:
            package = hardware.replace("::", "/").partition("/")[0]
            why = f'the package "{package}" does not contain it'
        if near:
            why = f'there is no package "{package}"'
        hint = f"In Gazebo, use {_systems(robot)}."
        if chosen:
            hint = "If an argument selects the hardware for Gazebo, pass it."
        yield devices_codes.HARDWARE_WITHOUT_PLUGIN.diagnostic(
            f'<ros2_control name="{name}"> has the hardware "{hardware}", but {why}, so no '
            "controller moves its joints in Gazebo",
            severity="info" if chosen else "warning",
            origin=element.origin,
            values={
                "hardware": hardware,
                "plugin": manager.filename,
                "name": name,
                "meant": meant,
                "unloaded": True,
            },
            hint=hint,
            mark=hardware,
        )


def _systems(robot: Robot) -> str:
    """The hardware that the robot's plugin loads."""
    loaded = loaded_by(robot.description)
    return " or ".join(f"<plugin>{name}</plugin>" for name in SYSTEMS if name in loaded)


def is_started(subject: Subject) -> bool:
    """Whether a launch file certainly starts Gazebo with the arguments of the xacro."""
    return subject.launch is not None and _starts(subject.launch, subject)


def _starts(use: LaunchUse, subject: Subject) -> bool:
    """The same for one launch file."""
    if not use.simulated or use.unknown:
        return False
    stated = subject.arguments
    return all(stated.get(name, value) == value for name, value in use.arguments.items())


class _Choices:
    """What arguments of a xacro decide about: elements in conditions, and with expressions.

    Args:
        files: The files of the xacro, as written.
    """

    def __init__(self, files: Iterable[Node]) -> None:
        self._places: set[tuple[str, int]] = set()
        """The files and lines of elements about which arguments decide."""
        self._includes: dict[str, list[tuple[str, bool]]] = {}
        """The files that include a file, each with whether arguments decide about it, by name."""
        waiting = [(file, False) for file in files]
        while waiting:
            node, inside = waiting.pop()
            decided = inside or "$(arg" in node.attributes.get("filename", "")
            if decided or "$" in node.text:
                self._places.add((node.origin.file, node.origin.line))
            if node.tag == "xacro:include":
                name = PurePath(nodes.text_of(node, "filename")).name
                holder = PurePath(node.origin.file).name
                self._includes.setdefault(name, []).append((holder, decided))
            inside = inside or node.tag in CONDITIONS
            waiting.extend((child, inside) for child in node.children)

    def concern(self, origin: Origin) -> bool:
        """Whether other arguments may replace an element: a condition or an expression decides
        about it, about a macro call that produces it, or about the include of its file.
        """
        places = {(origin.file, origin.line)}
        for call in origin.stack:
            file, _, line = call.rpartition(" ")[0].rpartition(":")
            if line.isdecimal():
                places.add((file, int(line)))
        if not places.isdisjoint(self._places):
            return True
        names = {PurePath(file).name for file, _ in places}
        waiting = sorted(names)
        while waiting:
            for holder, decided in self._includes.get(waiting.pop(), ()):
                if decided:
                    return True
                if holder not in names:
                    # What decides about the include of a file decides about those it includes.
                    names.add(holder)
                    waiting.append(holder)
        return False
