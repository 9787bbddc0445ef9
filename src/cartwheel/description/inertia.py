"""Checks whether a stated inertia is physically possible."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

import numpy as np

from cartwheel.description.model import Inertial
from cartwheel.geometry import Array, Pose, Vec3, matrix_from_quat

TOLERANCE = 1e-3
"""Relative tolerance: files contain three or four digits, and thin plates are exactly at the limit.
"""
REFUSES = "gz-sim does not load such a robot"
TOLERANCE_OF_GZ = 1e-5
"""The same for gz-sim, which accepts only rounding errors. URDFs are converted with six digits."""
LIGHTEST = 1e-12
"""Minimum mass of a link with an inertia, kg; the engine rejects smaller masses, and Gazebo ignores
links in a URDF with less than 1e-6 kg."""
HEAVIEST = 1e12
"""Maximum mass of a link, kg; the square of a larger mass overflows."""
_THINNEST = 1e-6
"""Relative moment of a rod about its own axis, which is often stated as 0."""


def tensor(diagonal: Vec3, products: Vec3) -> Array:
    """The inertia matrix, shape (3, 3).

    Args:
        diagonal: ixx, iyy, izz.
        products: ixy, ixz, iyz.
    """
    ixx, iyy, izz = diagonal
    ixy, ixz, iyz = products
    return np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])


def principal_moments(diagonal: Vec3, products: Vec3) -> Vec3:
    """The eigenvalues of an inertia matrix in kg m², the smallest first.

    Args:
        diagonal: ixx, iyy, izz.
        products: ixy, ixz, iyz.
    """
    ixx, iyy, izz = diagonal
    ixy, ixz, iyz = products
    # The closed form for a symmetric 3x3 matrix: numpy's solver would be the slowest part of
    # reading.
    off = ixy * ixy + ixz * ixz + iyz * iyz
    if off == 0.0:
        a, b, c = sorted((ixx, iyy, izz))
        return (a, b, c)
    mean = (ixx + iyy + izz) / 3
    # Multiplication, because a float power raises an error on overflow.
    spread = sum((each - mean) * (each - mean) for each in (ixx, iyy, izz)) + 2 * off
    p = math.sqrt(spread / 6)
    if p == 0.0 or not math.isfinite(p):
        a, b, c = sorted((ixx, iyy, izz))
        return (a, b, c)
    xx, yy, zz = (ixx - mean) / p, (iyy - mean) / p, (izz - mean) / p
    xy, xz, yz = ixy / p, ixz / p, iyz / p
    half = (xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)) / 2
    angle = math.acos(max(-1.0, min(1.0, half))) / 3
    largest = mean + 2 * p * math.cos(angle)
    smallest = mean + 2 * p * math.cos(angle + 2 * math.pi / 3)
    return (smallest, 3 * mean - largest - smallest, largest)


def is_refused(moments: Vec3) -> bool:
    """Whether gz-sim does not load a model with a link with these principal moments.

    As `gz::math::MassMatrix3::IsValid`: moments of 0 are accepted.
    """
    a, b, c = moments
    return a < -TOLERANCE_OF_GZ * abs(c) or a + b < c * (1 - TOLERANCE_OF_GZ)


def combined(parts: Iterable[tuple[Pose, Inertial]]) -> tuple[float, Array, Array]:
    """The inertia of bodies that are fixed to each other.

    Args:
        parts: Inertias, each with the pose of its link.

    Returns:
        The mass in kg, the centre of mass in m, and the inertia matrix about it in kg m², in the
        axes in which the poses are.
    """
    placed = [(pose @ each.pose, each) for pose, each in parts]
    mass = sum(each.mass for _, each in placed)
    centre = sum((each.mass * np.array(pose.position) for pose, each in placed), np.zeros(3))
    centre = centre / max(mass, LIGHTEST)
    total = np.zeros((3, 3))
    for pose, each in placed:
        turn = matrix_from_quat(pose.orientation)
        arm = np.array(pose.position) - centre
        total += turn @ tensor(each.diagonal, each.products) @ turn.T
        total += each.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return mass, centre, total


def refused_groups(groups: Iterable[Mapping[str, tuple[Pose, Inertial]]]) -> frozenset[str]:
    """The links that gz-sim merges into ones that it refuses; see `is_refused`.

    Args:
        groups: The inertias of each group of merged links, and the poses of these links, by name.
    """
    refused: set[str] = set()
    for group in groups:
        _, _, matrix = combined(group.values())
        a, b, c = np.linalg.eigvalsh(matrix).tolist()
        if is_refused((a, b, c)):
            refused.update(group)
    return frozenset(refused)


def impossibility(moments: Vec3, tolerance: float = TOLERANCE) -> tuple[str, str] | None:
    """Why no body can have these principal moments, and a hint; None if they are possible.

    Args:
        moments: The smallest first, kg m².
        tolerance: Relative tolerance.
    """
    a, b, c = moments
    digits = 7 if c * (1 - TOLERANCE) <= a + b < c * (1 - tolerance) else 4
    shown = f"{a:.{digits}g}, {b:.{digits}g} and {c:.{digits}g} kg m²"
    if a <= 0 or a < 1e-12 * c:
        return (
            f"the inertia is not positive definite: its principal moments are {shown}",
            "ixx, iyy and izz must be above 0, and the products of inertia must be smaller.",
        )
    if a + b < c * (1 - tolerance):
        return (
            f"no rigid body can have this inertia: its principal moments are {shown}, and the "
            f"largest exceeds the sum of the other two, {a + b:.{digits}g}",
            "For a solid box with the sides x, y and z: ixx = mass (y² + z²) / 12, "
            "iyy = mass (x² + z²) / 12, izz = mass (x² + y²) / 12.",
        )
    return None


def made_possible(diagonal: Vec3, products: Vec3) -> tuple[Vec3, Vec3]:
    """The inertia with its two smaller moments raised until it is physically possible.

    The axes and the largest moment, which is usually the intended one, are unchanged.

    Args:
        diagonal: ixx, iyy, izz.
        products: ixy, ixz, iyz. At least one principal moment is positive.

    Returns:
        In the same form as the arguments.
    """
    moments, axes = np.linalg.eigh(tensor(diagonal, products))
    moments = np.maximum(moments, _THINNEST * moments[2])
    missing = moments[2] - moments[0] - moments[1]
    if missing > 0:
        # Half to each: the smaller moments of a plate become more similar, as for most bodies.
        moments = moments + np.array([missing / 2, missing / 2, 0.0])
    t = ((axes * moments) @ axes.T).tolist()
    return (t[0][0], t[1][1], t[2][2]), (t[0][1], t[0][2], t[1][2])
