"""Links and joints that Gazebo removes when it merges links across fixed joints."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from cartwheel.checks import plugin_tags
from cartwheel.checks.robot import Robot
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import devices as devices_codes
from cartwheel.description.model import Element
from cartwheel.errors import Diagnostic


@rule(devices_codes.LUMPED_JOINT)
def lumped_joint(subject: Subject) -> Iterator[Diagnostic]:
    for robot, element in _named(subject, plugin_tags.joints_in):
        joint = robot.joints.get(element.text.strip())
        if joint is None or joint.type != "fixed" or joint.preserve_fixed or not subject.is_urdf:
            continue
        if joint.parent not in robot.links:
            continue
        yield devices_codes.LUMPED_JOINT.diagnostic(
            message=f'<{element.tag}> refers to the fixed joint "{joint.name}", which Gazebo '
            "removes when it merges links",
            values={"tag": element.tag, "joint": joint.name},
            origin=element.origin,
            instead=f'<gazebo reference="{joint.name}"><preserveFixedJoint>true'
            "</preserveFixedJoint></gazebo>",
            mark=joint.name,
            hint="Add this element to the robot to keep the joint.",
        )


@rule(devices_codes.LUMPED_LINK)
def lumped_link(subject: Subject) -> Iterator[Diagnostic]:
    if not subject.is_urdf:
        return
    for robot, element in _named(subject, plugin_tags.links_in):
        name = element.text.strip().lstrip("/")
        root = robot.merged_root(name) if name in robot.links else name
        holder = robot.inbound.get(name)
        if root == name or holder is None:
            continue
        keep = (
            f'<gazebo reference="{holder.name}"><preserveFixedJoint>true'
            "</preserveFixedJoint></gazebo>"
        )
        if element.tag in ("body_name", "link_name"):
            yield devices_codes.LUMPED_LINK.diagnostic(
                severity="warning",
                message=f'Gazebo merges link "{name}" into "{root}", so a plugin with '
                f"<{element.tag}> does not find the link",
                values={"tag": element.tag, "link": name, "root": root},
                origin=element.origin,
                instead=keep,
                mark=name,
                hint="Add this element to the robot to keep the link. Gazebo replaces the name "
                "only in <bodyName>.",
            )
        elif not _same_frame(robot, name, root):
            yield devices_codes.LUMPED_LINK.diagnostic(
                message=f'Gazebo merges link "{name}" into "{root}", so the messages use the frame '
                f'of "{root}"',
                values={"tag": element.tag, "link": name, "root": root},
                origin=element.origin,
                instead=keep,
                mark=name,
                hint="Add this element to the robot to keep the link.",
            )


def _named(
    subject: Subject, tags_in: Callable[[str], frozenset[str]]
) -> Iterator[tuple[Robot, Element]]:
    for robot in subject.robots:
        for tag, _ in robot.plugins():
            tags = tags_in(tag.filename)
            for element in tag.element.children:
                if element.tag in tags and element.text.strip():
                    yield robot, element


def _same_frame(robot: Robot, a: str, b: str) -> bool:
    between = robot.links[a].pose.inverse() @ robot.links[b].pose
    return max(map(abs, (*between.position, *between.orientation[:3]))) < 1e-6
