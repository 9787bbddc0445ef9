"""PID gains of controllers."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Iterator

from cartwheel.checks.controller_claims import (
    claims,
    gains_missing,
    gains_zero,
    severity_in,
    table,
    used_controllers,
)
from cartwheel.checks.controller_files import Controller, Value
from cartwheel.checks.gains import gain_too_low
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.dialects.gz.joint_controller import JointPositionController, JointPositionParameters
from cartwheel.dialects.tags import read
from cartwheel.errors import Diagnostic, PluginError

_GAINS = "{p: 100.0, i: 0.0, d: 1.0}"
_POSITIONS = re.compile("Position|Trajectory")
"""Part of the types of controllers that move joints to positions."""
_CLAMPS = ("i_clamp", "i_clamp_min", "i_clamp_max")
_TUNED = "Tune the gains: p in N m/rad, d in N m s/rad."


@rule(devices_codes.CONTROLLER_GAINS_MISSING)
def controller_gains(subject: Subject) -> Iterator[Diagnostic]:
    for controller in used_controllers(subject):
        missing = gains_missing(controller)
        zero = [] if missing else gains_zero(controller)
        if zero:
            names = [value.text.strip() for value in zero]
            yield devices_codes.CONTROLLER_GAINS_MISSING.diagnostic(
                severity="warning",
                message=f'the gains of controller "{controller.name}" for {", ".join(names)} are '
                "all 0, so the controller does not move "
                + ("the joint" if len(names) == 1 else "these joints"),
                values={"controller": controller.name, "joints": tuple(names), "missing": ""},
                origin=zero[0].origin,
                mark=zero[0].text,
                hint=_TUNED,
            )
        if not missing:
            continue
        ros2 = controller.file.is_ros2
        names = [joint for joint, _, _ in missing]
        path = missing[0][2]
        under, top, text = f"{path}/p", path.partition("/")[0], ""
        if names == [""]:
            text = f"{path}: {_GAINS}"
        elif path == f"{top}/{names[0]}":
            inner = ", ".join(f"{name}: {_GAINS}" for name in names)
            text = f"{top}: {{{inner}}}"
        whole = bool(text) and not controller.has(top)
        of = "" if names == [""] else f" for {', '.join(names)}"
        yield devices_codes.CONTROLLER_GAINS_MISSING.diagnostic(
            severity="warning" if ros2 else severity_in(controller.file),
            message=f'controller "{controller.name}" has no gains{of} ({under} is missing), so '
            + ("its joints do not move" if ros2 else "it does not start"),
            values={
                "controller": controller.name,
                "joints": tuple(value.text.strip() for _, value, _ in missing),
                "missing": under,
            },
            origin=controller.type.origin if whole else missing[0][1].origin,
            instead=text if whole else f"{under.rpartition('/')[2]}: 100.0",
            place="after" if whole and _has_own_line(controller.type) else "",
            mark="" if whole else missing[0][1].text,
            hint=_TUNED if whole else f"Add the gains to {under.rpartition('/')[0]}. {_TUNED}",
        )


@rule(devices_codes.CONTROLLER_GAIN_TOO_LOW)
def gains_too_low(subject: Subject) -> Iterator[Diagnostic]:
    for robot, file in subject.control:
        for controller in file.controllers:
            if _POSITIONS.search(controller.kind):
                yield from _of_controller(robot, controller)
    for robot in subject.robots:
        for tag in robot.description.plugins:
            if plugin_named(tag.filename) is not JointPositionController:
                continue
            with contextlib.suppress(PluginError):
                given, _ = read(JointPositionParameters, tag.element)
                if given.velocity:
                    continue
                place = next(tag.element.find_all("p_gain"), None)
                origin = tag.origin if place is None else place.origin
                for name in given.joints:
                    if name.strip() in robot.joints:
                        joint = robot.joints[name.strip()]
                        yield from gain_too_low(robot, joint, given.p, origin, integral=given.i)


@rule(devices_codes.DERIVATIVE_GAIN_TOO_HIGH)
def derivative_gains_too_high(subject: Subject) -> Iterator[Diagnostic]:
    """Derivative gains of at least 1 for commanded velocities.

    At each update, the controller commands ``v' = p e - d v`` for a position error e, and the joint
    turns at once. With the update period h, e changes by -h v'. The roots of ``z² - (1 - p h - d) z
    - d = 0`` are within the unit circle if ``d < 1 - p h / 2``, so never if d is at least 1.
    """
    for controller in used_controllers(subject):
        interfaces: dict[str, set[str]] = {}
        for claim in claims(controller):
            interfaces.setdefault(claim.joint, set()).add(claim.interface)
        opened = controller.value("open_loop_control")
        if not _POSITIONS.search(controller.kind) or (
            opened is not None and opened.text.strip().lower() == "true"
        ):
            continue
        for joint, kinds in interfaces.items():
            for row in table(controller, "gains") if kinds == {"velocity"} else ():
                value = controller.value(f"{row.names[0].replace('{joint}', joint)}/d")
                if value is None or value.number is None or value.number < 1.0:
                    continue
                yield devices_codes.DERIVATIVE_GAIN_TOO_HIGH.diagnostic(
                    f'with a derivative gain of {value.number:g}, joint "{joint}" oscillates: '
                    f'controller "{controller.name}" commands its velocity, and each command is '
                    f"about -{value.number:g} times the one before",
                    values={"controller": controller.name, "joint": joint, "d": value.number},
                    origin=value.origin,
                    mark=value.text,
                    hint="Use a gain well below 1, such as 0: a joint with velocity commands needs "
                    "no derivative gain.",
                )


def _of_controller(robot: Robot, controller: Controller) -> Iterator[Diagnostic]:
    """The gains of a controller with an effort output that are too low."""
    ros1 = not controller.file.is_ros2
    for claim in claims(controller):
        if claim.interface != "effort" or claim.joint not in robot.joints:
            continue
        for row in table(controller, "gains"):
            path = row.names[0].replace("{joint}", claim.joint)
            value = controller.value(f"{path}/p")
            clamped = any(_number(controller, f"{path}/{name}") for name in _CLAMPS)
            # ros_control limits the integral to 0 if no limit is stated.
            integral = 0.0 if ros1 and not clamped else _number(controller, f"{path}/i")
            if value is None or value.number is None:
                continue
            joint, gain, origin = robot.joints[claim.joint], value.number, value.origin
            yield from gain_too_low(robot, joint, gain, origin, integral=integral, mark=value.text)


def _number(controller: Controller, path: str) -> float:
    """A number at a path; infinite if a launch file sets it, and 0 if it is missing."""
    value = controller.value(path)
    if value is None:
        return 0.0
    return math.inf if value.number is None else value.number


def _has_own_line(value: Value) -> bool:
    """Whether a line can be inserted below the value; not possible within ``{braces}``."""
    line = value.file.lines[value.node.start_mark.line]
    return "{" not in line
