"""Whether a plugin runs the hardware of ``<ros2_control>`` that is made for Gazebo."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Set
from dataclasses import replace
from pathlib import Path, PurePath

from cartwheel.checks import nodes
from cartwheel.checks.controller_claims import managers
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.devices.undriven_joints import drives_joints
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.codes import files
from cartwheel.description.elements.node import Node
from cartwheel.description.files.ros_version import ros_version
from cartwheel.description.model import Element
from cartwheel.dialects.catalogue import ROS_CONTROL, short_name
from cartwheel.dialects.ros2_control.unloaded import unloaded_systems
from cartwheel.dialects.ros_control.interfaces import (
    MANAGERS,
    SYSTEMS,
    hardware_of,
    is_unknown,
    loaded_by,
    package_system,
    unknown_hardware,
)
from cartwheel.errors import Diagnostic, Origin

_STATES = "joint_state"
"""Part of the names of controllers that only publish."""
_ABSENT = (files.INCLUDE_ABSENT, files.MACRO_ABSENT)
"""Parts that may contain the plugin."""
CONDITIONS = ("xacro:if", "xacro:unless")
"""Elements of a xacro whose contents depend on its arguments."""


@rule(devices_codes.HARDWARE_WITHOUT_PLUGIN)
def hardware_without_plugin(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        description = robot.description
        yield from _unloaded(subject, robot)
        yield from _without_manager(subject, robot)
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


def _without_manager(subject: Subject, robot: Robot) -> Iterator[Diagnostic]:
    """Transmissions, or hardware of ``<ros2_control>`` that is not for Gazebo, of a robot that a
    launch file starts in Gazebo with controllers, although no plugin runs them.
    """
    description, use = robot.description, subject.launch
    if (
        use is None
        or not use.simulated
        or all(_STATES in name for name in use.spawned)
        or any(map(drives_joints, description.plugins))
        or any(each.code in _ABSENT for each in description.diagnostics)
    ):
        return
    first = next(name for name in use.spawned if _STATES not in name)
    names = ", ".join(f'"{name}"' for name in use.spawned)
    starts = f'"{use.file.name}" starts the controllers {names}, but the description'
    movable = {each.name for each in description.joints if each.type != "fixed"}
    if description.ros2_control:
        # An argument that is unknown, or that the user states, may select a plugin.
        systems = _listing(description.ros2_control, movable) if is_started(subject) else []
        hardware = hardware_of(systems[0]) if systems else ""
        if not hardware or hardware in MANAGERS:
            return
        usable = (f'<plugin>{each}</plugin> with "{file}"' for each, file in MANAGERS.items())
        yield devices_codes.HARDWARE_WITHOUT_PLUGIN.diagnostic(
            f"{starts} does not contain a plugin that runs controllers in Gazebo, and its hardware "
            f'"{hardware}" is not for Gazebo, so no controller moves its joints there',
            origin=(systems[0].find("hardware/plugin") or systems[0]).origin,
            values={"hardware": hardware, "plugin": "", "name": first},
            hint=f"In Gazebo, use {' or '.join(usable)}.",
            mark=hardware,
        )
        return
    listed = _listing(description.transmissions, movable)
    if listed and ros_version(Path(description.origin.file)) != 2:
        file = f"lib{ROS_CONTROL}.so"
        yield devices_codes.HARDWARE_WITHOUT_PLUGIN.diagnostic(
            f'{starts} does not contain the plugin "{file}", which runs them, so no controller '
            "starts",
            origin=listed[0].origin,
            values={"hardware": "transmission", "plugin": file, "name": first},
            hint=f'Add <gazebo><plugin filename="{file}" name="…"/></gazebo>.',
        )


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
        own = package_system(hardware)
        meant = own if own in loaded_by(robot.description) else ""
        why = f'"{manager.filename}" does not load it'
        if own and hardware != own:
            package = hardware.replace("::", "/").partition("/")[0]
            why = f'the package "{package}" does not contain it'
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
    use = subject.launch
    if use is None or not use.simulated or use.unknown:
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
