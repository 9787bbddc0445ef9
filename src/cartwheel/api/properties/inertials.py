"""Masses and inertias of links."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from cartwheel.api.values import Vector, array, invalid, scalar, vector
from cartwheel.codes.world import PROPERTY_ABSENT
from cartwheel.description.inertia import HEAVIEST, impossibility, principal_moments, tensor
from cartwheel.description.model import Inertial, Link
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Array, Pose, matrix_from_quat

_SYMMETRY = 1e-9
"""Relative tolerance of a symmetric matrix."""


def inertial_of(link: Link) -> Inertial:
    """A link's inertial.

    Raises:
        CartwheelError: It has none.
    """
    if link.inertial is None:
        raise missing("link", link.name, "mass", "Add an <inertial> to its description.")
    return link.inertial


@contextlib.contextmanager
def naming(links: Sequence[Link]) -> Iterator[None]:
    """Names the links that have a property in the error for one that does not have it."""
    try:
        yield
    except CartwheelError as error:
        if error.code is PROPERTY_ABSENT:
            mass = error.values["property"] == "mass"
            names = [each.name for each in links if (each.inertial if mass else each.collisions)]
            if names:
                shown = ", ".join(names[:12]) + (", …" if len(names) > 12 else "")
                error.hint = f"Links that have one: {shown}."
                error.values = {**error.values, "links": tuple(names)}
        raise


def missing(kind: str, name: str, what: str, hint: str = "") -> CartwheelError:
    """The error for a link or joint without a property."""
    return CartwheelError(
        f'{kind} "{name}" has no {what}',
        code=PROPERTY_ABSENT,
        hint=hint or None,
        values={"kind": kind, "name": name, "property": what},
    )


def with_mass(link: Link, mass: float) -> Link:
    """The link with another mass."""
    mass = scalar(mass, "mass", above=0.0)
    if mass > HEAVIEST:
        raise invalid("mass", f"must be at most {HEAVIEST:g}", mass)
    return replace(link, inertial=replace(inertial_of(link), mass=mass))


def with_centre(link: Link, centre: Vector) -> Link:
    """The link with another centre of mass."""
    inertial = inertial_of(link)
    pose = Pose(vector(centre, "center_of_mass"), inertial.pose.orientation)
    return replace(link, inertial=replace(inertial, pose=pose))


def inertia_of(link: Link) -> Array:
    """The inertia matrix about the centre of mass in the link's axes, kg m², shape (3, 3)."""
    inertial = inertial_of(link)
    turn = matrix_from_quat(inertial.pose.orientation)
    turned: Array = turn @ tensor(inertial.diagonal, inertial.products) @ turn.T
    return turned


def with_inertia(link: Link, inertia: object) -> Link:
    """The link with another inertia matrix about the centre of mass, in its axes."""
    inertial = inertial_of(link)
    matrix = array(inertia, (3, 3), "inertia")
    if not np.allclose(matrix, matrix.T, rtol=0, atol=_SYMMETRY * np.abs(matrix).max()):
        raise invalid("inertia", "must be symmetric", matrix.tolist())
    ixx, iyy, izz = matrix.diagonal().tolist()
    ixy, ixz, iyz = float(matrix[0, 1]), float(matrix[0, 2]), float(matrix[1, 2])
    reason = impossibility(principal_moments((ixx, iyy, izz), (ixy, ixz, iyz)))
    if reason is not None:
        error = invalid("inertia", f"is impossible: {reason[0]}", matrix.tolist())
        error.hint = reason[1]
        raise error
    return replace(
        link,
        inertial=replace(
            inertial,
            pose=Pose(inertial.pose.position),
            ixx=ixx,
            iyy=iyy,
            izz=izz,
            ixy=ixy,
            ixz=ixz,
            iyz=iyz,
        ),
    )
