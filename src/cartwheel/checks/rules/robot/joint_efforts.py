"""Effort and velocity limits, and torques, of driven joints."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from cartwheel.checks import edits, nodes, plugin_tags
from cartwheel.checks.kinematic_tree import joints_with_types
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.dialects.ros_control.interfaces import CLASSIC_SYSTEM, hardware_of, loaded_by
from cartwheel.errors import Diagnostic

_GRAVITY = 9.8
"""m/s²."""
_LEAST_EFFORT = 10.0
_CREEPING, _CREEPING_SLIDE = 0.1, 0.01
"""Highest speed, rad/s and m/s, below which a joint hardly moves."""
_GAIN = re.compile(r"(pos|vel)_k[pid]$")
"""The gains of a joint's PID in ``<ros2_control>``."""


@rule(robot_codes.EFFORT_ZERO)
def effort_zero(subject: Subject) -> Iterator[Diagnostic]:
    yield from _torque_zero(subject)
    movers = {
        name: robot for robot in subject.robots for name in robot.driven - _without_motor(robot)
    }
    for joint, kind in joints_with_types(subject):
        limit = nodes.child(joint, "limit")
        name = nodes.name_of(joint)
        if limit is None or kind in ("fixed", "floating") or name not in movers:
            continue
        slides = kind == "prismatic"
        if nodes.number(limit.attributes.get("effort")) == 0.0:
            usual = _holding(movers[name], name, slides=slides)
            yield robot_codes.EFFORT_ZERO.diagnostic(
                message=f'the effort limit of the driven joint "{name}" is 0, so Gazebo cannot '
                "move the joint",
                values={"joint": name, "attribute": "effort"},
                **edits.attribute(limit, "effort", nodes.short(usual)),
                hint="Cartwheel treats 0 as no limit. The suggested limit is twice the effort "
                "required to hold the load. Replace it with the motor's actual limit.",
            )
        if nodes.number(limit.attributes.get("velocity")) == 0.0:
            yield robot_codes.EFFORT_ZERO.diagnostic(
                message=f'the velocity limit of the driven joint "{name}" is 0, so Gazebo cannot '
                "move the joint",
                values={"joint": name, "attribute": "velocity"},
                **edits.attribute(limit, "velocity", "1" if slides else "10"),
                hint="Set the velocity limit to the motor's maximum speed.",
            )


@rule(robot_codes.DAMPING_TOO_HIGH)
def damping_too_high(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        # The torque of a drive replaces the effort limits of its wheels.
        wheels = {name for drive in robot.drives for name in drive.joints}
        for name in sorted(robot.driven - wheels):
            joint = robot.joints.get(name)
            if joint is None or not joint.axis.effort or not joint.axis.damping:
                continue
            slides = joint.type == "prismatic"
            speed = joint.axis.effort / joint.axis.damping
            if speed >= (_CREEPING_SLIDE if slides else _CREEPING):
                continue
            unit = "N" if slides else "N m"
            yield robot_codes.DAMPING_TOO_HIGH.diagnostic(
                message=f'the effort limit of joint "{name}", {joint.axis.effort:g} {unit}, moves '
                f"it against its damping of {joint.axis.damping:g} {unit} "
                f"{'s/m' if slides else 's/rad'} at {speed:.2g} {'m/s' if slides else 'rad/s'} "
                "at most",
                values={
                    "joint": name,
                    "effort": joint.axis.effort,
                    "damping": joint.axis.damping,
                    "speed": speed,
                },
                origin=joint.origin,
                hint="Decrease the damping, or increase the effort limit to that of the motor.",
            )


def _without_motor(robot: Robot) -> set[str]:
    """The joints that gazebo_ros2_control moves without an effort: it sets their positions and
    velocities, whatever their limits. With a PID, it applies efforts.

    Source: `GazeboSystem::write`.
    """
    if loaded_by(robot.description) != {CLASSIC_SYSTEM}:
        return set()
    moved, by_effort = set[str](), {name for drive in robot.drives for name in drive.joints}
    for system in robot.description.ros2_control:
        if hardware_of(system) != CLASSIC_SYSTEM:
            continue
        for joint in system.find_all("joint"):
            commands = {each.attribute("name") for each in joint.find_all("command_interface")}
            by_pid = any(
                _GAIN.match(each.attribute("name") or "") for each in joint.find_all("param")
            )
            free = bool(commands) and commands <= {"position", "velocity"} and not by_pid
            (moved if free else by_effort).add((joint.attribute("name") or "").strip())
    return moved - by_effort


def _torque_zero(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for drive in robot.drives:
            torques = plugin_tags.roles_with(drive.tag.filename, "wheel_torque")
            read = {name for each in torques for name in each.tags if name not in each.obsolete}
            for element in drive.tag.element.children:
                if element.tag in read and nodes.number(element.text) == 0.0:
                    yield robot_codes.EFFORT_ZERO.diagnostic(
                        message=f"<{element.tag}> is 0 N m, so the wheels do not move",
                        values={"tag": element.tag, "plugin": drive.tag.name},
                        **edits.text(element, "5"),
                        hint=f"Set <{element.tag}> to the motors' maximum torque.",
                    )


def _holding(robot: Robot, name: str, *, slides: bool) -> float:
    """Twice the effort to hold all that a joint carries, fully extended, N or N m; at least 10."""
    joint = robot.joints.get(name)
    if joint is None or joint.child not in robot.links:
        return _LEAST_EFFORT
    here = np.array(robot.links[joint.child].pose.position)
    load = 0.0
    carried, waiting = set[str](), [joint.child]
    while waiting:
        link = robot.links.get(waiting.pop())
        if link is None or link.name in carried:
            continue
        carried.add(link.name)
        waiting += [one.child for one in robot.description.joints if one.parent == link.name]
        if link.inertial is not None:
            centre = (link.pose @ link.inertial.pose).position
            arm = 1.0 if slides else float(np.linalg.norm(np.array(centre) - here))
            load += link.inertial.mass * arm
    return max(_LEAST_EFFORT, float(f"{2 * _GRAVITY * load:.1g}"))
