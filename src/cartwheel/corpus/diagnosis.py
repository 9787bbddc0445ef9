"""Explains failed tests by diagnostics: of the run, and of `cartwheel check`.

The file is long because the explanations of all tests depend on each other.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from cartwheel.codes import devices, files, robot, running, tags, world
from cartwheel.corpus.causes.controllers import (
    is_started,
    is_unmanaged,
    refused_controllers,
    stopped_managers,
    unmanaged_controllers,
    unmanaged_hardware,
)
from cartwheel.corpus.causes.drives import (
    cause_of_drive,
    explains_turn,
    ignored_torque,
    is_free,
    wrong_sizes,
)
from cartwheel.corpus.causes.falls import (
    cause_of_fall,
    falls_through,
    has_devices,
    lost_wheel,
    need_not_stand,
)
from cartwheel.corpus.causes.inertias import flywheel, sluggish
from cartwheel.corpus.causes.plugins import bodiless
from cartwheel.corpus.drive_topics import controller_on, drives_on, without_other_sizes
from cartwheel.corpus.faults import BASES, Fault, Test, coded, is_lost_model, most_severe
from cartwheel.corpus.missing_movers import held_bases, missing_movers
from cartwheel.corpus.movers import LEFT_OUT, dropped_joints, moves_nothing
from cartwheel.corpus.verdict import Verdict
from cartwheel.description.files.package_folders import package_above
from cartwheel.description.model import RobotDescription
from cartwheel.dialects.classic.refusals import refusals
from cartwheel.errors import Diagnostic

_HEAVY = 1000.0
"""Ratio of a link's stated inertia to the largest possible one."""
_DIVERGING = frozenset({robot.SHAPE_OUT_OF_SCALE, robot.POSITION_IN_MILLIMETRES})
"""Lengths in other units, with which shapes are inside each other or kilometres long."""
_LACKING = frozenset({running.PLUGIN_LEFT_OUT, running.CONTROLLER_NOT_STARTED})
"""A plugin or controller that does not start, perhaps because what it names is in another file."""
_UNLIMITED = frozenset({robot.LIMIT_MISSING})
"""For a URDF, neither ROS nor Gazebo loads the robot."""
_NOT_EXPANDED = frozenset({files.DESCRIPTION_NOT_EXPANDED})
_STOPPED = frozenset({files.LAUNCH_STOPS})
_WITHOUT_WHEELS = frozenset(
    {
        robot.BODY_ON_GROUND,
        robot.CASTER_FRICTION,
        robot.PLANAR_FRICTION,
        robot.SKID_STEERING,
        robot.UNBALANCED,
        robot.WHEELS_BRAKED,
        robot.WHEELS_OFF_GROUND,
    }
)
"""What follows from driven wheels without collisions, or is not as predicted without them."""
_BY_SLIDING = frozenset(
    {
        robot.BODY_ON_GROUND,
        robot.CASTER_FRICTION,
        robot.SKID_STEERING,
        robot.WHEEL_SEPARATION_MISMATCH,
    }
)
"""Reasons for a turn rate that depend on how parts slide."""
_JOINTS = frozenset(
    {
        robot.LIMIT_ZERO,
        robot.LIMIT_IN_DEGREES,
        robot.EFFORT_ZERO,
        robot.DAMPING_TOO_HIGH,
        robot.OVERLAPPING_COLLISIONS,
        robot.ROOT_NOT_HELD,
        robot.MIMIC_OUT_OF_LIMITS,
        devices.EFFORT_LIMIT_TOO_LOW,
        devices.CONTROLLER_GAINS_MISSING,
        devices.CONTROLLER_GAIN_TOO_LOW,
        devices.CONTROLLER_UNDAMPED,
        devices.DERIVATIVE_GAIN_TOO_HIGH,
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
    found = [_in_absent_part(each, description) for each in _faults(verdict, description, findings)]
    yield from found or _lost_parts(description)


def _in_absent_part(fault: Fault, description: RobotDescription) -> Fault:
    """The fault; with the part that is left out as its reason, if that would explain it."""
    absent = None if fault.reason is None else _absent_part(fault.reason, description)
    if absent is None:
        return fault
    outside = is_lost_model(absent) or absent.values.get("package")
    return replace(fault, reason=absent, sure=fault.sure and not outside)


def _lost_parts(description: RobotDescription) -> Iterator[Fault]:
    """Calls of macros and models that are left out, because their files are not here.

    What they would add to the robot may work or not.
    """
    for each in description.diagnostics:
        if _is_lost_part(each):
            yield Fault(test="load", subject=str(each.values["name"]), reason=each, sure=False)


def _is_lost_part(each: Diagnostic) -> bool:
    """Whether it is a macro or model that is left out, because its file is not here."""
    called = each.code is files.MACRO_ABSENT and bool(each.values.get("package"))
    return called or is_lost_model(each)


def _absent_part(reason: Diagnostic, description: RobotDescription) -> Diagnostic | None:
    """The model or macro that is left out, and would contain what does not exist.

    The name of what is in a model is scoped, as in ``leg::knee``, unless the model is merged.
    """
    lost = [each for each in description.diagnostics if is_lost_model(each)]
    model, inside, _ = str(reason.values.get("name", "")).partition("::")
    named = (each for each in lost if inside and each.values.get("instance") == model)
    found = next(named, None)
    if inside or reason.values.get("meant") or reason.code not in _LACKING:
        return found
    parts = (each for each in description.diagnostics if _is_lost_part(each))
    return next(parts, None) if reason.values.get("kind") else None


def _faults(
    verdict: Verdict, description: RobotDescription, findings: Callable[[], Sequence[Diagnostic]]
) -> Iterator[Fault]:
    if verdict.failure is not None:
        reason = verdict.failure
        if verdict.loaded and reason.code is world.SIMULATION_DIVERGED:
            reason = coded(findings(), _DIVERGING) or reason
        yield Fault(test="simulate" if verdict.loaded else "load", reason=reason)
    if not verdict.loaded:
        return
    stopped = _stopping_include(description)
    yield from _load_faults(verdict, description, stopped)
    # Two plugins of a kind are one fault.
    held = bool([*held_bases(verdict, description, findings)])
    missing = {
        fault.subject: fault
        for fault in reversed([*missing_movers(verdict, description, findings, held=held)])
        if (stopped is None or fault.reason is not stopped)
        and not (fault.code is devices.PLUGIN_UNKNOWN and moves_nothing(fault.reason, description))
    }
    unmanaged = dict(unmanaged_hardware(verdict, description, findings))
    if unmanaged:
        # What is driven here instead does not matter.
        instead = (devices.HARDWARE_NOT_SIMULATED, devices.HARDWARE_UNKNOWN)
        missing = {name: fault for name, fault in missing.items() if fault.code not in instead}
    missing |= refused_controllers(verdict)
    stopped_ones = {each.subject: each for each in stopped_managers(verdict, description)}
    if stopped_ones:
        # Which of its controllers would not start does not matter.
        missing = {name: each for name, each in missing.items() if each.test != "controller"}
    missing |= stopped_ones | unmanaged
    spawned = verdict.launch is not None and bool(verdict.launch.spawned)
    missing |= {each.subject: each for each in unmanaged_controllers(findings) if spawned}
    yield from reversed(missing.values())
    yield from bodiless(verdict, missing)
    idle = next((each.reason for each in missing.values() if each.test == "controller"), None)
    moved = verdict.drives or verdict.reaches or verdict.spins or verdict.flights
    yield from _measured(verdict, description, findings, None if moved else idle)


def _load_faults(
    verdict: Verdict, description: RobotDescription, stopped: Diagnostic | None
) -> Iterator[Fault]:
    """What is not loaded of a robot that Cartwheel loads.

    `stopped` is what `_stopping_include` returns.
    """
    reasons = (
        _unloaded(verdict, description),
        coded(description.diagnostics, _UNLIMITED),
        _material_twice(description),
        _refused(description),
        _cut_short(description),
        coded(verdict.observed, _NOT_EXPANDED),
        coded(verdict.observed, _STOPPED),
    )
    for reason in reasons:
        if reason is not None:
            yield Fault(test="load", reason=reason)
    yield from _files_of_author(verdict, description)
    for joint, dropped in dropped_joints(verdict, description):
        yield Fault(test="load", subject=joint, reason=dropped)
    for built in filter(is_lost_model, description.diagnostics):
        if "template" in built.values:
            yield Fault(test="load", subject=str(built.values["name"]), reason=built)
    if stopped is not None:
        yield Fault(test="load", subject=str(stopped.values["file"]), reason=stopped)


def _unloaded(verdict: Verdict, description: RobotDescription) -> Diagnostic | None:
    """Why Gazebo does not load a robot for it: its root link has no mass, or the link that is fixed
    to the world.

    A description without plugins and sensors that no launch file starts in Gazebo may be one for
    other programs, in which links need no mass. If it falls because no link has a collision, it is
    no robot for Gazebo, and Gazebo reports the mass first, unless its launch file is for RViz.
    """
    started = verdict.launch is not None and verdict.launch.simulated
    shapes = any(link.collisions for link in description.links)
    falls = verdict.stand is not None and falls_through(verdict.stand) and not shapes
    falls = falls and not need_not_stand(verdict, description)
    if not (verdict.movers or has_devices(description) or started or falls):
        return None
    if coded(description.diagnostics, LEFT_OUT) is not None:
        # The missing part may contain the mass.
        return None
    held = {joint.child for joint in description.joints}
    for each in description.diagnostics:
        links = each.values.get("links", ())
        if each.code is not robot.INERTIA_MISSING or not isinstance(links, tuple):
            continue
        if each.values.get("held") is True or any(name not in held for name in links):
            return each
    return None


def _refused(description: RobotDescription) -> Diagnostic | None:
    """What the URDF parser of ROS and Gazebo refuses, an inertia for which gz-sim does not load a
    robot that is for gz-sim only, noise for which it does not, and with which Gazebo Classic
    crashes, or what it refuses in a robot that launch files start in gz-sim.
    """
    return next(
        (
            each
            for each in description.diagnostics
            if each.values.get("refused") is True
            or each.values.get("refused_by", "") == description.simulator != ""
            or (each.code is devices.NOISE_TYPE_UNKNOWN and each.severity == "error")
        ),
        None,
    )


def _cut_short(description: RobotDescription) -> Diagnostic | None:
    """The first link of which ROS and Gazebo do not read the inertia or collisions."""
    return next(
        (
            each
            for each in description.diagnostics
            if each.values.get("cut") is True and each.severity == "error"
        ),
        None,
    )


def _files_of_author(verdict: Verdict, description: RobotDescription) -> Iterator[Fault]:
    """The first file of each use that is only in a home folder of the robot's author.

    Cartwheel finds such files in the robot's package, or others instead; ROS and Gazebo do not.
    """
    said = (*description.diagnostics, *verdict.diagnostics, *verdict.observed)
    said = (*(each for each in said if "unfound" not in each.values), *said)
    key = "needed_for"
    lost = {each.values[key]: each for each in reversed(said) if key in each.values}
    for use, reason in reversed(lost.items()):
        # A package that was not found may be installed elsewhere, and contain the file.
        yield Fault(
            test="controller" if use == "controllers" else "load",
            reason=reason,
            sure="unfound" not in reason.values,
        )


def _material_twice(description: RobotDescription) -> Diagnostic | None:
    """The second definition of a material, for which neither ROS nor Gazebo loads a URDF."""
    return next(
        (
            each
            for each in description.diagnostics
            if each.code is tags.NAME_TAKEN and each.values.get("tag") == "material"
        ),
        None,
    )


def _stopping_include(description: RobotDescription) -> Diagnostic | None:
    """An include that stops xacro because its package does not contain the file.

    Unlike a package, the file is not only absent here, unless the package's build makes it.
    """
    return next(
        (
            each
            for each in description.diagnostics
            if each.code is files.INCLUDE_ABSENT
            and each.values.get("kind") != "package"
            and not each.values.get("template")
            and _is_complete(Path(str(each.values["name"])))
        ),
        None,
    )


def _is_complete(file: Path) -> bool:
    """Whether the package of an absent file is here, or else files beside it."""
    folder = Path(os.path.normpath(file)).parent
    try:
        return package_above(folder) is not None or any(folder.iterdir())
    except OSError:
        return False


def _measured(
    verdict: Verdict,
    description: RobotDescription,
    findings: Callable[[], Sequence[Diagnostic]],
    idle: Diagnostic | None,
) -> Iterator[Fault]:
    """The failed tests of a robot that was loaded, with reasons.

    `idle` is the reason why no controller holds the joints, apart from those that only publish;
    None if one does or none is needed.
    """
    children = {joint.name: joint.child for joint in description.joints}
    said = (*verdict.diagnostics, *verdict.observed)
    fallen: Diagnostic | None = None
    wheel = lost_wheel(said, description, verdict.driven) if verdict.drives else None
    if verdict.stand is not None and not (verdict.stands or need_not_stand(verdict, description)):
        followed = any(drive.follows for drive in verdict.drives)
        everything = [
            each
            for each in (*said, *findings())
            if not followed or each.code is not robot.WHEELS_OFF_GROUND
        ]
        fallen = cause_of_fall(verdict.stand, description, everything, idle, wheel)
        yield Fault(test="stand", subject=verdict.stand.state, reason=fallen)
    toppled = next((each for each in verdict.observed if _topples(each)), None)
    if toppled is not None:
        yield Fault(test="stand", subject="tips", reason=toppled)
    for topic in verdict.silent:
        reason = coded(said, frozenset({world.OPENGL_MISSING}))
        yield Fault(test="publish", subject=topic, reason=reason)
    for subject, reason in held_bases(verdict, description, findings):
        yield Fault(test="drive", subject=subject, reason=reason)

    def explaining(test: Test, subject: str) -> list[Diagnostic]:
        found = _explaining((*said, *findings()), verdict, description, (test, subject))
        if fallen or flywheel((*said, *findings()), description):
            # On what a robot lies that fell or rocks is no reason.
            found = [each for each in found if "unloaded" not in each.values]
        # A robot without its wheels rests on what it drags.
        return found if wheel is None else [e for e in found if e.code not in _WITHOUT_WHEELS]

    sank = verdict.stand is not None and verdict.stand.state == "sinks"
    pushed = any(drive.passes for drive in verdict.drives)
    for drive in verdict.drives:
        if pushed and not drive.passes and is_free(said, drive.topic):
            continue
        if is_unmanaged(controller_on(drive.topic, verdict.controllers), verdict, description):
            # Gazebo does not move it at all, which is a fault of its own.
            continue
        forward: Diagnostic | None = None
        explained: list[Diagnostic] = []
        wrong: list[Diagnostic] = []
        # A robot that fell cannot drive, nor one that its own wheels throw over.
        unsteady = wheel or fallen or flywheel((*said, *findings()), description)
        if not drive.follows:
            found = explaining("drive", drive.topic)
            forward = cause_of_drive(found, 1.0 + drive.error)
            reason = forward or unsteady or _too_slow(found, 1.0 + drive.error)
            wrong += wrong_sizes(found, 1.0 + drive.error)
            explained += [reason] if reason is not None else []
            yield Fault(test="drive", subject=drive.topic, reason=reason)
        if not drive.turns:
            found = explaining("turn", drive.topic)
            reason = cause_of_drive(
                found,
                1.0 + drive.error_turn,
                turning=True,
                arc=drive.turning == "arc",
            )
            if reason is None and explains_turn(forward, 1.0 + drive.error, 1.0 + drive.error_turn):
                reason = forward
            if sank and drive.follows:
                # It also stands well enough to drive.
                unsteady = wheel
            reason = reason or unsteady or _too_slow(found, 1.0 + drive.error_turn)
            wrong += wrong_sizes(found, 1.0 + drive.error_turn, turning=True)
            explained += [reason] if reason is not None else []
            sure = reason is None or not (reason.code in _BY_SLIDING and _slipping(found))
            yield Fault(test="turn", subject=drive.topic, reason=reason, sure=sure)
        elif _has_slip(description) and drive.commanded_turn:
            reason = _slipping(explaining("turn", drive.topic))
            if reason is not None:
                yield Fault(test="turn", subject=drive.topic, reason=reason, sure=False)
        if not drive.slides:
            found = explaining("sideways", drive.topic)
            reason = cause_of_drive(found, 1.0 + drive.error_sideways, sideways=True)
            yield Fault(test="sideways", subject=drive.topic, reason=reason or unsteady)
        # Whatever else is wrong, these sizes are, too.
        told = {each.code for each in explained}
        for code, each in {each.code: each for each in reversed(wrong)}.items():
            if code not in told:
                about: Test = "drive" if code is robot.WHEEL_DIAMETER_MISMATCH else "turn"
                yield Fault(test=about, subject=drive.topic, reason=each)
    for reach in verdict.reaches:
        if not reach.arrived and is_started(reach.controller, verdict):
            # A robot that fell may lie on its joints. If it only sank, those that the ground holds
            # were tested again above it.
            names = reach.joint, children.get(reach.joint, "")
            found = explaining("reach", reach.joint)
            reason = _of_joint(found, *names) or (None if sank else fallen or toppled)
            yield Fault(test="reach", subject=reach.joint, reason=reason)
    for spin in verdict.spins:
        if not spin.follows:
            names = spin.joint, children.get(spin.joint, "")
            found = explaining("spin", spin.joint)
            reason = _of_joint(found, *names)
            yield Fault(test="spin", subject=spin.joint, reason=reason)
    for flight in verdict.flights:
        if not flight.flies:
            yield Fault(test="fly", subject=flight.topic)
    for reason in _unpublished(verdict, description, findings):
        sensors = reason.values.get("sensors", ())
        subject = ", ".join(map(str, sensors)) if isinstance(sensors, tuple) else ""
        yield Fault(test="publish", subject=subject, reason=reason)


def _too_slow(found: Sequence[Diagnostic], ratio: float) -> Diagnostic | None:
    """What explains that a base is too slow, if nothing else does."""
    return ignored_torque(found, ratio) or sluggish(found, ratio)


def _unpublished(
    verdict: Verdict, description: RobotDescription, findings: Callable[[], Sequence[Diagnostic]]
) -> Iterator[Diagnostic]:
    """Why Gazebo does not publish some sensors, which Cartwheel does in any world and with any type
    that a sensor has.
    """
    yield from refusals(description)
    sensors = any(link.sensors for link in description.links)
    if sensors and (verdict.model or verdict.launch is not None):
        yield from (each for each in findings() if each.code is devices.SENSOR_SYSTEM_MISSING)


def _topples(each: Diagnostic) -> bool:
    """Whether it is about a robot that fell when its joints moved; see `resting.toppled`."""
    return each.code is robot.UNBALANCED and "joints" in each.values


def _has_slip(description: RobotDescription) -> bool:
    """Whether a collision states slip."""
    surfaces = (part.surface for link in description.links for part in link.collisions)
    return any(each.slip1 or each.slip2 for each in surfaces)


def _slipping(found: Sequence[Diagnostic]) -> Diagnostic | None:
    """The finding that slip, which is not simulated, changes the turn rate."""
    return next((each for each in found if each.values.get("slip") is True), None)


def _explaining(
    found: Sequence[Diagnostic],
    verdict: Verdict,
    description: RobotDescription,
    failed: tuple[Test, str],
) -> list[Diagnostic]:
    """The diagnostics that may explain a failed test, by what the tests showed.

    `failed` contains the test, and the topic or joint.
    """
    test, subject = failed
    hindered = failed in verdict.hindered
    # A plugin that sets the velocity of the whole robot also moves it sideways.
    rolls = not any(each.commanded_sideways for each in verdict.drives if each.topic == subject)
    if test in BASES:
        found = without_other_sizes(found, subject, description, verdict.controllers)
    return [
        each
        for each in found
        if (
            hindered
            or each.code is not running.JOINT_DRIVEN_TWICE
            or (test in BASES and rolls and "overridden" in each.values)
        )
        and not (test in BASES and _topples(each))
        and (
            test not in BASES
            or each.code not in (running.PLUGIN_LEFT_OUT, robot.DRIVE_JOINT_UNKNOWN)
            or drives_on(each, subject, description, verdict.controllers)
        )
    ]


def _of_joint(found: Sequence[Diagnostic], joint: str, child: str) -> Diagnostic | None:
    shared = (each for each in found if each.code is running.JOINT_SHARED)
    lost = next((each for each in shared if each.values.get("joint") == joint), None)
    # With such an inertia, the gains do not matter.
    return (
        lost
        or most_severe(each for each in found if _is_heavy(each, child))
        or most_severe(each for each in found if each.code in _JOINTS and joint in _joints_of(each))
    )


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
