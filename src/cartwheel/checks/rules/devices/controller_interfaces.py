"""Interfaces that controllers need and joints offer."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks.controller_claims import (
    Claim,
    claims,
    commands_joints,
    has_standard_hardware,
    is_supported,
    names_of,
    offers,
    severity_in,
)
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element
from cartwheel.errors import Diagnostic

_NOT_IN_GAZEBO = ("acceleration",)
_SHOWN = 3
"""Number of joints that a message names."""


@rule(devices_codes.CONTROLLER_INTERFACE_MISMATCH)
def controller_interface(subject: Subject) -> Iterator[Diagnostic]:
    yield from _fixed(subject)
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


def _fixed(subject: Subject) -> Iterator[Diagnostic]:
    """Fixed joints in controllers of unsupported types, which no interface can command."""
    for robot, file in subject.control:
        for controller in file.controllers:
            if not commands_joints(controller) or is_supported(controller):
                # The interfaces of other controllers are known.
                continue
            listed = [
                (value, robot.joints[name])
                for value in controller.values(*sorted(names_of("joint")))
                if (name := value.text.strip()) in robot.joints
            ]
            fixed = [(value, joint) for value, joint in listed if joint.type == "fixed"]
            if not fixed or (not file.named and len(fixed) == len(listed)):
                continue
            names = ", ".join(f'"{joint.name}"' for _, joint in fixed[:_SHOWN])
            more = f" and {len(fixed) - _SHOWN} more" if len(fixed) > _SHOWN else ""
            joints = f"the fixed joint {names}" if len(fixed) == 1 else f"fixed joints: {names}"
            yield devices_codes.CONTROLLER_INTERFACE_MISMATCH.diagnostic(
                severity=severity_in(file),
                message=f'controller "{controller.name}" lists {joints}{more}. No interface '
                "commands a fixed joint, so the controller does not start",
                values={
                    "controller": controller.name,
                    "joint": fixed[0][1].name,
                    "joints": tuple(joint.name for _, joint in fixed),
                },
                origin=fixed[0][0].origin,
                mark=fixed[0][0].text,
                hint="Remove it from the list, or change the type of the joint.",
            )


def _unanswered(
    asked: list[Claim], held: dict[str, list[tuple[str, Element]]], *, ros2: bool
) -> Iterator[Diagnostic]:
    """Joints of which no controller is offered all the interfaces that it commands."""
    joints = dict.fromkeys(claim.joint for claim in asked)
    for joint in joints:
        wanted = [claim for claim in asked if claim.joint == joint]
        offered = [name for name, _ in held.get(joint, ()) if name]
        lacking = {
            id(each.controller): each for each in reversed(wanted) if each.interface not in offered
        }
        if any(id(each.controller) not in lacking for each in wanted):
            continue
        claim = next(iter(reversed(lacking.values())))
        who = (
            f'controller "{claim.controller.name}" commands the {claim.interface} of joint '
            f'"{joint}"'
        )
        where = "<ros2_control>" if ros2 else "<transmission>"
        if joint not in held:
            yield devices_codes.CONTROLLER_INTERFACE_MISMATCH.diagnostic(
                severity=severity_in(claim.controller.file),
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
        old = (
            f"offers {', '.join(dict.fromkeys(offered))}" if offered else "has no command interface"
        )
        element = held[joint][0][1]
        if claim.interface not in ("position", "velocity", "effort"):
            if claim.interface in _NOT_IN_GAZEBO:
                yield _unavailable(claim, f"{who}, whose {where} {old}")
            continue
        written = element.tag == "hardwareInterface"
        text = f"<hardwareInterface>{_interface(claim)}</hardwareInterface>"
        yield devices_codes.CONTROLLER_INTERFACE_MISMATCH.diagnostic(
            severity=severity_in(claim.controller.file),
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
            hint=f"The controller is defined at {claim.controller.type.origin}.",
        )


def _unavailable(claim: Claim, who: str) -> Diagnostic:
    """An interface of ros2_control that Gazebo does not have."""
    return devices_codes.CONTROLLER_INTERFACE_MISMATCH.diagnostic(
        severity=severity_in(claim.controller.file),
        message=f"{who}, so the controller does not start",
        values={
            "controller": claim.controller.name,
            "joint": claim.joint,
            "interface": claim.interface,
        },
        origin=claim.controller.type.origin,
        hint="Gazebo's hardware offers position, velocity and effort only.",
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
