"""Drive plugins: whether what they say of the wheels is what the joints and wheels say."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cartwheel.description.check import nodes, spelling
from cartwheel.description.check.finding import Remark
from cartwheel.description.check.rule import rule
from cartwheel.description.check.solids import Floats, bounds
from cartwheel.description.check.subject import DRIVE_JOINT_TAGS, Drive, Robot, Subject
from cartwheel.description.model import Element, Joint
from cartwheel.geometry import Pose, rotate

_DIRECTIONS = 32


@rule("drive-joint-unknown", "error", "a drive plugin names a joint that does not exist")
def drive_joint_unknown(subject: Subject) -> Iterator[Remark]:
    for robot, drive in _drives(subject):
        for element in drive.tag.element.children:
            name = element.text.strip()
            if element.tag not in DRIVE_JOINT_TAGS or name in robot.joints:
                continue
            near = spelling.meant(name, robot.joints)
            yield Remark(
                message=f'<{element.tag}> names "{name}", which is no joint: '
                "the plugin does not drive",
                origin=element.origin,
                instead=nodes.written(element.tag, dict(element.attributes), near) if near else "",
                place="element" if near else "",
                mark=name,
                hint="" if near else spelling.nearest(name, robot.joints),
            )


@rule("drive-joint-fixed", "warning", "a driven wheel's joint is not continuous")
def drive_joint_fixed(subject: Subject) -> Iterator[Remark]:
    for robot, drive in _drives(subject):
        for name in drive.joints:
            joint = robot.joints.get(name)
            if joint is None or joint.type == "continuous":
                continue
            axis = joint.axis
            if joint.type == "revolute" and axis.lower is None and axis.upper is None:
                continue
            node = robot.joint_node(name)
            limits = (
                f" and stops at {axis.lower:g} and {axis.upper:g} rad"
                if joint.type == "revolute" and axis.lower is not None and axis.upper is not None
                else ""
            )
            yield Remark(
                message=f'the joint "{name}" drives a wheel, but is of type {joint.type}{limits}',
                origin=joint.origin,
                instead='type="continuous"',
                place="attribute" if node is not None else "",
                mark=f'type="{joint.type}"',
            )


@rule("wheels-swapped", "warning", "a drive's left wheel stands on the right")
def wheels_swapped(subject: Subject) -> Iterator[Remark]:
    for robot, drive, left, right in _pairs(subject):
        poses = [wheel_place(robot, joint) for joint in (left, right)]
        element = _parameter(drive, ("leftJoint", "left_joint", "left_wheel_joint_name"))
        across = poses[0].y - poses[1].y
        # With the wheels beside each other x is forward, else nobody can tell the sides.
        if element is None or abs(poses[0].x - poses[1].x) > 0.1 * abs(across) or across >= 0:
            continue
        yield Remark(
            message=f'the left wheel\'s joint "{left.name}" is at y = {poses[0].y:.3g} m, right of '
            f'"{right.name}" at {poses[1].y:.3g} m: the robot turns the wrong way',
            origin=element.origin,
            instead=nodes.written(element.tag, {}, right.name),
            place="element",
            mark=left.name,
            hint="Swap the two names.",
        )


@rule("wheel-axes", "warning", "driven wheels turn backwards, or against each other")
def wheel_axes(subject: Subject) -> Iterator[Remark]:
    for robot, _, left, right in _pairs(subject):
        poses = [wheel_place(robot, joint) for joint in (left, right)]
        across = np.array(poses[0].position) - np.array(poses[1].position)
        wide = float(np.linalg.norm(across))
        if wide < 1e-6 or abs(across[2]) > 0.2 * wide:
            continue
        senses = [
            float(
                np.dot(
                    rotate(pose.orientation, joint.axis.xyz),
                    (across / wide) * (1 if across[1] >= 0 else -1),
                )
            )
            for joint, pose in zip((left, right), poses, strict=True)
        ]
        for joint, sense in zip((left, right), senses, strict=True):
            if sense > -0.5:
                continue
            node = nodes.child(robot.joint_node(joint.name), "axis")
            xyz = " ".join(nodes.short(-value + 0.0) for value in joint.axis.xyz)
            both = all(each < -0.5 for each in senses)
            yield Remark(
                message=f'the wheel of joint "{joint.name}" turns backwards when the drive wants '
                "to go forward: its axis points to the robot's right"
                + ("" if both else ", while the other's points to its left"),
                origin=node.origin if node is not None else joint.origin,
                instead=f'xyz="{xyz}"' if node is not None else "",
                place="attribute" if node is not None else "",
                mark="xyz",
            )


def wheel_radius(robot: Robot, joint: Joint) -> float | None:
    """Half the width of a wheel's collision, or else its visual, across its axis, m.

    What is fixed to the wheel is part of it: a tyre may be another link than the hub.
    """
    link = robot.links.get(joint.child)
    if link is None:
        return None
    here = (link.pose @ joint.pose).inverse()
    axis = np.array(joint.axis.xyz)
    for kind in (robot.collisions, robot.visuals):
        clouds = [
            solid.placed(here @ robot.links[name].pose)
            for name in wheel_links(robot, joint)
            for solid in kind[name]
        ]
        if clouds:
            points = np.concatenate(clouds)
            # Half its width, not its reach: a wheel may be a millimetre off its axis.
            sideways = _across(axis)
            return float(np.ptp(points @ sideways.T, axis=0).max()) / 2
    return None


def _across(axis: Floats) -> Floats:
    """Directions all around an axis, shape (n, 3)."""
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    angles = np.linspace(0.0, np.pi, _DIRECTIONS, endpoint=False)[:, None]
    return np.asarray(np.cos(angles) * first + np.sin(angles) * np.cross(axis, first))


def wheel_links(robot: Robot, joint: Joint) -> list[str]:
    """The link that a joint turns, and those fixed to it."""
    root = robot.rigid_root(joint.child)
    return robot.rigid_groups[root] if root == joint.child else [joint.child]


def wheel_joints(robot: Robot) -> list[Joint]:
    """The joints of the wheels that drive plugins drive."""
    names = dict.fromkeys(name for drive in robot.drives for name in drive.joints)
    found = [robot.joints[name] for name in names if name in robot.joints]
    return [joint for joint in found if joint.child in robot.links]


def lowest(robot: Robot, *links: str) -> float | None:
    """The height of the lowest point of links' collisions in the model's frame, m."""
    box = bounds(
        [solid.placed(robot.links[link].pose) for link in links for solid in robot.collisions[link]]
    )
    return None if box is None else float(box[0][2])


def wheel_place(robot: Robot, joint: Joint) -> Pose:
    """Where a wheel's joint is in the model's frame: a link of SDF may have its frame elsewhere."""
    return robot.links[joint.child].pose @ joint.pose


def _parameter(drive: Drive, names: tuple[str, ...]) -> Element | None:
    return next((found for name in names if (found := drive.tag.element.find(name))), None)


def _drives(subject: Subject) -> Iterator[tuple[Robot, Drive]]:
    for robot in subject.robots:
        for drive in robot.drives:
            yield robot, drive


def _pairs(subject: Subject) -> Iterator[tuple[Robot, Drive, Joint, Joint]]:
    """Drives with two wheels; a skid's effective separation is a matter of its tyres."""
    for robot, drive in _drives(subject):
        if "skid" in drive.tag.filename or len(drive.left) != len(drive.right):
            continue
        for names in zip(drive.left, drive.right, strict=True):
            left, right = (robot.joints.get(name) for name in names)
            if (
                left is None
                or right is None
                or left is right
                or left.child not in robot.links
                or right.child not in robot.links
            ):
                continue
            yield robot, drive, left, right
            if len(drive.left) > 1:
                break


RULES = (
    drive_joint_unknown,
    drive_joint_fixed,
    wheels_swapped,
    wheel_axes,
)
