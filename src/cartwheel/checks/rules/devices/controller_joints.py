"""Joints to which controllers refer."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Any

from cartwheel.checks import spelling
from cartwheel.checks.controller_claims import claims, names_of, severity_in
from cartwheel.checks.controller_files import ControlFile, Value, pairs
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.devices.plugin_joints import NOT_A_NAME
from cartwheel.checks.subject import Subject, is_known
from cartwheel.codes import devices as devices_codes
from cartwheel.codes import files as files_codes
from cartwheel.codes import running as running_codes
from cartwheel.errors import Diagnostic

_Named = tuple[str, Value]
"""A parameter and the joint in it."""


@rule(devices_codes.CONTROLLER_JOINT_UNKNOWN)
def controller_joint_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot, file in subject.control:
        named, missing = _named_and_missing(robot, file, subject)
        if _is_of_another_robot(file, named, missing):
            continue
        if len(missing) > 1 and len(missing) == len(named):
            first = named[0][1]
            yield devices_codes.CONTROLLER_JOINT_UNKNOWN.diagnostic(
                severity="warning",
                message=f"none of the {len(named)} joints in these controllers exists in the "
                f'robot: "{first.text}", …',
                values={"joint": first.text, "count": len(named)},
                origin=file.element.origin if file.element is not None else first.origin,
                mark=file.element.text.strip() if file.element is not None else first.text,
                hint=spelling.nearest(first.text, robot.joint_names),
            )
            continue
        for key, value in missing:
            name = value.text.strip()
            near = spelling.meant(name, robot.joint_names)
            if not near and not file.named:
                continue  # for a different variant of the robot; see `controller_not_started`
            yield devices_codes.CONTROLLER_JOINT_UNKNOWN.diagnostic(
                severity=severity_in(file),
                message=f'the parameter "{key}" refers to the joint "{name}", which does not exist',
                values={"tag": key, "joint": name},
                origin=value.origin,
                instead=value.replaced(near) if near else "",
                place="line" if near else "",
                mark=name,
                hint="" if near else spelling.nearest(name, robot.joint_names),
            )


@rule(running_codes.CONTROLLER_NOT_STARTED)
def controller_not_started(subject: Subject) -> Iterator[Diagnostic]:
    """Controllers that a launch file starts for a robot without one of their joints.

    Joints that `controller_joint_unknown` reports are left out.
    """
    read = subject.read
    if read is None or any(each.code is files_codes.INCLUDE_ABSENT for each in read.diagnostics):
        # The joint may be in a file that is absent.
        return
    for robot, selected in subject.launched:
        for owner, file in subject.control:
            if owner is not robot or file.named or selected.launch is None:
                continue
            named, missing = _named_and_missing(robot, file, subject)
            other = _is_of_another_robot(file, named, missing)
            lost = {value.text.strip() for _, value in missing}
            for controller in file.controllers:
                if controller.name not in selected.names:
                    continue
                claim = next((each for each in claims(controller) if each.joint in lost), None)
                if claim is None or (not other and spelling.meant(claim.joint, robot.joint_names)):
                    continue
                yield running_codes.CONTROLLER_NOT_STARTED.diagnostic(
                    f'controller "{controller.name}", which "{selected.launch.name}" starts, does '
                    f'not start: joint "{claim.joint}" does not exist',
                    severity="warning",
                    origin=claim.value.origin,
                    mark=claim.joint,
                    hint=spelling.nearest(claim.joint, robot.joint_names),
                    values={
                        "controller": controller.name,
                        "name": claim.joint,
                        "cause": devices_codes.CONTROLLER_JOINT_UNKNOWN.number,
                    },
                )


def _named_and_missing(
    robot: Robot, file: ControlFile, subject: Subject
) -> tuple[list[_Named], list[_Named]]:
    """The joints that a file names, each with its key, and those of them that do not exist."""
    named = [
        (key, value)
        for key, value in _joints_in(file)
        if re.fullmatch(r"[^$/]+", value.text) and not NOT_A_NAME.fullmatch(value.text)
    ]
    return named, [one for one in named if not is_known(one[1].text.strip(), robot, subject)]


def _is_of_another_robot(
    file: ControlFile, named: Sequence[_Named], missing: Sequence[_Named]
) -> bool:
    """Whether a file that was only found near the robot names hardly any of its joints."""
    return 2 * len(missing) > len(named) and not file.named


def _joints_in(file: ControlFile) -> Iterator[tuple[str, Value]]:
    """Every key that lists joints, with the scalars in its value."""
    waiting: list[Any] = (
        [file.root]
        if file.is_ros2
        else [mapping for each in file.written for mapping in each.parameters]
    )
    while waiting:
        node = waiting.pop()
        if node is not None and node.id == "sequence":
            waiting.extend(node.value)
        for key, value in pairs(node):
            held = value.value if value.id == "sequence" else [value]
            if key.value.replace(".", "/").rpartition("/")[2] in names_of("joint"):
                for one in held:
                    if one.id == "scalar":
                        yield key.value, Value(text=one.value, file=file, node=one)
            waiting.append(value)
