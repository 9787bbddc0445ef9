"""Checks whether a stated inertia is physically possible."""

from __future__ import annotations

import math

import numpy as np

from cartwheel.geometry import Array, Vec3

TOLERANCE = 1e-3
"""Relative tolerance: files contain three or four digits, and thin plates are exactly at the limit.
"""
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


def impossibility(moments: Vec3) -> tuple[str, str] | None:
    """Why no body can have these principal moments, and a hint; None if they are possible."""
    a, b, c = moments
    shown = f"{a:.4g}, {b:.4g} and {c:.4g} kg m²"
    if a <= 0 or a < 1e-12 * c:
        return (
            f"the inertia is not positive definite: its principal moments are {shown}",
            "ixx, iyy and izz must be above 0, and the products of inertia must be smaller.",
        )
    if a + b < c * (1 - TOLERANCE):
        return (
            f"no rigid body can have this inertia: its principal moments are {shown}, and the "
            f"largest exceeds the sum of the other two, {a + b:.4g}",
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
