"""Places and sizes of driven wheels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from cartwheel.checks.robot import Drive, Robot
from cartwheel.checks.subject import Subject
from cartwheel.description.model import Joint
from cartwheel.description.solids import Floats, Solid, bounds
from cartwheel.geometry import Pose, rotate

_DIRECTIONS = 32
CAMBER = 0.5
"""Minimum cosine between a wheel axis and the axle."""


def wheel_radius(robot: Robot, joint: Joint) -> float | None:
    """Half the width of a wheel's collision perpendicular to its axis, m; else of its visual.

    Links fixed to the wheel are included: the tyre and the hub may be separate links.
    """
    if joint.child not in robot.links:
        return None
    for kind in (robot.collisions, robot.visuals):
        widths = wheel_widths(robot, joint, kind)
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


def wheel_widths(robot: Robot, joint: Joint, kind: Mapping[str, list[Solid]]) -> Floats | None:
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
    return abs(along[1]) >= CAMBER


def axis_senses(robot: Robot, left: Joint, right: Joint) -> list[float]:
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


def drives_in(subject: Subject) -> Iterator[tuple[Robot, Drive]]:
    """The drives of all robots, each with its robot."""
    for robot in subject.robots:
        for drive in robot.drives:
            yield robot, drive


def wheel_pairs(subject: Subject) -> Iterator[tuple[Robot, Drive, Joint, Joint]]:
    """The first wheel pair of each drive, or every pair of a differential drive with several."""
    for robot, drive in drives_in(subject):
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
