"""Joints to which controllers refer."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from cartwheel.checks import spelling
from cartwheel.checks.controller_claims import names_of, severity_in
from cartwheel.checks.controller_files import ControlFile, Value, pairs
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.devices.plugin_joints import NOT_A_NAME
from cartwheel.checks.subject import Subject, is_known
from cartwheel.codes import devices as devices_codes
from cartwheel.errors import Diagnostic


@rule(devices_codes.CONTROLLER_JOINT_UNKNOWN)
def controller_joint_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot, file in subject.control:
        named = [
            (key, value)
            for key, value in _joints_in(file)
            if re.fullmatch(r"[^$/]+", value.text) and not NOT_A_NAME.fullmatch(value.text)
        ]
        missing = [one for one in named if not is_known(one[1].text.strip(), robot, subject)]
        if 2 * len(missing) > len(named) and not file.named:
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
                continue  # for a different variant of the robot
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


def _joints_in(file: ControlFile) -> Iterator[tuple[str, Value]]:
    """Every key that lists joints, with the scalars in its value."""
    waiting: list[Any] = (
        [file.root]
        if file.is_ros2
        else [mapping for each in file.controllers for mapping in each.parameters]
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
