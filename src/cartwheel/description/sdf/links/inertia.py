"""Checks masses and inertias, and computes them from collisions and density."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.codes.robot import INERTIA_IMPOSSIBLE, MASS_NOT_POSITIVE
from cartwheel.codes.tags import VALUE_IGNORED
from cartwheel.description.inertia import (
    HEAVIEST,
    LIGHTEST,
    REFUSES,
    TOLERANCE,
    TOLERANCE_OF_GZ,
    impossibility,
    is_refused,
    made_possible,
    principal_moments,
)
from cartwheel.description.meshes import surface_of
from cartwheel.description.model import (
    Box,
    Capsule,
    Collision,
    Cone,
    Cylinder,
    Ellipsoid,
    Inertial,
    Link,
    Mesh,
    Polyline,
    Shape,
    Sphere,
)
from cartwheel.description.sdf.context import Context
from cartwheel.description.shapes.outline import solid
from cartwheel.errors import DescriptionError, Origin, Value
from cartwheel.geometry import Pose, Vec3, matrix_from_quat

Array = NDArray[np.float64]
WATER = 1000.0
"""kg/m³, SDF's default density."""


def judged_inertia(link: Link, *, rigid: bool, ctx: Context) -> Inertial | None:
    """A link's inertia, or the nearest physically possible one.

    Args:
        link: A link in a non-static model.
        rigid: Whether it is fixed to another link, so that its inertia is only part of a sum.
        ctx: Receives the diagnostics.

    Raises:
        DescriptionError: The mass is not positive, or the inertia is far from possible.
    """
    i = link.inertial
    if i is None:
        return None
    if i.mass == 0 and rigid and not any((*i.diagonal, *i.products)):
        ctx.warn(
            MASS_NOT_POSITIVE,
            f'the mass of link "{link.name}" is 0. Gazebo Classic does not load such a model; '
            "Cartwheel and gz-sim attach the link to another one without a mass",
            origin=i.origin,
            severity="warning",
            values={"link": link.name, "stated": 0.0},
        )
        return None
    if not 0 < i.mass <= HEAVIEST:
        raise DescriptionError(
            f'the mass of link "{link.name}" must be above 0 and at most {HEAVIEST:g} kg (got '
            f"{i.mass:g})",
            code=MASS_NOT_POSITIVE,
            origin=i.origin,
            values={"link": link.name, "stated": i.mass},
        )
    if i.mass < LIGHTEST and not rigid:
        # Such masses are often written for links that are only frames.
        ctx.warn(
            VALUE_IGNORED,
            f'link "{link.name}" has a mass of {i.mass:g} kg, so {LIGHTEST:g} kg is used, the '
            "smallest mass that can be simulated",
            origin=i.origin,
            severity="info",
            values={"link": link.name, "stated": i.mass, "used": LIGHTEST},
        )
        i = replace(i, mass=LIGHTEST)
    diagonal, products = i.diagonal, i.products
    if rigid and not any((*diagonal, *products)):
        return i  # a point mass: the link that it is fixed to has the inertia
    moments = principal_moments(diagonal, products)
    in_gz = ctx.simulator == "gz"
    wrong = impossibility(moments, TOLERANCE_OF_GZ if in_gz else TOLERANCE)
    if wrong is None:
        return i
    message, hint = f'link "{link.name}": {wrong[0]}', wrong[1]
    values: dict[str, Value] = {"link": link.name, "moments": moments}
    unusable = DescriptionError(
        message, code=INERTIA_IMPOSSIBLE, origin=i.origin, hint=hint, values=values
    )
    if moments[0] < -1e-9 * moments[2]:
        raise unusable
    if not any(moments):
        shape = inertial_of(list(link.collisions), [WATER] * len(link.collisions), i.origin)
        if shape is None:
            ctx.warn(
                INERTIA_IMPOSSIBLE,
                f'link "{link.name}" is a point mass: its inertia is 0',
                origin=i.origin,
                severity="info",
                values={"link": link.name},
            )
            return i  # a rotating part without any inertia gets one as a whole
        # About the stated centre of mass, along the link's axes.
        made = replace(weighing(shape, i.mass), pose=Pose(i.pose.position))
        here = (
            f"Cartwheel computes {made.ixx:.4g}, {made.iyy:.4g}, {made.izz:.4g} from the collisions"
        )
    else:
        (ixx, iyy, izz), (ixy, ixz, iyz) = made_possible(diagonal, products)
        made = replace(i, ixx=ixx, iyy=iyy, izz=izz, ixy=ixy, ixz=ixz, iyz=iyz)
        a, b, _ = principal_moments((ixx, iyy, izz), (ixy, ixz, iyz))
        here = f"Cartwheel increases the smaller moments to {a:.4g} and {b:.4g}"
    if in_gz and is_refused(moments):
        here += f"; {REFUSES}"
        values["refused"] = True
    ctx.warn(
        INERTIA_IMPOSSIBLE,
        f"{message}; {here}",
        origin=i.origin,
        hint=hint,
        values=values,
    )
    return made


def weighing(inertial: Inertial, mass: float) -> Inertial:
    """The same body with a different density."""
    return replace(inertial, mass=mass, **inertial.scaled(mass))


def inertial_of(
    collisions: list[Collision], densities: list[float], origin: Origin
) -> Inertial | None:
    """Mass, centre of mass and inertia of solid bodies; overlaps count twice, as in Gazebo.

    Args:
        collisions: The link's collisions.
        densities: Density of each collision, kg/m³.
        origin: The ``<inertial>``.

    Returns:
        None if no collision has a volume.
    """
    parts: list[tuple[float, Array, Array]] = []
    for collision, density in zip(collisions, densities, strict=True):
        volume, centre, tensor = _solid(collision.shape)
        if volume <= 0:
            continue
        R = matrix_from_quat(collision.pose.orientation)
        parts.append(
            (
                density * volume,
                np.array(collision.pose.apply(centre.tolist())),
                density * (R @ tensor @ R.T),
            )
        )
    mass = sum(part[0] for part in parts)
    if mass <= 0:
        return None
    com = sum((m * c for m, c, _ in parts), np.zeros(3)) / mass
    total = np.zeros((3, 3))
    for m, c, tensor in parts:
        r = c - com
        total += tensor + m * (float(r @ r) * np.eye(3) - np.outer(r, r))
    return Inertial(
        mass=float(mass),
        pose=Pose((float(com[0]), float(com[1]), float(com[2]))),
        ixx=float(total[0, 0]),
        iyy=float(total[1, 1]),
        izz=float(total[2, 2]),
        ixy=float(total[0, 1]),
        ixz=float(total[0, 2]),
        iyz=float(total[1, 2]),
        origin=origin,
    )


def volume_of(shape: Shape) -> tuple[float, Vec3]:
    """Volume of a shape in m³, and its centre in the shape's frame in m; 0 for open shapes.

    Raises:
        MeshError: The mesh cannot be read.
    """
    volume, centre, _ = _solid(shape)
    x, y, z = centre.tolist()
    return volume, (x, y, z)


def _solid(shape: Shape) -> tuple[float, Array, Array]:
    """Volume, centroid, and inertia about it at density one, in the shape's frame."""
    centre = np.zeros(3)
    match shape:
        case Box(size=(x, y, z)):
            volume = x * y * z
            moments = [(y * y + z * z) / 12, (x * x + z * z) / 12, (x * x + y * y) / 12]
        case Sphere(radius=r):
            volume = 4 / 3 * math.pi * r**3
            moments = [0.4 * r * r] * 3
        case Ellipsoid(radii=(a, b, c)):
            volume = 4 / 3 * math.pi * a * b * c
            moments = [(b * b + c * c) / 5, (a * a + c * c) / 5, (a * a + b * b) / 5]
        case Cylinder(radius=r, length=h):
            volume = math.pi * r * r * h
            side = (3 * r * r + h * h) / 12
            moments = [side, side, r * r / 2]
        case Cone(radius=r, length=h):
            volume = math.pi * r * r * h / 3
            centre = np.array([0, 0, -h / 4])  # a quarter of the height above the base
            side = 3 / 80 * (4 * r * r + h * h)
            moments = [side, side, 0.3 * r * r]
        case Capsule(radius=r, length=h):
            cylinder, ball = math.pi * r * r * h, 4 / 3 * math.pi * r**3
            volume = cylinder + ball
            # Each hemisphere about its own centroid, 3r/8 beyond the cylinder's end.
            side = cylinder * (3 * r * r + h * h) / 12
            side += ball * (0.4 * r * r + h * h / 4 + 3 / 8 * h * r)
            moments = [side / volume, side / volume]
            moments.append((cylinder * r * r / 2 + ball * 0.4 * r * r) / volume)
        case Mesh():
            return _mesh(*surface_of(shape))
        case Polyline():
            return _mesh(*solid(shape))
        case _:
            return 0.0, centre, np.zeros((3, 3))
    return volume, centre, np.diag(moments) * volume


def _mesh(vertices: NDArray[Any], faces: NDArray[Any]) -> tuple[float, Array, Array]:
    """Sums signed tetrahedra between the origin and each triangle of a closed surface."""
    corners = vertices.astype(np.float64)[faces]
    volumes = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    volume = float(volumes.sum())
    if volume <= 0:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    sums = corners.sum(axis=1)
    centre = (volumes[:, None] * sums).sum(axis=0) / (4 * volume)
    # The second moments of a tetrahedron with one corner at the origin.
    squares = np.einsum("n,nij,nik->jk", volumes, corners, corners)
    squares = (squares + np.einsum("n,nj,nk->jk", volumes, sums, sums)) / 20
    squares -= volume * np.outer(centre, centre)
    return volume, centre, np.trace(squares) * np.eye(3) - squares
