"""Controllers that Gazebo or ROS does not start, although Cartwheel does or others may run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from cartwheel.codes import devices
from cartwheel.corpus.faults import Fault, coded
from cartwheel.corpus.movers import LEFT_OUT, managers
from cartwheel.corpus.verdict import Verdict
from cartwheel.description.elements.xml import shown_path
from cartwheel.description.launches import moves
from cartwheel.description.model import RobotDescription
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.gz.gazebo_only import not_loaded
from cartwheel.dialects.ros2_control.unloaded import unloaded_systems
from cartwheel.errors import Diagnostic


def unmanaged_hardware(
    verdict: Verdict,
    description: RobotDescription,
    findings: Callable[[], Sequence[Diagnostic]],
) -> Iterator[tuple[str, Fault]]:
    """Hardware of a robot that no plugin runs in Gazebo, by name: that for Gazebo, if nothing else
    moves the robot, and that which the robot's plugin does not load.
    """
    if not description.ros2_control or (verdict.movers and not _stands_still(description)):
        return
    for each in findings():
        if each.code is devices.HARDWARE_WITHOUT_PLUGIN and each.severity != "info":
            name = str(each.values["name"])
            yield name, Fault(test="controller", subject=name, reason=each)


def _stands_still(description: RobotDescription) -> bool:
    """Whether Gazebo loads no hardware of a robot."""
    commanded = [
        system
        for system in description.ros2_control
        if any(joint.find("command_interface") for joint in system.find_all("joint"))
    ]
    lost = {id(system) for system, _ in unloaded_systems(description)}
    return bool(lost) and all(id(each) in lost for each in commanded)


def unmanaged_controllers(findings: Callable[[], Sequence[Diagnostic]]) -> Iterator[Fault]:
    """Controllers that a launch file starts for a robot in Gazebo, although no plugin runs them.

    Plugins may drive other joints of the robot, or a program of the repository with a manager.
    """
    for each in findings():
        if each.code is devices.HARDWARE_WITHOUT_PLUGIN and each.values.get("spawned"):
            name, sure = str(each.values["name"]), "program" not in each.values
            yield Fault(test="controller", subject=name, reason=each, sure=sure)


def stopped_managers(verdict: Verdict, description: RobotDescription) -> Iterator[Fault]:
    """Controller managers that do not start in Gazebo because of a transmission, although
    controllers should run. Cartwheel skips the transmission.
    """
    said = verdict.diagnostics
    if not (verdict.controllers or verdict.spawned) or coded(said, LEFT_OUT) is not None:
        # The missing part may contain the joint.
        return
    reason = next((each for each in said if each.values.get("stops") is True), None)
    for tag in managers(description) if reason is not None else ():
        if not_loaded(description, tag) is None:
            yield Fault(test="controller", subject=short_name(tag.filename), reason=reason)


def refused_controllers(verdict: Verdict) -> dict[str, Fault]:
    """Controllers that ROS does not start although others may run, by name: because of the type of
    a parameter, which Cartwheel converts, or because their own type or parameters are not stated.
    """
    found: dict[str, Fault] = {}
    for each in (*verdict.diagnostics, *verdict.observed):
        name = str(each.values.get("controller", ""))
        mistyped = each.code is devices.CONTROLLER_PARAMETER_TYPE and is_started(name, verdict)
        if name and (mistyped or (_is_undefined(each, verdict) and moves(name))):
            # The files of a package that was not found may contain the parameters.
            sure = not each.values.get("foreign")
            found.setdefault(name, Fault(test="controller", subject=name, reason=each, sure=sure))
    return found


def is_unmanaged(controller: str, verdict: Verdict, description: RobotDescription) -> bool:
    """Whether Gazebo does not run a controller that was tested, because its manager exists only for
    another Gazebo or version of ROS, or because a parameter has the wrong type.
    """
    if controller in refused_controllers(verdict):
        return True
    tags = managers(description) if controller in verdict.controllers else []
    return bool(tags) and all(not_loaded(description, tag) is not None for tag in tags)


def is_started(controller: str, verdict: Verdict) -> bool:
    """Whether ROS runs a controller as well: a file may list more than a launch file starts."""
    return (
        not verdict.spawned
        or controller not in verdict.controllers
        or (controller in verdict.spawned)
    )


def _is_undefined(each: Diagnostic, verdict: Verdict) -> bool:
    """Whether the launch file that starts the robot, and no other one, starts a controller without
    parameters.
    """
    if each.code is not devices.CONTROLLER_UNDEFINED or is_misplaced(each):
        return False
    if "untyped" in each.values:
        return True
    use, origin = verdict.launch, each.origin
    if use is None or use.several or origin is None:
        return False
    return origin.file == shown_path(use.file)


def is_misplaced(each: Diagnostic) -> bool:
    """Whether a controller is started in another namespace than that of its parameters."""
    return each.code is devices.CONTROLLER_UNDEFINED and "namespace" in each.values
