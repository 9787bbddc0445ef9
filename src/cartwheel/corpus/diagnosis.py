"""Explains failed tests by diagnostics: of the run, and of `cartwheel check`."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from cartwheel.codes import devices, files, robot, running, world
from cartwheel.corpus.faults import Fault
from cartwheel.corpus.movers import is_known, managers, moving_plugins, reports
from cartwheel.corpus.verdict import Verdict
from cartwheel.description.model import PluginTag, RobotDescription
from cartwheel.dialects.catalogue import short_name
from cartwheel.errors import Code, Diagnostic

_AGREES = 0.15
"""Relative tolerance between a measured velocity and the one that a mistake predicts."""
_BRAKED = 0.15
"""Largest part of the speed that a sliding caster takes while the base drives straight ahead."""
_PULLED = 0.5
"""Largest part of the turn rate for which wheels that point to one side account."""
_HEAVY = 1000.0
"""Ratio of a link's stated inertia to the largest possible one."""
_DRIVING = frozenset(
    {
        robot.DRIVE_JOINT_UNKNOWN,
        robot.DRIVE_JOINT_NOT_CONTINUOUS,
        robot.WHEEL_AXIS_MISALIGNED,
        robot.WHEEL_NOT_ROUND,
        robot.WHEEL_FRICTIONLESS,
        robot.WHEEL_WITHOUT_COLLISION,
        robot.WHEELS_OFF_GROUND,
        robot.BODY_ON_GROUND,
        robot.UNBALANCED,
        robot.EFFORT_ZERO,
        robot.OVERLAPPING_COLLISIONS,
        running.PLUGIN_LEFT_OUT,
        running.JOINT_DRIVEN_TWICE,
    }
)
"""Mistakes that change a base's velocity by an unknown factor."""
_TURNING = _DRIVING | {robot.CASTER_FRICTION, running.WHEELS_WITHOUT_ROLLERS}
_CONTROL = frozenset(
    {
        running.PLUGIN_LEFT_OUT,
        devices.CONTROLLERS_FILE_UNREADABLE,
        devices.CONTROLLERS_FILE_MISMATCH,
        devices.CONTROLLERS_FILE_WITHOUT_CONTROLLERS,
        devices.CONTROLLERS_FILE_ARGUMENT,
        devices.CONTROL_WITHOUT_JOINTS,
        devices.HARDWARE_UNKNOWN,
        running.CONTROLLER_NOT_STARTED,
    }
)
"""Reasons why no controller runs."""
_BROADCASTER = "Broadcaster"
"""End of the types of ROS 2's controllers that command nothing."""
_ALTERNATIVE = frozenset({running.CONTROLLER_CONFLICT.number})
"""Causes for which a controller does not start in ROS either, although another one works."""
_STANDING = frozenset(
    {
        files.FILE_MISSING,
        files.MESH_UNREADABLE,
        robot.BASE_WITHOUT_COLLISION,
        robot.WHEEL_WITHOUT_COLLISION,
        robot.WHEELS_OFF_GROUND,
        robot.INERTIA_MISSING,
        robot.JOINT_LINK_UNKNOWN,
        robot.UNBALANCED,
        robot.OVERLAPPING_COLLISIONS,
        robot.JOINTS_UNDRIVEN,
    }
)
_DIVERGING = frozenset({robot.SHAPE_OUT_OF_SCALE, robot.POSITION_IN_MILLIMETRES})
"""Lengths in other units, with which shapes are inside each other or kilometres long."""
_JOINTS = frozenset(
    {
        robot.LIMIT_ZERO,
        robot.LIMIT_IN_DEGREES,
        robot.EFFORT_ZERO,
        robot.OVERLAPPING_COLLISIONS,
        robot.ROOT_NOT_HELD,
        devices.EFFORT_LIMIT_TOO_LOW,
        devices.CONTROLLER_GAINS_MISSING,
        devices.JOINT_CLAIMED_TWICE,
        running.JOINT_DRIVEN_TWICE,
    }
)


def faults(
    verdict: Verdict, description: RobotDescription, findings: Callable[[], Sequence[Diagnostic]]
) -> Iterator[Fault]:
    """The failed tests of a robot that could be read, with reasons.

    Args:
        verdict: The measurements.
        description: The robot.
        findings: Returns the findings of `cartwheel check`, which takes time.
    """
    if verdict.failure is not None:
        reason = verdict.failure
        if verdict.loaded and reason.code is world.SIMULATION_DIVERGED:
            reason = _coded(findings(), _DIVERGING) or reason
        yield Fault(test="simulate" if verdict.loaded else "load", reason=reason)
    if not verdict.loaded:
        return
    # Two plugins of a kind are one fault.
    missing = {fault.subject: fault for fault in reversed([*_missing(verdict, description)])}
    yield from reversed(missing.values())
    idle = next((each.reason for each in missing.values() if each.test == "controller"), None)
    children = {joint.name: joint.child for joint in description.joints}
    yield from _measured(verdict, children, findings, idle if not verdict.controllers else None)


def _missing(verdict: Verdict, description: RobotDescription) -> Iterator[Fault]:
    """Plugins that should move the robot and are missing, and controllers that did not start."""
    said = verdict.diagnostics
    for tag in moving_plugins(description):
        if is_known(tag):
            reason = _first(
                each
                for each in said
                if each.code in (running.PLUGIN_LEFT_OUT, running.PLUGIN_FAILED)
                and each.values.get("plugin") == tag.filename
            )
        else:
            reason = devices.PLUGIN_UNKNOWN.diagnostic(
                f'plugin "{tag.filename}" is not supported, so it has no effect',
                severity="warning",
                origin=tag.origin,
                values={"name": tag.filename},
            )
        if reason is not None:
            yield Fault(test="plugin", subject=short_name(tag.filename), reason=reason)
    refused = {
        each.values.get("controller"): each
        for each in said
        if each.code is running.CONTROLLER_NOT_STARTED
        and each.values.get("cause") not in _ALTERNATIVE
    }
    for name in verdict.spawned:
        if name in refused and name not in verdict.controllers and not _broadcasts(refused[name]):
            yield Fault(test="controller", subject=name, reason=refused[name])
    if verdict.drives or verdict.reaches or verdict.spins or verdict.flights:
        return
    if verdict.failure is not None and verdict.controllers:
        # The simulation stopped before the controllers were tested.
        return
    wheels = any(joint.type == "continuous" for joint in description.joints)
    lost = _coded(said, frozenset({files.INCLUDE_ABSENT}))
    if lost is not None and wheels and not verdict.movers:
        yield Fault(test="plugin", subject=str(lost.values.get("file", "")), reason=lost)
    replaced = [
        each
        for each in said
        if each.code is devices.HARDWARE_NOT_SIMULATED and "hardware" in each.values
    ]
    # Such hardware may move a robot without joints, such as a quadrotor.
    for tag in managers(description, jointless=bool(replaced)):
        reason = (
            _first(replaced)
            or _first(each for each in said if each.code in _CONTROL and _concerns(each, tag))
            or devices.CONTROLLERS_NOT_FOUND.diagnostic(
                "no file contains controllers for this controller manager", origin=tag.origin
            )
        )
        yield Fault(test="controller", subject=short_name(tag.filename), reason=reason)


def _broadcasts(refused: Diagnostic) -> bool:
    """Whether a controller of unknown type only publishes, because its type says so."""
    unknown = refused.values.get("cause") == devices.CONTROLLER_TYPE_UNKNOWN.number
    return unknown and str(refused.values.get("name")).endswith(_BROADCASTER)


def _concerns(each: Diagnostic, tag: PluginTag) -> bool:
    """Whether a diagnostic may be about a plugin: it is not about another one."""
    return each.values.get("plugin", tag.filename) == tag.filename


def _measured(
    verdict: Verdict,
    children: Mapping[str, str],
    findings: Callable[[], Sequence[Diagnostic]],
    idle: Diagnostic | None,
) -> Iterator[Fault]:
    """The failed tests of a robot that was loaded, with reasons.

    `children` contains the child link of each joint. `idle` is the reason why no controller holds
    the joints; None if one runs or none is needed.
    """
    said = (*verdict.diagnostics, *verdict.observed)
    fallen: Diagnostic | None = None
    if verdict.stand is not None and not verdict.stands:
        fallen = _first(each for each in (*said, *findings()) if _explains_fall(each)) or idle
        yield Fault(test="stand", subject=verdict.stand.state, reason=fallen)
    for topic in verdict.silent:
        reason = _coded(said, frozenset({world.OPENGL_MISSING}))
        yield Fault(test="publish", subject=topic, reason=reason)
    pushed = any(drive.follows and drive.turns for drive in verdict.drives)
    for drive in verdict.drives:
        if pushed and not (drive.follows and drive.turns) and _is_free(said, drive.topic):
            continue
        forward: Diagnostic | None = None
        if not drive.follows:
            forward = reason = _of_drive((*said, *findings()), 1.0 + drive.error, turning=False)
            yield Fault(test="drive", subject=drive.topic, reason=reason)
        if not drive.turns:
            reason = _of_drive(
                (*said, *findings()),
                1.0 + drive.error_turn,
                turning=True,
                arc=drive.turning == "arc",
            )
            if reason is None and forward is not None:
                # The radius of wheels that slide counts for the turn rate by an unknown factor.
                reason = forward if forward.code is robot.WHEEL_DIAMETER_MISMATCH else None
            yield Fault(test="turn", subject=drive.topic, reason=reason)
    for reach in verdict.reaches:
        if not reach.arrived and _is_started(reach.controller, verdict):
            # A robot that fell may lie on its joints.
            names = reach.joint, children.get(reach.joint, "")
            reason = _of_joint((*said, *findings()), *names) or fallen
            yield Fault(test="reach", subject=reach.joint, reason=reason)
    for spin in verdict.spins:
        if not spin.follows:
            names = spin.joint, children.get(spin.joint, "")
            reason = _of_joint((*said, *findings()), *names)
            yield Fault(test="spin", subject=spin.joint, reason=reason)
    for flight in verdict.flights:
        if not flight.flies:
            yield Fault(test="fly", subject=flight.topic)


def _is_started(controller: str, verdict: Verdict) -> bool:
    """Whether ROS runs a controller as well: a file may list more than a launch file starts."""
    return (
        not verdict.spawned
        or controller not in verdict.controllers
        or (controller in verdict.spawned)
    )


def _of_drive(
    found: Sequence[Diagnostic], ratio: float, *, turning: bool, arc: bool = False
) -> Diagnostic | None:
    """The mistake that explains why a base moves at a multiple of the commanded velocity."""
    factors = {each.code: (each, factor) for each in found if (factor := _factor(each, turning))}
    if robot.SKID_STEERING in factors:
        # Its ratio contains the stated separation.
        factors.pop(robot.WHEEL_SEPARATION_MISMATCH, None)
    skids, slowest = factors.get(robot.SKID_STEERING, (None, 1.0))
    if skids is not None and slowest < ratio < max(1.0, _rolling(skids)):
        # Fewer wheels than predicted carry the robot, or the friction depends on the direction.
        return skids
    product = math.prod(factor for _, factor in factors.values())
    legacy = next((each for each in found if _reverses(each)), None) if turning else None
    for sign, cause in ((1.0, None), (-1.0, legacy)):
        if sign < 0 and cause is None:
            continue
        for each, factor in (*factors.values(), (cause, 1.0)):
            ratios = (sign * factor, sign * product)
            if each is not None and any(_follows(ratio, e) for e in ratios):
                return each
    if arc and factors:
        # Steering and rim speeds contradict each other, so the wheels slide.
        expected = [1.0, *(factor for _, factor in factors.values())]
        if min(expected) < ratio < max(expected):
            return next(iter(factors.values()))[0]
    toed = next((each for each in found if turning and arc and _pulls(each, ratio)), None)
    if toed is not None:
        return toed
    codes = _TURNING if turning else _DRIVING
    if 0.0 < ratio < 1.0:
        codes |= {robot.PLANAR_FRICTION}
        if turning and skids is None:
            # Wheels that slide by an unknown amount.
            codes |= {robot.SKID_STEERING}
    if 1.0 - _BRAKED < ratio < 1.0:
        # A caster may also brake a base that drives straight ahead.
        codes |= {robot.CASTER_FRICTION}
    return _first(each for each in found if each.code in codes and not _only_measures(each))


def _pulls(each: Diagnostic, ratio: float) -> bool:
    """Whether steered wheels that point to one side explain the turn rate of a small angle."""
    toe = each.values.get("toe")
    return (
        each.code is robot.WHEELS_TOED
        and isinstance(toe, float)
        and toe * (ratio - 1.0) > 0
        and abs(ratio - 1.0) < _PULLED
    )


def _only_measures(each: Diagnostic) -> bool:
    """Whether it is about a plugin that moves nothing, such as one that publishes joint states."""
    return each.code is running.PLUGIN_LEFT_OUT and reports(
        short_name(str(each.values.get("plugin", "")))
    )


def _follows(ratio: float, expected: float) -> bool:
    """Whether a measured ratio follows from a mistake, rather than from none."""
    error = abs(ratio - expected)
    return error <= _AGREES * abs(expected) and error < abs(ratio - 1.0)


def _rolling(skids: Diagnostic) -> float:
    """The turn rate of wheels that do not slide, relative to the commanded one."""
    ratio = skids.values.get("rolling")
    return ratio if isinstance(ratio, float) else 1.0


def _is_free(said: Iterable[Diagnostic], topic: str) -> bool:
    """Whether a controller only turns wheels without friction, while another drive pushes them."""
    names = topic.split("/")
    return any(
        each.code is robot.WHEEL_FRICTIONLESS and each.values.get("controller") in names
        for each in said
    )


def _reverses(finding: Diagnostic) -> bool:
    """Whether it reports ``<legacyMode>``, which reverses the turning direction."""
    return (
        finding.code is devices.PLUGIN_PARAMETER_OBSOLETE
        and finding.values.get("tag") == "legacyMode"
    )


def _factor(finding: Diagnostic, turning: bool) -> float | None:
    """The velocity relative to the commanded one that follows from a wrong size."""
    values = finding.values
    if finding.code is robot.SKID_STEERING and turning:
        ratio = values.get("ratio")
        return ratio if isinstance(ratio, float) else None
    if finding.code is robot.STEERING_REVERSED and turning:
        return -1.0
    if finding.code is robot.WHEELS_SWAPPED:
        # Seen in the other direction, the robot drives backward instead.
        return -1.0
    stated, measured = values.get("stated"), values.get("measured")
    if not isinstance(stated, float) or not isinstance(measured, float) or stated * measured == 0:
        return None
    if finding.code is robot.WHEEL_DIAMETER_MISMATCH:
        return measured / stated
    if turning and finding.code in (robot.WHEEL_SEPARATION_MISMATCH, robot.WHEEL_BASE_MISMATCH):
        return stated / measured
    return None


def _explains_fall(each: Diagnostic) -> bool:
    if each.code in (files.FILE_MISSING, files.MESH_UNREADABLE):
        return each.values.get("left_out") == "collision"
    return each.code in _STANDING


def _of_joint(found: Sequence[Diagnostic], joint: str, child: str) -> Diagnostic | None:
    return _first(
        each for each in found if each.code in _JOINTS and joint in _joints_of(each)
    ) or _first(each for each in found if _is_heavy(each, child))


def _joints_of(each: Diagnostic) -> tuple[object, ...]:
    """Names in a diagnostic among which are those of the joints that it concerns."""
    joints = each.values.get("joints", ())
    several = joints if isinstance(joints, tuple) else ()
    return (*several, *(each.values.get(key) for key in ("joint", "name", "link")))


def _is_heavy(each: Diagnostic, link: str) -> bool:
    """Whether no motor of usual strength accelerates a link, because of its inertia."""
    ratio = each.values.get("ratio")
    return (
        each.code is robot.INERTIA_GEOMETRY_MISMATCH
        and each.values.get("link") == link
        and isinstance(ratio, float)
        and ratio > _HEAVY
    )


def _coded(found: Iterable[Diagnostic], codes: frozenset[Code]) -> Diagnostic | None:
    return _first(each for each in found if each.code in codes)


def _first(found: Iterable[Diagnostic]) -> Diagnostic | None:
    """The first of the most severe diagnostics."""
    order = {"error": 0, "warning": 1, "info": 2}
    return min(found, key=lambda each: order[each.severity], default=None)
