"""Drive plugins: whether their wheel parameters match the joints and wheels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from cartwheel.checks import nodes, spelling
from cartwheel.checks.rule import rule
from cartwheel.checks.rules.control import is_known
from cartwheel.checks.subject import DRIVE_JOINT_TAGS, Drive, Robot, Subject
from cartwheel.codes import robot as robot_codes
from cartwheel.description.model import Cylinder, Joint
from cartwheel.description.solids import Floats, Solid, bounds
from cartwheel.errors import Diagnostic
from cartwheel.geometry import Pose, matrix_from_quat, rotate

_DIRECTIONS = 32
_CAMBER = 0.5
"""Minimum cosine between a wheel axis and the axle."""
_ROUND = 0.7
"""Minimum ratio of a wheel's smallest to largest width."""
_UPRIGHT = {"x": 'rpy="0 1.5708 0"', "y": 'rpy="1.5708 0 0"', "z": 'rpy="0 0 0"'}
"""Rotation that aligns a cylinder with the joint axis, by joint axis."""


@rule(robot_codes.DRIVE_JOINT_UNKNOWN)
def drive_joint_unknown(subject: Subject) -> Iterator[Diagnostic]:
    for robot, drive in _drives(subject):
        for element in drive.tag.element.children:
            name = element.text.strip()
            if element.tag not in DRIVE_JOINT_TAGS or is_known(name, robot, subject):
                continue
            near = spelling.meant(name, robot.joint_names)
            yield robot_codes.DRIVE_JOINT_UNKNOWN.diagnostic(
                message=f'<{element.tag}> refers to the joint "{name}", which does not exist',
                values={"tag": element.tag, "joint": name},
                origin=element.origin,
                instead=nodes.written(element.tag, dict(element.attributes), near) if near else "",
                place="element" if near else "",
                mark=name,
                hint="" if near else spelling.nearest(name, robot.joint_names),
            )


@rule(robot_codes.DRIVE_JOINT_NOT_CONTINUOUS)
def drive_joint_fixed(subject: Subject) -> Iterator[Diagnostic]:
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
                f" with limits of {axis.lower:g} and {axis.upper:g} rad"
                if joint.type == "revolute" and axis.lower is not None and axis.upper is not None
                else ""
            )
            yield robot_codes.DRIVE_JOINT_NOT_CONTINUOUS.diagnostic(
                message=f'the driven wheel joint "{name}" has the type {joint.type}{limits}',
                values={"joint": name, "type": joint.type},
                origin=joint.origin,
                instead='type="continuous"',
                place="attribute" if node is not None else "",
                mark=f'type="{joint.type}"',
            )


@rule(robot_codes.WHEELS_SWAPPED)
def wheels_swapped(subject: Subject) -> Iterator[Diagnostic]:
    for robot, drive, left, right in _pairs(subject):
        poses = [wheel_place(robot, joint) for joint in (left, right)]
        element = drive.left_tag
        across = poses[0].y - poses[1].y
        # Left and right are known only if the wheels are beside each other, with x forward.
        if element is None or abs(poses[0].x - poses[1].x) > 0.1 * abs(across) or across >= 0:
            continue
        if all(sense < -_CAMBER for sense in _senses(robot, left, right)):
            continue  # the robot faces backwards, but is otherwise correct
        yield robot_codes.WHEELS_SWAPPED.diagnostic(
            message=f'the left wheel joint "{left.name}" is at y = {poses[0].y:.3g} m, to the '
            f'right of "{right.name}" at y = {poses[1].y:.3g} m',
            values={"left": left.name, "right": right.name},
            origin=element.origin,
            instead=nodes.written(element.tag, {}, right.name),
            place="element",
            mark=left.name,
            hint="Swap the two names. Otherwise, the robot turns in the wrong direction.",
        )


@rule(robot_codes.WHEEL_AXIS_MISALIGNED)
def wheel_axes(subject: Subject) -> Iterator[Diagnostic]:
    for robot, _, left, right in _pairs(subject):
        poses = [wheel_place(robot, joint) for joint in (left, right)]
        senses = _senses(robot, left, right)
        if not senses or (poses[0].y < poses[1].y and all(each < -_CAMBER for each in senses)):
            continue
        across = np.array(poses[0].position) - np.array(poses[1].position)
        wide = float(np.linalg.norm(across))
        for joint, pose, sense in zip((left, right), poses, senses, strict=True):
            if sense > -_CAMBER:
                axis = nodes.child(robot.joint_node(joint.name), "axis")
                stated = nodes.numbers(nodes.text_of(axis, "xyz"), 3)
                turns = joint.type != "fixed" and (stated is None or any(stated))
                if sense < _CAMBER and turns:
                    yield _not_across(robot, joint, pose, across / wide)
                continue
            node = nodes.child(robot.joint_node(joint.name), "axis")
            xyz = " ".join(nodes.short(-value + 0.0) for value in joint.axis.xyz)
            both = all(each < -_CAMBER for each in senses)
            yield robot_codes.WHEEL_AXIS_MISALIGNED.diagnostic(
                message=f'the wheel of joint "{joint.name}" turns backwards because its axis '
                "points to the right of the "
                "robot" + ("" if both else " and the other wheel's axis to the left"),
                values={"joint": joint.name, "attribute": "backwards"},
                origin=node.origin if node is not None else joint.origin,
                instead=f'xyz="{xyz}"' if node is not None else "",
                place="attribute" if node is not None else "",
                mark="xyz",
            )


def _senses(robot: Robot, left: Joint, right: Joint) -> list[float]:
    """Component of each wheel's axis toward the robot's left along the axle, from -1 to 1.

    Empty if the sides cannot be determined.
    """
    poses = [wheel_place(robot, joint) for joint in (left, right)]
    across = np.array(poses[0].position) - np.array(poses[1].position)
    wide = float(np.linalg.norm(across))
    if wide < 1e-6 or abs(across[2]) > 0.2 * wide:
        return []
    unit = across / wide * (1 if across[1] >= 0 else -1)
    return [
        float(np.dot(rotate(pose.orientation, joint.axis.xyz), unit))
        for joint, pose in zip((left, right), poses, strict=True)
    ]


def _not_across(robot: Robot, joint: Joint, pose: Pose, across: Floats) -> Diagnostic:
    """The diagnostic for a wheel whose axis is not parallel to the axle; the default axis is x."""
    written = robot.joint_node(joint.name)
    node = nodes.child(written, "axis")
    left = across if across[1] >= 0 else -across
    own = matrix_from_quat(pose.orientation).T @ left
    xyz = " ".join(nodes.short(round(float(value), 3) + 0.0) for value in own)
    stated = "" if node is not None or written is None else " (the default)"
    text = f'xyz="{xyz}"'
    return robot_codes.WHEEL_AXIS_MISALIGNED.diagnostic(
        message=f'the wheel of joint "{joint.name}" cannot roll forward because the axis '
        f'"{" ".join(nodes.short(value) for value in joint.axis.xyz)}"{stated} is not '
        "parallel to the axle",
        values={"joint": joint.name, "axis": joint.axis.xyz, "attribute": "askew"},
        origin=node.origin if node is not None else joint.origin,
        instead="" if written is None else text if node is not None else f"<axis {text}/>",
        place="" if written is None else "attribute" if node is not None else "inside",
        mark="xyz" if node is not None else f'name="{joint.name}"',
    )


@rule(robot_codes.WHEEL_NOT_ROUND)
def wheel_not_round(subject: Subject) -> Iterator[Diagnostic]:
    for robot in subject.robots:
        for joint in wheel_joints(robot):
            link = robot.links[joint.child]
            widths = _widths(robot, joint, robot.collisions)
            # Misaligned axes are reported by another rule.
            if widths is None or not is_across(robot, joint) or not robot.whole(link.name):
                continue
            if widths.min() >= _ROUND * widths.max():
                continue
            collision, text = link.collisions[0] if link.collisions else None, ""
            node = robot.node_at(collision.origin) if collision is not None else None
            origin = nodes.child(node, "origin")
            if collision is not None and isinstance(collision.shape, Cylinder):
                text = _UPRIGHT.get(
                    max("xyz", key=lambda a: abs(joint.axis.xyz["xyz".index(a)])), ""
                )
            alone = node is not None and bool(text) and len(link.collisions) == 1
            yield robot_codes.WHEEL_NOT_ROUND.diagnostic(
                message=f'the collision of the driven wheel "{link.name}" is not round: its width '
                f"perpendicular to the joint axis varies from {widths.min():.3g} m to "
                f"{widths.max():.3g} m",
                values={
                    "link": link.name,
                    "widest": float(widths.max()),
                    "narrowest": float(widths.min()),
                },
                origin=origin.origin
                if origin is not None
                else (collision.origin if collision is not None else link.origin),
                instead="" if not alone else text if origin is not None else f"<origin {text}/>",
                place="" if not alone else "attribute" if origin is not None else "inside",
                mark="rpy" if origin is not None else "",
                hint="A cylinder's axis is z. Rotate the collision to align z with the joint axis."
                if text
                else "",
            )


def wheel_radius(robot: Robot, joint: Joint) -> float | None:
    """Half the width of a wheel's collision perpendicular to its axis, m; else of its visual.

    Links fixed to the wheel are included: the tyre and the hub may be separate links.
    """
    if joint.child not in robot.links:
        return None
    for kind in (robot.collisions, robot.visuals):
        widths = _widths(robot, joint, kind)
        if widths is not None:
            return float(widths.max()) / 2
    return None


def wheel_middle(robot: Robot, joint: Joint) -> tuple[float, float, float]:
    """Centre of a wheel's width in the model frame, m, which may be offset from the joint."""
    place, axis = wheel_place(robot, joint), np.array(joint.axis.xyz)
    for kind in (robot.collisions, robot.visuals):
        cloud = _cloud(robot, joint, kind)
        if cloud is not None:
            along = cloud @ axis
            x, y, z = (axis * (along.min() + along.max()) / 2 / (axis @ axis or 1.0)).tolist()
            return (place @ Pose((x, y, z))).position
    return place.position


def _widths(robot: Robot, joint: Joint, kind: Mapping[str, list[Solid]]) -> Floats | None:
    """Widths of a wheel in directions around its axis, m; None without geometry of this kind."""
    cloud = _cloud(robot, joint, kind)
    if cloud is None:
        return None
    # Half the width, not the radius: the wheel may be a millimetre off its axis.
    sideways = _across(np.array(joint.axis.xyz))
    return np.asarray(np.ptp(cloud @ sideways.T, axis=0))


def _cloud(robot: Robot, joint: Joint, kind: Mapping[str, list[Solid]]) -> Floats | None:
    """Wheel vertices in the joint frame, shape (n, 3), m; None without geometry of this kind."""
    here = wheel_place(robot, joint).inverse()
    clouds = [
        solid.placed(here @ robot.links[name].pose)
        for name in wheel_links(robot, joint)
        for solid in kind[name]
    ]
    return np.concatenate(clouds) if clouds else None


def _across(axis: Floats) -> Floats:
    """Unit vectors perpendicular to an axis, shape (n, 3)."""
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    angles = np.linspace(0.0, np.pi, _DIRECTIONS, endpoint=False)[:, None]
    return np.asarray(np.cos(angles) * first + np.sin(angles) * np.cross(axis, first))


def is_across(robot: Robot, joint: Joint) -> bool:
    """Whether a wheel's axis points sideways."""
    along = rotate(wheel_place(robot, joint).orientation, joint.axis.xyz)
    return abs(along[1]) >= _CAMBER


def wheel_links(robot: Robot, joint: Joint) -> list[str]:
    """The joint's child link and all links fixed to it."""
    root = robot.rigid_root(joint.child)
    return robot.rigid_groups[root] if root == joint.child else [joint.child]


def wheel_joints(robot: Robot) -> list[Joint]:
    """The wheel joints of all drive plugins."""
    names = dict.fromkeys(name for drive in robot.drives for name in drive.joints)
    found = [robot.joints[name] for name in names if name in robot.joints]
    return [joint for joint in found if joint.child in robot.links]


def lowest(robot: Robot, *links: str) -> float | None:
    """Lowest point of the collisions of some links in the model frame, m."""
    box = bounds(
        [solid.placed(robot.links[link].pose) for link in links for solid in robot.collisions[link]]
    )
    return None if box is None else float(box[0][2])


def wheel_place(robot: Robot, joint: Joint) -> Pose:
    """Pose of a wheel joint in the model frame; in SDF, the child link's frame may be elsewhere."""
    return robot.links[joint.child].pose @ joint.pose


def _drives(subject: Subject) -> Iterator[tuple[Robot, Drive]]:
    for robot in subject.robots:
        for drive in robot.drives:
            yield robot, drive


def _pairs(subject: Subject) -> Iterator[tuple[Robot, Drive, Joint, Joint]]:
    """The first wheel pair of each drive, or every pair of a differential drive with several."""
    for robot, drive in _drives(subject):
        if len(drive.left) != len(drive.right):
            continue
        for names in zip(drive.left, drive.right, strict=True):
            left, right = (robot.joints.get(name) for name in names)
            ends = {left.child, right.child} if left is not None and right is not None else set()
            if left is None or right is None or left is right or not ends <= robot.placed:
                continue
            yield robot, drive, left, right
            if len(drive.left) > 1:
                break


RULES = (
    drive_joint_unknown,
    drive_joint_fixed,
    wheels_swapped,
    wheel_axes,
    wheel_not_round,
)
