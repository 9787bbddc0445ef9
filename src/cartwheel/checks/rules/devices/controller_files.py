"""Files with the parameters of controllers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from cartwheel.checks.controller_claims import managers, severity_in
from cartwheel.checks.controller_files import ControlFile, repeated_keys
from cartwheel.checks.controller_search import named_files, resolved
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.files.other_places import report
from cartwheel.description.model import PluginTag
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.remappings import namespace_of
from cartwheel.dialects.ros2_control.contents import without_controllers, without_namespace
from cartwheel.dialects.ros2_control.mistyped import mistyped, mistyped_manager
from cartwheel.dialects.ros2_control.refused_files import refused_file
from cartwheel.dialects.ros_control.catalogue import find_type
from cartwheel.dialects.ros_control.files import (
    ControllerEntry,
    controller_entries,
    for_robot,
    is_ros2,
    of_ros2,
    read_parameters,
    read_ros2,
    ros2_file,
)
from cartwheel.dialects.ros_control.launched.names import ros1_entries
from cartwheel.dialects.ros_control.parameters import read_parameters_of
from cartwheel.dialects.ros_control.steer_bot import PARAMETERS
from cartwheel.errors import Diagnostic, Origin, PluginError, UnknownNameError


@rule(devices_codes.CONTROLLERS_FILE_UNREADABLE)
def controllers_file(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for element in named_files(robot):
            path = resolved(subject.packages, element)
            moved = subject.packages.found_elsewhere.get(element.text.strip())
            if isinstance(path, Diagnostic):
                yield path
            elif moved is not None and moved.use == "controllers":
                yield replace(
                    report(element.text.strip(), moved),
                    origin=element.origin,
                    mark=element.text.strip(),
                )
    for _, file in subject.control:
        if file.problem is not None:
            yield file.problem


@rule(devices_codes.CONTROLLERS_FILE_WITHOUT_CONTROLLERS)
def unusable_files(subject: Subject) -> Iterator[Diagnostic]:
    """Files from which a controller manager starts no controller, or that it refuses."""
    for robot in subject.robots:
        own = [file for owner, file in subject.control if owner is robot]
        for tag in managers(robot, ros2=True):
            elements = {id(each) for each in tag.element.find_all("parameters")}
            stated = [file for file in own if file.element and id(file.element) in elements]
            files = stated or [file for file in own if file.element is None]
            yield from _unusable(subject, robot, tag, files)
        if managers(robot, ros2=False):
            # Files that were only found are not for other versions.
            yield from _of_ros1(robot, [file for file in own if file.named])


def _unusable(
    subject: Subject, robot: Robot, tag: PluginTag, files: Sequence[ControlFile]
) -> Iterator[Diagnostic]:
    """The files of a manager of ROS 2."""
    contents: list[tuple[Path, Mapping[str, Any]]] = []
    for file in files:
        if file.problem is not None:
            return
        try:
            contents.append((file.path, read_ros2(file.path, robot.description)))
        except PluginError as error:
            yield error.diagnostic()
            return
    space = namespace_of(tag) or ""
    stated = (tag.element.find(f"controller_manager{each}") for each in ("_name", "_node_name"))
    name = next((each.text.strip() for each in stated if each is not None), "controller_manager")
    merged = ros2_file([content for _, content in contents], space.strip(), name)
    place = f"{space.strip().strip('/')}/{name}"
    lost = without_controllers(merged, contents, place, tag.origin)
    if lost is None and all(file.element is not None for file in files):
        tagged = [content for _, content in contents]
        lost = without_namespace(tagged, space.strip(), name, tag.origin)
    spawned = subject.launch.spaces if subject.launch is not None else frozenset[str]()
    if lost is not None and (not merged.elsewhere or spawned <= {""}):
        yield lost
    if lost is None:
        for file in files:
            refused = refused_file(file.path)
            if refused is not None:
                yield replace(refused, severity=severity_in(file))
    source = ", ".join(shown_path(path) for path, _ in contents)
    entries = controller_entries(merged, "", source)
    yield from _invalid(subject, robot, entries, files)
    if files:
        paths = [path for path, _ in contents]
        classic = short_name(tag.filename) == "gazebo_ros2_control"
        severity = severity_in(files[0])
        for found in mistyped_manager(name, merged.manager, paths):
            yield replace(found, severity=severity)
        for entry in _started(subject, robot, entries):
            for found in mistyped(entry, paths, classic=classic):
                yield replace(found, severity=severity)


def _invalid(
    subject: Subject,
    robot: Robot,
    entries: Sequence[ControllerEntry],
    files: Sequence[ControlFile],
) -> Iterator[Diagnostic]:
    """Parameters for which controllers do not start, of those that a launch file starts."""
    for entry in _started(subject, robot, entries):
        settings = entry.settings()
        ros2 = any(file.is_ros2 for file in files)
        try:
            family = find_type(entry.type, ros2=ros2)
            read_parameters_of(family.parameters, settings, ros2=ros2)
        except UnknownNameError:
            continue
        except PluginError as error:
            found = replace(error.diagnostic(), severity=severity_in(files[0]))
            parameter = str(found.values.get("parameter", "")).replace(".", "/")
            values = (
                value
                for file in files
                for controller in file.controllers
                if controller.name == entry.name
                and (value := controller.value(parameter, controller.name)) is not None
            )
            value = next(values, None)
            yield found if value is None else replace(found, origin=value.origin, mark=value.text)


def _started(
    subject: Subject, robot: Robot, entries: Sequence[ControllerEntry]
) -> list[ControllerEntry]:
    """The controllers that a launch file starts, or all of them if none does."""
    names = {name for owner, each in subject.launched if owner is robot for name in each.names}
    return [entry for entry in entries if not names or entry.name in names]


def _of_ros1(robot: Robot, files: Sequence[ControlFile]) -> Iterator[Diagnostic]:
    """Files that the user passes for a manager of ROS 1."""
    for file in files:
        if file.problem is not None:
            continue
        try:
            content = for_robot(read_parameters(file.path), file.path, robot.description)
        except PluginError as error:
            yield error.diagnostic()
            continue
        if is_ros2(content):
            yield of_ros2(file.path).diagnostic()
        elif not ros1_entries(content, str(file.path)) and PARAMETERS not in content:
            yield devices_codes.CONTROLLERS_FILE_WITHOUT_CONTROLLERS.diagnostic(
                "no parameter specifies a controller type, so no controller starts",
                origin=Origin(file=shown_path(file.path)),
            )


@rule(devices_codes.CONTROLLER_PARAMETER_REPEATED)
def repeated_parameters(subject: Subject) -> Iterator[Diagnostic]:
    files = {file.path: file for _, file in subject.control}
    for file in files.values():
        if file.path.suffix not in (".yaml", ".yml"):
            continue  # the elements of a launch file are merged
        for key, last in repeated_keys(file.root):
            line = last.start_mark.line + 1
            yield devices_codes.CONTROLLER_PARAMETER_REPEATED.diagnostic(
                message=f'"{key.value}" is repeated in line {line}, and only the last one is used',
                values={"name": key.value, "line": line},
                origin=file.origin(key),
                hint="Remove one of them.",
                mark=key.value,
            )
