"""The effort with which joints accelerate what they move."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from cartwheel.description.model import Inertial, Joint, Link, RobotDescription
from cartwheel.geometry import cross, matrix_from_quat, rotate

Array = NDArray[np.float64]

_TURNING, _SLIDING = 1.0, 0.1
"""Acceleration of hinges and slides, rad/s² and m/s²."""
_MOST = 200
"""Maximum number of movable joints; the mass matrix of more would take too long."""


def inertial_efforts(description: RobotDescription) -> dict[str, float]:
    """Returns the effort of each movable joint if all of them accelerate at once, N m or N.

    Hinges accelerate at 1 rad/s² and slides at 0.1 m/s², in the directions in which their inertias
    add up. The joints are at 0, where most arms are extended, and the root does not move.

    Args:
        description: The robot. Joints that close a loop are ignored.

    Returns:
        Efforts by the name of the joint; empty for robots with more than 200 movable joints.
    """
    links = {link.name: link for link in description.links}
    inbound: dict[str, Joint] = {}
    for joint in description.joints:
        inbound.setdefault(joint.child, joint)
    joints = [each for each in inbound.values() if _rate(each) and each.child in links]
    if len(joints) > _MOST:
        return {}
    number = {joint.child: index for index, joint in enumerate(joints)}
    above = _above(links, inbound, number)
    # Of links that are fixed to each other, only the sum counts.
    inertias: dict[int, tuple[list[int], Array]] = {}
    for link in description.links:
        rows = above[link.name]
        if link.inertial is not None and rows:
            _, total = inertias.setdefault(rows[-1], (rows, np.zeros((6, 6))))
            total += _inertia(link, link.inertial)
    twists = _twists(joints, links)
    mass = np.zeros((len(joints), len(joints)))
    for rows, inertia in inertias.values():
        mass[np.ix_(rows, rows)] += twists[rows] @ inertia @ twists[rows].T
    rates = np.array([_rate(each) for each in joints])
    efforts = (np.abs(mass) @ rates).tolist()
    return {joint.name: effort for joint, effort in zip(joints, efforts, strict=True)}


def _rate(joint: Joint) -> float:
    """The acceleration of a joint; 0 for one that does not move along or about one axis."""
    if joint.type in ("revolute", "continuous"):
        return _TURNING
    return _SLIDING if joint.type == "prismatic" else 0.0


def _above(
    links: Mapping[str, Link], inbound: Mapping[str, Joint], number: Mapping[str, int]
) -> dict[str, list[int]]:
    """The numbers of the joints from each link to the root, by link."""
    found: dict[str, list[int]] = {}
    for start in links:
        way, name = dict[str, None](), start
        while name in links and name not in found and name not in way:
            way[name] = None
            name = inbound[name].parent if name in inbound else ""
        rows = found.get(name, [])
        for each in reversed(way):
            rows = [*rows, number[each]] if each in number else rows
            found[each] = rows
    return found


def _twists(joints: Sequence[Joint], links: Mapping[str, Link]) -> Array:
    """The motion of a body at the origin that each joint moves with a rate of 1.

    Returns:
        Angular and linear velocities, rad/s and m/s, shape (n, 6).
    """
    twists = np.zeros((len(joints), 6))
    for twist, joint in zip(twists, joints, strict=True):
        frame = links[joint.child].pose @ joint.pose
        axis = np.array(rotate(frame.orientation, joint.axis.xyz))
        axis = axis / (np.linalg.norm(axis) or 1.0)
        if joint.type == "prismatic":
            twist[3:] = axis
        else:
            twist[:3], twist[3:] = axis, cross(frame.position, axis)
    return twists


def _inertia(link: Link, inertial: Inertial) -> Array:
    """The spatial inertia of a link for motions of `_twists`, shape (6, 6)."""
    pose = link.pose @ inertial.pose
    turn = matrix_from_quat(pose.orientation)
    xy, xz, yz = inertial.products
    tensor = np.diag(inertial.diagonal) + np.array([[0, xy, xz], [xy, 0, yz], [xz, yz, 0]])
    x, y, z = pose.position
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    moment = inertial.mass * across
    return np.block(
        [
            [turn @ tensor @ turn.T - moment @ across, moment],
            [-moment, inertial.mass * np.eye(3)],
        ]
    )
