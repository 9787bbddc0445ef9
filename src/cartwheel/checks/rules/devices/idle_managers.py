"""Controller managers without a controller that commands joints."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from cartwheel.checks import nodes
from cartwheel.checks.controller_claims import (
    claims,
    commands_joints,
    has_standard_hardware,
    managers,
    offers,
    other_layout,
    uncommanded,
    unstarted,
)
from cartwheel.checks.controller_files import ControlFile, Controller
from cartwheel.checks.controller_search import named_files
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.devices.hardware_plugins import CONDITIONS, is_started
from cartwheel.checks.rules.devices.undriven_joints import may_drive
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import PluginTag
from cartwheel.dialects.gz.gazebo_only import not_loaded
from cartwheel.dialects.ros2_control.unstarted import without_parameters
from cartwheel.dialects.ros_control.launched.mentions import started_by_others
from cartwheel.errors import Diagnostic


@rule(devices_codes.CONTROLLERS_NOT_FOUND)
def idle_manager(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        yield from _without_parameters(subject, robot)
    for robot, selected in subject.launched:
        if selected.problems or _is_driven_otherwise(robot):
            continue
        files = [file for owner, file in subject.control if owner is robot]
        controllers = [each for file in files for each in file.written]
        defined = {each.name for each in controllers}
        started = [
            each for each in controllers if not selected.names or each.name in selected.names
        ]
        if selected.idle_launch is not None and (moving := _moving(robot, files)):
            yield from _unstarted(robot, selected.idle_launch, moving)
            continue
        if any(commands_joints(each) for each in started):
            continue
        layouts = [
            found
            for tag in managers(robot, ros2=False)
            if (found := other_layout(tag, selected.names, selected.loaded)) is not None
        ]
        if (
            # Other findings are about such files.
            any(file.problem is not None for file in files)
            or not defined.issuperset(selected.names)
            or (not files and any(True for _ in named_files(robot)))
        ) and not layouts:
            continue
        for ros2 in (True, False):
            if not has_standard_hardware(robot, ros2=ros2) or not offers(robot, ros2=ros2):
                continue
            for tag in managers(robot, ros2=ros2):
                if not_loaded(robot.description, tag) or without_parameters(tag):
                    # Its controllers do not start anyway.
                    continue
                found = uncommanded(tag, selected.launch, selected.names, selected.loaded)
                # The controllers may be in a package that uses this one.
                yield found if selected.names else replace(found, severity="info")


def _moving(robot: Robot, files: Sequence[ControlFile]) -> list[Controller]:
    """The controllers that command joints of a robot."""
    return [
        each
        for file in files
        for each in file.written
        if any(claim.joint in robot.joints for claim in claims(each))
    ]


def _unstarted(robot: Robot, launch: Path, moving: Sequence[Controller]) -> Iterator[Diagnostic]:
    """The managers whose controllers nothing starts: no launch file, program or instruction."""
    file = Path(robot.description.origin.file)
    if started_by_others(file, {each.name for each in moving}):
        return
    for tag in managers(robot, ros2=moving[0].file.is_ros2):
        if not not_loaded(robot.description, tag) and not without_parameters(tag):
            yield unstarted(tag, launch, moving)


def _without_parameters(subject: Subject, robot: Robot) -> Iterator[Diagnostic]:
    """The managers that do not start, because their tags name no file.

    It is a note if arguments of the xacro may name one, and no launch file decides about them.
    """
    if not offers(robot, ros2=True):
        return
    for tag in managers(robot, ros2=True):
        found = without_parameters(tag)
        if found is not None and _may_name_files(subject, tag) and not is_started(subject):
            hint = "If an argument names the file, pass it."
            found = replace(found, severity="info", hint=hint)
        if found is not None:
            yield found


def _may_name_files(subject: Subject, tag: PluginTag) -> bool:
    """Whether arguments of the xacro decide about what is in a plugin's tag."""
    place = (tag.origin.file, tag.origin.line)
    return any(
        inner.tag in CONDITIONS or "$" in inner.text
        for file in subject.written
        for node in nodes.walk(file)
        if node.tag == "plugin" and (node.origin.file, node.origin.line) == place
        for inner in nodes.walk(node)
        if inner.tag in ("parameters", *CONDITIONS)
    )


def _is_driven_otherwise(robot: Robot) -> bool:
    """Whether a plugin moves a robot that is no controller manager, or all joints are fixed."""
    tags = [*managers(robot, ros2=True), *managers(robot, ros2=False)]
    others = [each for each in robot.description.plugins if each not in tags]
    movable = any(joint.type != "fixed" for joint in robot.joints.values())
    return not movable or any(map(may_drive, others))
