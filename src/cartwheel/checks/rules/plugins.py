"""Plugins and their parameters, compared with what the plugins read."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from cartwheel.checks import nodes, spelling
from cartwheel.checks.rule import rule
from cartwheel.checks.rules import frames
from cartwheel.checks.rules.control import is_known
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element, PluginTag
from cartwheel.errors import Diagnostic, meant_one

_GAZEBO = frozenset({
    "diff_drive", "skid_steer_drive", "tricycle_drive", "planar_move", "ackermann_drive",
    "camera", "multicamera", "triggered_camera", "triggered_multicamera", "depth_camera",
    "openni_kinect", "prosilica", "laser", "gpu_laser", "block_laser", "ray_sensor", "range",
    "imu", "imu_sensor", "gps_sensor", "p3d", "bumper", "f3d", "ft_sensor", "force", "control",
    "joint_state_publisher", "joint_pose_trajectory", "hand_of_god", "vacuum_gripper",
    "elevator", "harness", "wheel_slip", "projector", "video", "template",
})  # fmt: skip
"""The names in ``libgazebo_ros_<name>.so``, some of which are similar."""
_CLASSIC = re.compile(r"(?:lib)?(gazebo_ros_\w+)(?:\.so)?")


@rule(devices_codes.PLUGIN_UNKNOWN)
def plugin_unknown(subject: Subject) -> Iterator[Diagnostic]:
    knowledge = subject.plugins
    if knowledge is None:
        return
    for robot in subject.robots:
        for tag, sensor in robot.plugins():
            if (own := _plain_file(tag.filename)) != tag.filename:
                yield devices_codes.PLUGIN_UNKNOWN.diagnostic(
                    severity="warning",
                    message=f'Gazebo loads the file "{tag.filename}", but the plugin is in "{own}"',
                    values={"plugin": tag.filename, "meant": own},
                    origin=tag.origin,
                    instead=f'filename="{own}"',
                    place="attribute",
                    mark=tag.filename,
                )
                continue
            if knowledge.judge(tag, sensor) is not None:
                continue
            # Suggest a tag only for misspelt names: other plugins share most of their tags.
            near = meant_one(tag.filename, knowledge.filenames, cutoff=0.92)
            if frames.short_name(tag) in _GAZEBO:
                near = ""
            yield devices_codes.PLUGIN_UNKNOWN.diagnostic(
                severity="warning" if near else "info",
                message=f'the plugin "{tag.filename}" does not exist'
                if near
                else f'Cartwheel does not simulate the plugin "{tag.filename}"',
                values={"plugin": tag.filename, "meant": near},
                origin=tag.origin,
                instead=f'filename="{near}"' if near else "",
                place="attribute" if near else "",
                mark=tag.filename,
            )


@rule(devices_codes.PLUGIN_PARAMETER_UNKNOWN)
def plugin_parameter(subject: Subject) -> Iterator[Diagnostic]:
    if subject.plugins is None:
        return
    for robot in subject.robots:
        for tag, sensor in robot.plugins():
            for diagnostic in subject.plugins.judge(tag, sensor) or ():
                yield _advised(tag, diagnostic)


@rule(devices_codes.PLUGIN_PARAMETER_MISSING)
def joint_missing(subject: Subject) -> Iterator[Diagnostic]:
    """Plugins without a joint parameter whose default joint does not exist either."""
    knowledge = subject.plugins
    if knowledge is None or knowledge.default_joints is None:
        return
    for robot in subject.robots:
        for tag, sensor in robot.plugins():
            defaults = [*knowledge.default_joints(tag)]
            if all(is_known(joint, robot, subject) for _, joint in defaults):
                continue
            # Misspelt tags are reported by another rule.
            misspelt = {each.values.get("meant") for each in knowledge.judge(tag, sensor) or ()}
            for spellings, joint in defaults:
                if not is_known(joint, robot, subject) and misspelt.isdisjoint(spellings):
                    yield devices_codes.PLUGIN_PARAMETER_MISSING.diagnostic(
                        f'<{spellings[0]}> is missing, and its default, the joint "{joint}", '
                        "does not exist",
                        values={"parameter": spellings[0], "joint": joint},
                        origin=tag.origin,
                        hint=spelling.nearest(joint, robot.joint_names),
                    )


@rule(devices_codes.PLUGIN_PARAMETER_OBSOLETE)
def plugin_obsolete(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for drive in robot.drives:
            element = drive.tag.element
            if "gazebo_ros_diff_drive" not in drive.tag.filename:
                continue
            torque, legacy = element.find("torque"), element.find("legacyMode")
            roles = {each.role: each for each in robot.roles(drive.tag.filename)}
            stated = roles.get("wheel_torque")
            known = stated and any(element.find(name) for name in stated.tags if name != "torque")
            if torque is not None and stated is not None and not known:
                yield devices_codes.PLUGIN_PARAMETER_OBSOLETE.diagnostic(
                    message="Gazebo 11 ignores <torque>, so the wheel torque is "
                    f"{stated.default[0]:g} N m instead of {torque.text.strip()} N m",
                    values={"tag": "torque", "plugin": drive.tag.name},
                    origin=torque.origin,
                    instead=nodes.written("wheelTorque", {}, torque.text.strip()),
                    place="element",
                )
            if legacy is not None and legacy.text.strip().lower() in ("true", "1"):
                yield devices_codes.PLUGIN_PARAMETER_OBSOLETE.diagnostic(
                    message="Gazebo 11 ignores <legacyMode>, so the robot turns in the opposite "
                    "direction",
                    values={"tag": "legacyMode", "plugin": drive.tag.name},
                    origin=legacy.origin,
                    instead="<legacyMode>false</legacyMode>",
                    place="element",
                    hint="Swap the names of the two joints.",
                )


def _plain_file(name: str) -> str:
    """The file name of a Gazebo Classic ROS plugin without its path, as it must be written."""
    match = _CLASSIC.fullmatch(name)
    return name if match is None else f"lib{match[1]}.so"


def _advised(tag: PluginTag, diagnostic: Diagnostic) -> Diagnostic:
    """A diagnostic about a plugin's parameters, with the corrected tag if it is misspelt."""
    near = str(diagnostic.values.get("meant") or "")
    # A tag that already exists is not the intended one.
    written = bool(near) and tag.element.find(near) is not None
    if written:
        near = ""
    element = next((e for e in _all(tag.element) if e.origin is diagnostic.origin), None)
    instead, place = f"<{near}>" if near else "", False
    if near and element is not None and not element.children:
        instead = nodes.written(near, dict(element.attributes), element.text.strip())
        place = True
    return replace(
        diagnostic,
        # Gazebo's plugin may support a tag that ours ignores; a misspelt tag is an error.
        severity=diagnostic.severity if near or diagnostic.severity == "error" else "info",
        hint="" if near or written else diagnostic.hint,
        instead=instead,
        place="element" if place else "",
        mark=element.tag if element is not None and element is not tag.element else "",
    )


def _all(element: Element) -> Iterator[Element]:
    yield element
    for child in element.children:
        yield from _all(child)


RULES = (plugin_unknown, plugin_parameter, joint_missing, plugin_obsolete)
