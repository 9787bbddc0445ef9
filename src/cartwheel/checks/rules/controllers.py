"""Controller files compared with the robot's joints and interfaces."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from cartwheel.checks import spelling
from cartwheel.checks.control_claims import (
    Claim,
    claims,
    gains_missing,
    has_standard_hardware,
    offers,
)
from cartwheel.checks.control_files import ControlFile, Controller, Value, pairs
from cartwheel.checks.control_search import named_files, resolved
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.control import VALUES, is_known
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element
from cartwheel.errors import Diagnostic, Severity

_JOINT_KEY = re.compile(
    r"(.*_)?joints?(_names?)?|.*wheels?_names?|(left|right|rear)_wheel|.*_steer"
)
_OF_OTHER_ROS = {
    True: {
        "joint_state_controller/JointStateController": "joint_state_broadcaster/"
        "JointStateBroadcaster",
        **{
            f"{kind}_controllers/JointTrajectoryController": "joint_trajectory_controller/"
            "JointTrajectoryController"
            for kind in ("position", "velocity", "effort")
        },
    },
    False: {
        "joint_state_broadcaster/JointStateBroadcaster": "joint_state_controller/"
        "JointStateController",
    },
}
"""Controller types of the other ROS version and their equivalents, by whether the file is ROS 2."""
_GAINS = "{p: 100.0, i: 0.0, d: 1.0}"
_TUNED = "Tune the gains: p in N m/rad, d in N m s/rad."


@rule(devices_codes.CONTROLLERS_FILE_UNREADABLE)
def controllers_file(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for element in named_files(robot):
            path = resolved(subject.packages, element)
            if isinstance(path, Diagnostic):
                yield path
    for _, file in subject.control:
        if file.problem is not None:
            yield file.problem


@rule(devices_codes.CONTROLLER_JOINT_UNKNOWN)
def controller_joint_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot, file in subject.control:
        named = [
            (key, value)
            for key, value in _joints_in(file)
            if re.fullmatch(r"[^$/]+", value.text) and not VALUES.fullmatch(value.text)
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
                severity=_severity(file),
                message=f'"{key}" refers to the joint "{name}", which does not exist',
                values={"tag": key, "joint": name},
                origin=value.origin,
                instead=value.replaced(near) if near else "",
                place="line" if near else "",
                mark=name,
                hint="" if near else spelling.nearest(name, robot.joint_names),
            )


@rule(devices_codes.CONTROLLER_TYPE_UNKNOWN)
def controller_type_unknown(subject: Subject) -> Iterator[Diagnostic]:
    known = subject.plugins.controller_types if subject.plugins is not None else ()
    for controller in _controllers(subject) if known else ():
        kind = controller.kind
        other = _OF_OTHER_ROS[controller.file.is_ros2].get(kind, "")
        near = other or ("" if kind in known else spelling.meant(kind, known, parts=False))
        if kind in known and not other:
            continue
        if not near and not controller.file.named:
            continue
        message = f'the controller type "{controller.type.text}" does not exist'
        if other and controller.file.is_ros2:
            message = f'ROS 2 has no controller type "{controller.type.text}"'
        elif other:
            message = f'ROS 1 has no controller type "{controller.type.text}"'
        elif not near:
            message = f'Cartwheel does not simulate the controller type "{controller.type.text}"'
        yield devices_codes.CONTROLLER_TYPE_UNKNOWN.diagnostic(
            severity=_severity(controller.file, "warning" if other else "error")
            if near
            else "info",
            message=message + f', so "{controller.name}" does not start' * bool(near),
            values={"type": controller.type.text, "controller": controller.name, "meant": near},
            origin=controller.type.origin,
            instead=controller.type.replaced(near) if near else "",
            place="line" if near else "",
            mark=controller.type.text,
        )


@rule(devices_codes.CONTROLLER_INTERFACE_MISMATCH)
def controller_interface(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        found = [
            claim
            for own, file in subject.control
            if own is robot
            for controller in file.controllers
            for claim in claims(controller)
            if claim.joint in robot.joints
        ]
        for ros2 in (True, False):
            held = offers(robot, ros2=ros2)
            ours = {claim.controller.file for claim in found if claim.joint in held}
            asked = [
                claim
                for claim in found
                if claim.controller.file.is_ros2 is ros2
                # A nearby file without any movable joint is for a different variant.
                and (claim.controller.file.named or claim.controller.file in ours)
            ]
            if asked and has_standard_hardware(robot, ros2=ros2):
                yield from _unanswered(asked, held, ros2=ros2)


@rule(devices_codes.CONTROLLER_GAINS_MISSING)
def controller_gains(subject: Subject) -> Iterator[Diagnostic]:
    for controller in _controllers(subject):
        missing = gains_missing(controller)
        if not missing:
            continue
        ros2 = controller.file.is_ros2
        names = [joint for joint, _ in missing]
        group = controller.kind.endswith("JointGroupPositionController")
        if names == [""]:
            text, under = f"pid: {_GAINS}", "pid/p"
        elif group:
            text, under = "", f"{names[0]}/pid/p"
        else:
            inner = ", ".join(f"{name}: {_GAINS}" for name in names)
            text, under = f"gains: {{{inner}}}", f"gains/{names[0]}/p"
        whole = bool(text) and not controller.has(under.partition("/")[0])
        of = "" if names == [""] else f" for {', '.join(names)}"
        yield devices_codes.CONTROLLER_GAINS_MISSING.diagnostic(
            severity="warning" if ros2 else _severity(controller.file),
            message=f'controller "{controller.name}" has no gains{of} ({under} is missing), so '
            + ("its joints do not move" if ros2 else "it does not start"),
            values={"controller": controller.name, "joints": tuple(names), "missing": under},
            origin=controller.type.origin if whole else missing[0][1].origin,
            instead=text if whole else f"{under.rpartition('/')[2]}: 100.0",
            place="after" if whole and _has_own_line(controller.type) else "",
            mark="" if whole else missing[0][1].text,
            hint=_TUNED if whole else f"Add the gains to {under.rpartition('/')[0]}. {_TUNED}",
        )


@rule(devices_codes.JOINT_CLAIMED_TWICE)
def joint_claimed_twice(subject: Subject) -> Iterator[Diagnostic]:
    for _, file in subject.control:
        holders: dict[tuple[str, str], Claim] = {}
        told: set[tuple[str, str]] = set()
        for controller in file.controllers:
            for claim in claims(controller):
                first = holders.setdefault((claim.joint, claim.interface), claim)
                both = (first.controller.name, controller.name)
                # Different types are alternatives, such as a trajectory and a position controller.
                alike = first.controller.kind == controller.kind
                if first.controller is controller or not alike or both in told:
                    continue
                told.add(both)
                yield devices_codes.JOINT_CLAIMED_TWICE.diagnostic(
                    message=f'the controllers "{both[0]}" and "{both[1]}" both command the '
                    f'{claim.interface} of joint "{claim.joint}"',
                    values={
                        "controller": both[1],
                        "other": both[0],
                        "joint": claim.joint,
                        "interface": claim.interface,
                    },
                    origin=claim.value.origin,
                    mark=claim.value.text,
                    hint="The two controllers cannot run at the same time. The other controller is "
                    f"at {first.value.origin}.",
                )


def _unanswered(
    asked: list[Claim], held: dict[str, list[tuple[str, Element]]], *, ros2: bool
) -> Iterator[Diagnostic]:
    """Joints that offer none of the interfaces requested by any of their controllers."""
    joints = dict.fromkeys(claim.joint for claim in asked)
    for joint in joints:
        wanted = [claim for claim in asked if claim.joint == joint]
        offered = [name for name, _ in held.get(joint, ()) if name]
        if any(claim.interface in offered for claim in wanted):
            continue
        claim = wanted[0]
        who = (
            f'controller "{claim.controller.name}" commands the {claim.interface} of joint '
            f'"{joint}"'
        )
        where = "<ros2_control>" if ros2 else "<transmission>"
        if joint not in held:
            yield devices_codes.CONTROLLER_INTERFACE_MISMATCH.diagnostic(
                severity=_severity(claim.controller.file),
                message=f"{who}, which no {where} lists, so the controller does not start",
                values={
                    "controller": claim.controller.name,
                    "joint": joint,
                    "interface": claim.interface,
                },
                origin=claim.value.origin,
                instead=_ros2_joint(claim) if ros2 else _transmission(claim),
                mark=claim.value.text,
                hint="Add this element to the robot" + ("'s <ros2_control>." if ros2 else "."),
            )
            continue
        element = held[joint][0][1]
        if claim.interface not in ("position", "velocity", "effort"):
            continue
        old = (
            f"offers {', '.join(dict.fromkeys(offered))}" if offered else "has no command interface"
        )
        written = element.tag == "hardwareInterface"
        text = f"<hardwareInterface>{_interface(claim)}</hardwareInterface>"
        yield devices_codes.CONTROLLER_INTERFACE_MISMATCH.diagnostic(
            severity=_severity(claim.controller.file),
            message=f"{who}, whose {where} {old}, so the controller does not start",
            values={
                "controller": claim.controller.name,
                "joint": joint,
                "interface": claim.interface,
                "offered": tuple(offered),
            },
            origin=held[joint][-1][1].origin if ros2 else element.origin,
            instead=f'<command_interface name="{claim.interface}"/>' if ros2 else text,
            place="element" if written else "inside",
            mark=element.text.strip() if written else joint,
            hint=f"The controller is at {claim.controller.type.origin}.",
        )


def _transmission(claim: Claim) -> str:
    return (
        f'<transmission name="{claim.joint}_transmission">'
        "<type>transmission_interface/SimpleTransmission</type>"
        f'<joint name="{claim.joint}"><hardwareInterface>{_interface(claim)}</hardwareInterface>'
        f'</joint><actuator name="{claim.joint}_motor">'
        "<mechanicalReduction>1</mechanicalReduction></actuator></transmission>"
    )


def _interface(claim: Claim) -> str:
    return f"hardware_interface/{claim.interface.capitalize()}JointInterface"


def _ros2_joint(claim: Claim) -> str:
    return (
        f'<joint name="{claim.joint}"><command_interface name="{claim.interface}"/>'
        '<state_interface name="position"/><state_interface name="velocity"/></joint>'
    )


def _severity(file: ControlFile, severity: Severity = "error") -> Severity:
    """The severity for a file: a file that was only found nearby may be for a different robot."""
    return severity if file.named else "warning"


def _has_own_line(value: Value) -> bool:
    """Whether a line can be inserted below the value; not possible within ``{braces}``."""
    line = value.file.lines[value.node.start_mark.line]
    return "{" not in line


def _controllers(subject: Subject) -> Iterator[Controller]:
    for robot, file in subject.control:
        for controller in file.controllers:
            held = claims(controller)
            # Nearby files are used only if they refer to a joint of this robot.
            if file.named or not held or any(claim.joint in robot.joints for claim in held):
                yield controller


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
            if _JOINT_KEY.fullmatch(key.value):
                for one in held:
                    if one.id == "scalar":
                        yield key.value, Value(text=one.value, file=file, node=one)
            waiting.append(value)


RULES = (
    controllers_file,
    controller_joint_unknown,
    controller_type_unknown,
    controller_interface,
    controller_gains,
    joint_claimed_twice,
)
