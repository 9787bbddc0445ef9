"""The links that joints connect."""

from __future__ import annotations

from collections.abc import Iterator

from cartwheel.checks import nodes, spelling
from cartwheel.checks.kinematic_tree import elements_of, link_names
from cartwheel.checks.rule import rule
from cartwheel.checks.subject import Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.errors import Diagnostic

WORLD = "world"


@rule(robot_codes.JOINT_LINK_UNKNOWN)
def joint_link_unknown(subject: Subject) -> Iterator[Diagnostic]:
    known = link_names(subject)
    for joint in elements_of(subject, "joint"):
        name = nodes.name_of(joint)
        for which in ("parent", "child"):
            end = nodes.child(joint, which)
            if end is None:
                yield robot_codes.JOINT_LINK_UNKNOWN.diagnostic(
                    message=f'joint "{name}" has no <{which}>',
                    values={"joint": name, "tag": which},
                    origin=joint.origin,
                    hint=f'Add <{which} link="…"/> to the joint.',
                )
                continue
            link = nodes.text_of(end, "link")
            if link in known:
                continue
            if link == WORLD and which == "parent":
                yield robot_codes.JOINT_LINK_UNKNOWN.diagnostic(
                    message=f'the parent of joint "{name}" is "world", but the robot has no '
                    "such link",
                    values={"joint": name, "link": link, "tag": which},
                    origin=end.origin,
                    instead='<link name="world"/>',
                    mark=link,
                    hint="Add this link to fix the robot to the world.",
                )
                continue
            yield spelling.misspelt(
                robot_codes.JOINT_LINK_UNKNOWN,
                link,
                known,
                attribute="link",
                message=f'the {which} of joint "{name}" is "{link}", which is not a link',
                values={"link": link, "joint": name, "tag": which},
                origin=end.origin,
                mark=f'link="{end.attributes.get("link", "")}"',
            )
