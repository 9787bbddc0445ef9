"""What should move a robot and is missing: plugins, and controllers that did not start."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from cartwheel.checks.controller_claims import uncommanded
from cartwheel.checks.robot import Robot
from cartwheel.codes import devices, files, robot, running
from cartwheel.corpus.causes.controllers import is_misplaced, is_started
from cartwheel.corpus.causes.falls import is_body_lost
from cartwheel.corpus.faults import Fault, coded, most_severe
from cartwheel.corpus.movers import (
    ignored_movers,
    is_known,
    is_own_mover,
    managers,
    moving_plugins,
    named_movers,
)
from cartwheel.corpus.verdict import Verdict
from cartwheel.description.model import PluginTag, RobotDescription
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.gz.gazebo_only import not_loaded
from cartwheel.dialects.ros2_control.unstarted import without_parameters
from cartwheel.dialects.ros_only import other_tags
from cartwheel.dialects.world_plugins import refused
from cartwheel.errors import Diagnostic

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
"""Causes for which a controller does not start in ROS either, although another works."""


def missing_movers(
    verdict: Verdict,
    description: RobotDescription,
    findings: Callable[[], Sequence[Diagnostic]],
    *,
    held: bool,
) -> Iterator[Fault]:
    """Plugins that should move the robot and are missing, and controllers that did not start.

    Args:
        verdict: The measurements.
        description: The robot.
        findings: Returns the findings of `cartwheel check`.
        held: Whether something that drives a base was not tested, because the base is fixed.
    """
    said = verdict.diagnostics
    all_moves = verdict.passes and _is_all_driven(verdict, description)
    named = named_movers(description)
    moved = _is_moved(verdict, description)
    for tag in moving_plugins(description):
        unloaded = not_loaded(description, tag)
        if unloaded is not None and unloaded.severity == "info":
            # Another plugin moves the robot in its Gazebo.
            continue
        if is_known(tag):
            # Why it is left out here does not matter if Gazebo does not read these tags.
            reason = refused(tag) or unloaded or other_tags(description, tag)
            reason = reason or most_severe(
                each
                for each in said
                if each.code in (running.PLUGIN_LEFT_OUT, running.PLUGIN_FAILED)
                and each.values.get("plugin") == tag.filename
            )
        elif (all_moves and not is_own_mover(tag)) or (moved and tag not in named):
            # The report lists it among the missing plugins.
            continue
        else:
            although = "" if tag in named else ", although its source moves a model"
            reason = devices.PLUGIN_UNKNOWN.diagnostic(
                f'plugin "{tag.filename}" is not supported, so it has no effect{although}',
                severity="warning",
                origin=tag.origin,
                values={"name": tag.filename},
            )
        if reason is not None:
            yield Fault(test="plugin", subject=short_name(tag.filename), reason=reason)
    for name, reason in ignored_movers(description):
        yield Fault(test="plugin", subject=name, reason=reason)
    # Cartwheel runs the plugins of both versions, so the tests do not show that one is missing.
    # Nor does it need the tags without which Gazebo's plugin does not start.
    idle = [(tag, _not_started(description, tag, findings)) for tag in managers(description)]
    if all(reason is not None for _, reason in idle):
        for tag, reason in idle:
            yield Fault(test="controller", subject=short_name(tag.filename), reason=reason)
    for each in findings():
        # The tests started them nevertheless.
        if each.code is devices.CONTROLLERS_NOT_FOUND and "launch" in each.values:
            name = short_name(str(each.values["plugin"]))
            yield Fault(test="controller", subject=name, reason=each)
    unstarted = {
        each.values.get("controller"): each
        for each in said
        if each.code is running.CONTROLLER_NOT_STARTED
        and each.values.get("cause") not in _ALTERNATIVE
    }
    unread: Diagnostic | None = None
    for name in verdict.spawned:
        if name in verdict.controllers:
            continue
        if name in unstarted and not _broadcasts(unstarted[name]):
            reason = unstarted[name]
            unknown = reason.values.get("cause") == devices.CONTROLLER_JOINT_UNKNOWN.number
            if unknown and not _is_prefixed(reason):
                # The part that contains the joint may be in a file that is absent.
                reason = coded(said, frozenset({files.INCLUDE_ABSENT})) or reason
            sure = not _is_in_unfound_package(reason)
            yield Fault(test="controller", subject=name, reason=reason, sure=sure)
        found = next((each for each in verdict.observed if _contains(each, name)), None)
        if found is not None:
            unread = found
            yield Fault(test="controller", subject=name, reason=found)
    apart = [each for each in verdict.observed if is_misplaced(each)]
    for each in apart:
        yield Fault(test="controller", subject=str(each.values["controller"]), reason=each)
    if apart or held or verdict.drives or verdict.reaches or verdict.spins or verdict.flights:
        return
    if verdict.failure is not None and verdict.controllers:
        # The simulation stopped before the controllers were tested.
        return
    lost = None if verdict.movers else _lost_mover(verdict, description)
    if lost is not None:
        yield lost
    replaced = [
        each
        for each in said
        if each.code is devices.HARDWARE_NOT_SIMULATED and "hardware" in each.values
    ]
    # Such hardware may move a robot without transmissions, such as a quadrotor. Joints that have
    # transmissions, but no controllers, do not move with any hardware.
    hardware = (*description.transmissions, *description.ros2_control)
    listed = any(True for each in hardware for _ in each.find_all("joint"))
    moves = listed and any(joint.type != "fixed" for joint in description.joints)
    stopped = replaced if verdict.controller_files or verdict.spawned or not moves else []
    codes = _CONTROL - {devices.CONTROL_WITHOUT_JOINTS} if replaced else _CONTROL
    causes = (devices.CONTROLLER_UNDEFINED, devices.CONTROLLER_ONLY_LOADED)
    undefined = [
        each
        for each in verdict.observed
        if each.code in causes and managers(description, jointless=True)
    ]
    for each in undefined:
        name, sure = str(each.values["controller"]), not each.values.get("foreign")
        yield Fault(test="controller", subject=name, reason=each, sure=sure)
    use = verdict.launch
    for tag in managers(description, jointless=bool(replaced)):
        # Without its manager, it does not matter what else is wrong.
        reason = _not_started(description, tag, findings) or most_severe(stopped)
        reason = reason or most_severe(
            each for each in said if each.code in codes and _concerns(each, tag)
        )
        # Only the execution of a launch file may determine its controllers.
        sure = use is None or not (use.incomplete or use.typed)
        if reason is None and not undefined and unread is None:
            reason = _uncommanded(verdict, tag)
        if reason is not None:
            subject = short_name(tag.filename)
            yield Fault(test="controller", subject=subject, reason=reason, sure=sure)


def _not_started(
    description: RobotDescription, tag: PluginTag, findings: Callable[[], Sequence[Diagnostic]]
) -> Diagnostic | None:
    """Why Gazebo does not start a controller manager; None if it does."""
    reason = not_loaded(description, tag)
    if reason is not None or without_parameters(tag) is None:
        return reason
    return next(
        (
            each
            for each in findings()
            if each.code is devices.CONTROLLERS_NOT_FOUND
            and each.values.get("plugin") == tag.filename
            and each.severity != "info"
        ),
        None,
    )


def _is_moved(verdict: Verdict, description: RobotDescription) -> bool:
    """Whether supported plugins and controllers move the base, or all joints, or a held robot."""
    if verdict.drives or verdict.flights:
        return True
    held = verdict.stand is not None and verdict.stand.fixed
    commanded = bool(verdict.reaches or verdict.spins)
    return commanded and (held or _movable(description) <= verdict.driven)


def _is_all_driven(verdict: Verdict, description: RobotDescription) -> bool:
    """Whether supported plugins and controllers drive all joints, and the base if it can move."""
    held = verdict.stand is not None and verdict.stand.fixed
    driven = _movable(description) <= verdict.driven
    return driven and (held or bool(verdict.drives or verdict.flights))


def _movable(description: RobotDescription) -> set[str]:
    """The joints that can move: not those whose limits leave no room, as of attached sensors."""
    return {
        each.name
        for each in description.joints
        if each.type != "fixed"
        and not (
            each.axis.lower is not None
            and each.axis.upper is not None
            and each.axis.upper <= each.axis.lower
        )
    }


def _lost_mover(verdict: Verdict, description: RobotDescription) -> Fault | None:
    """The absent include that may contain what moves a robot that nothing else moves.

    A robot without wheels need not move, unless a launch file starts it in Gazebo, or the include
    contains its base. Then it is unknown whether the include would move it, as it is if a build
    makes the file, or if its package was not found.
    """
    absent = [each for each in verdict.diagnostics if each.code is files.INCLUDE_ABSENT]
    made = [each for each in absent if each.values.get("template")]
    lost = most_severe(made or absent)
    wheels = any(joint.turns for joint in description.joints)
    started = verdict.launch is not None and verdict.launch.simulated
    # If what is left of it falls, the fall is the fault.
    baseless = verdict.stands and any(
        is_body_lost(each, description) for each in verdict.diagnostics
    )
    if lost is None or not (wheels or started or baseless):
        return None
    subject = str(lost.values.get("file", ""))
    sure = wheels and not made and not _is_in_unfound_package(lost)
    return Fault(test="plugin", subject=subject, reason=lost, sure=sure)


def _is_in_unfound_package(reason: Diagnostic) -> bool:
    """Whether an include is left out because its package is not installed here."""
    return reason.code is files.INCLUDE_ABSENT and reason.values.get("kind") == "package"


def _is_prefixed(unstarted: Diagnostic) -> bool:
    """Whether the unknown joint of a controller has a prefix that the robot's joint has not, or
    the other way round.
    """
    name, meant = (str(unstarted.values.get(key) or "") for key in ("name", "meant"))
    return bool(name and meant) and (name.endswith(meant) or meant.endswith(name))


def _uncommanded(verdict: Verdict, tag: PluginTag) -> Diagnostic:
    """Why no controller of a manager commands a joint."""
    started = tuple(name for name in verdict.spawned if name in verdict.controllers)
    use = verdict.launch
    if use is None:
        return uncommanded(tag, None, started)
    return uncommanded(tag, use.file, started, use.controllers)


def _contains(each: Diagnostic, controller: str) -> bool:
    """Whether a diagnostic is about an unreadable file with this controller."""
    names = each.values.get("controllers", ())
    return (
        each.code is devices.CONTROLLERS_FILE_UNREADABLE
        and isinstance(names, tuple)
        and controller in names
    )


def _broadcasts(unstarted: Diagnostic) -> bool:
    """Whether a controller of unknown type only publishes, because its type says so."""
    unknown = unstarted.values.get("cause") == devices.CONTROLLER_TYPE_UNKNOWN.number
    return unknown and str(unstarted.values.get("name")).endswith(_BROADCASTER)


def _concerns(each: Diagnostic, tag: PluginTag) -> bool:
    """Whether a diagnostic may be about a plugin: it is not about another one."""
    return each.values.get("plugin", tag.filename) == tag.filename


def held_bases(
    verdict: Verdict,
    description: RobotDescription,
    findings: Callable[[], Sequence[Diagnostic]],
) -> Iterator[tuple[str, Diagnostic]]:
    """Plugins and controllers that cannot drive a robot, because it is fixed to the world."""
    if verdict.stand is None or not verdict.stand.fixed:
        return
    if not verdict.controllers and not Robot(description, None).drives:
        return
    for each in findings():
        if each.code is robot.BASE_FIXED:
            controller = str(each.values.get("controller", ""))
            if not controller:
                yield short_name(str(each.values["plugin"])), each
            elif controller in verdict.controllers and is_started(controller, verdict):
                yield controller, each
