"""The effort with which joints accelerate what they move."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cartwheel.description.model import Joint, Link, RobotDescription
from cartwheel.geometry import matrix_from_quat, rotate

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
        description: The robot. Joints that a loop closes are ignored.

    Returns:
        Efforts by the name of the joint; empty for robots with more than 200 movable joints.
    """
    joints = [each for each in description.joints if _rate(each)]
    if len(joints) > _MOST:
        return {}
    index = {joint.name: number for number, joint in enumerate(joints)}
    links = {link.name: link for link in description.links}
    inbound: dict[str, Joint] = {}
    for joint in description.joints:
        inbound.setdefault(joint.child, joint)
    mass = np.zeros((len(joints), len(joints)))
    for link in description.links:
        moving = [each for each in _above(link, inbound, links) if each.name in index]
        if link.inertial is not None and moving:
            rows = [index[each.name] for each in moving]
            mass[np.ix_(rows, rows)] += _mass_of(
                link, [(each, links[each.child]) for each in moving]
            )
    rates = np.array([_rate(each) for each in joints])
    return dict(zip(index, (np.abs(mass) @ rates).tolist(), strict=True))


def _rate(joint: Joint) -> float:
    """The acceleration of a joint; 0 for one that does not move along or about one axis."""
    if joint.type in ("revolute", "continuous"):
        return _TURNING
    return _SLIDING if joint.type == "prismatic" else 0.0


def _above(link: Link, inbound: dict[str, Joint], links: dict[str, Link]) -> Iterator[Joint]:
    """The joints from a link to the root."""
    seen = set[str]()
    name = link.name
    while name in inbound and name in links and name not in seen:
        seen.add(name)
        yield inbound[name]
        name = inbound[name].parent


def _mass_of(link: Link, joints: list[tuple[Joint, Link]]) -> Array:
    """A link's part of the mass matrix of the joints that move it, shape (n, n)."""
    inertial = link.inertial
    assert inertial is not None
    pose = link.pose @ inertial.pose
    centre = np.array(pose.position)
    turn = matrix_from_quat(pose.orientation)
    xy, xz, yz = inertial.products
    tensor = np.diag(inertial.diagonal) + np.array([[0, xy, xz], [xy, 0, yz], [xz, yz, 0]])
    tensor = turn @ tensor @ turn.T
    linear, angular = np.zeros((len(joints), 3)), np.zeros((len(joints), 3))
    for number, (joint, child) in enumerate(joints):
        frame = child.pose @ joint.pose
        axis = np.array(rotate(frame.orientation, joint.axis.xyz))
        axis = axis / (np.linalg.norm(axis) or 1.0)
        if joint.type == "prismatic":
            linear[number] = axis
        else:
            linear[number] = np.cross(axis, centre - np.array(frame.position))
            angular[number] = axis
    matrix: Array = inertial.mass * linear @ linear.T + angular @ tensor @ angular.T
    return matrix
