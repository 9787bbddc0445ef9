"""Computes link poses from joint positions, and what follows from them, without physics."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from cartwheel.description.model import Joint, RobotDescription
from cartwheel.geometry import Array, Pose, quat_from_axis_angle


def joint_positions(
    description: RobotDescription, positions: Mapping[str, float]
) -> dict[str, float]:
    """The position of every joint: the given positions, mimic joints, and 0 for the rest.

    Args:
        description: The robot.
        positions: In rad or m, by joint name; positions of mimic joints are overridden.
    """
    joints = {joint.name: joint for joint in description.joints}
    return {name: _position(joint, joints, positions) for name, joint in joints.items()}


def carried(joints: Iterable[Joint], links: Iterable[str]) -> set[str]:
    """Names of some links, and of all links that they carry through some joints."""
    below: dict[str, list[str]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint.child)
    found = set(links)
    waiting = list(found)
    while waiting:
        more = set(below.get(waiting.pop(), ())) - found
        found |= more
        waiting += more
    return found


def held_parts(joints: Sequence[Joint]) -> dict[str, list[str]]:
    """The links that fixed joints hold in the world, each with those that Gazebo merges into it.

    Args:
        joints: The joints of a URDF.
    """
    fixed = [each for each in joints if each.type == "fixed"]
    below: dict[str, list[str]] = {}
    for joint in fixed:
        if not joint.preserve_fixed:
            below.setdefault(joint.parent, []).append(joint.child)
    found = {joint.child: [joint.child] for joint in fixed if joint.parent == "world"}
    seen = set(found)
    for part in found.values():
        for name in part:
            more = [each for each in below.get(name, ()) if each not in seen]
            seen.update(more)
            part.extend(more)
    return found


def link_poses(description: RobotDescription, positions: Mapping[str, float]) -> dict[str, Pose]:
    """The pose of every link in the model's frame.

    Floating, planar and ball joints stay at zero, because they have more than one coordinate.

    Args:
        description: The robot.
        positions: In rad or m, by joint name; 0 if missing.
    """
    angles = joint_positions(description, positions)
    rest = {link.name: link.pose for link in description.links}
    # In a loop, a link has two joints; the first one is used in the tree, as everywhere else.
    inbound: dict[str, Joint] = {}
    for joint in description.joints:
        inbound.setdefault(joint.child, joint)
    poses: dict[str, Pose] = {}
    for name in rest:
        _place(name, rest, inbound, angles, poses)
    return poses


def center_of_mass(description: RobotDescription, poses: Mapping[str, Pose]) -> Array | None:
    """The robot's centre of mass in the frame of the poses, m, shape (3,); None without masses.

    Args:
        description: The robot.
        poses: Poses of its links, by name.
    """
    weighted, total = np.zeros(3), 0.0
    for link in description.links:
        if link.inertial is None or not link.inertial.mass:
            continue
        place = poses[link.name] @ link.inertial.pose
        weighted += link.inertial.mass * np.array(place.position)
        total += link.inertial.mass
    return weighted / total if total > 0 else None


def _place(
    name: str,
    rest: Mapping[str, Pose],
    inbound: Mapping[str, Joint],
    angles: Mapping[str, float],
    poses: dict[str, Pose],
) -> None:
    # Iterative, because a long chain would exceed Python's recursion limit.
    chain = [name]
    while chain[-1] not in poses and chain[-1] in inbound:
        parent = inbound[chain[-1]].parent
        if parent not in rest or parent in chain:
            break
        chain.append(parent)
    for link in reversed(chain):
        if link in poses:
            continue
        joint = inbound.get(link)
        if joint is None:
            poses[link] = rest[link]
            continue
        parent_rest = rest.get(joint.parent, Pose())
        frame = poses.get(joint.parent, parent_rest) @ parent_rest.inverse() @ rest[link]
        poses[link] = frame @ joint.pose @ _motion(joint, angles[joint.name]) @ joint.pose.inverse()


class JointPose:
    """The pose of a joint's child link in its parent link, without the poses of other links.

    Args:
        description: The robot.
        joint: One of its joints.
    """

    def __init__(self, description: RobotDescription, joint: Joint) -> None:
        rest = {link.name: link.pose for link in description.links}
        self.joint = joint
        self._before = rest.get(joint.parent, Pose()).inverse() @ rest[joint.child] @ joint.pose
        self._after = joint.pose.inverse()

    def at(self, position: float) -> Pose:
        """The pose at a position of the joint, rad or m."""
        position = position if math.isfinite(position) else 0.0
        return self._before @ _motion(self.joint, position) @ self._after


def _motion(joint: Joint, position: float) -> Pose:
    axis = joint.axis.xyz
    if position == 0.0:
        return Pose()
    if joint.type in ("revolute", "continuous", "universal"):
        return Pose(orientation=quat_from_axis_angle(axis, position))
    if joint.type == "prismatic":
        return Pose((axis[0] * position, axis[1] * position, axis[2] * position))
    if joint.type == "screw":
        # SDF's pitch is radians per metre; a joint without one only turns.
        travel = position / joint.thread_pitch if joint.thread_pitch else 0.0
        return Pose(
            (axis[0] * travel, axis[1] * travel, axis[2] * travel),
            quat_from_axis_angle(axis, position),
        )
    return Pose()


def _position(joint: Joint, joints: Mapping[str, Joint], positions: Mapping[str, float]) -> float:
    scale, offset = 1.0, 0.0
    seen: set[str] = set()
    while joint.mimic is not None and joint.mimic.joint in joints and joint.name not in seen:
        seen.add(joint.name)
        offset += scale * joint.mimic.offset
        scale *= joint.mimic.multiplier
        joint = joints[joint.mimic.joint]
    value = scale * positions.get(joint.name, 0.0) + offset
    return value if math.isfinite(value) else 0.0


def fixed_chain(description: RobotDescription, link: str) -> list[Joint]:
    """The chain of fixed joints from the root down to a link.

    Empty if the link is the root, or if a joint between them can move.
    """
    inbound: dict[str, Joint] = {}
    for joint in description.joints:
        inbound.setdefault(joint.child, joint)
    chain: list[Joint] = []
    while link in inbound:
        joint = inbound[link]
        if joint.type != "fixed" or joint in chain:
            return []
        chain.insert(0, joint)
        link = joint.parent
    return chain
