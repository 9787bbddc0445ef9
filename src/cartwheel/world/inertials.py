"""Mass and inertia of a MuJoCo body."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np

from cartwheel.description.inertia import tensor
from cartwheel.description.model import Inertial
from cartwheel.geometry import IDENTITY, Array, from_wxyz, matrix_from_quat, to_wxyz

_THINNEST = 1e-6
"""Minimum ratio of a body's smallest to largest moment of inertia."""
_LEAST = 1e-12
"""Minimum moment of inertia, kg m²; the engine treats smaller values as zero."""
_POINT = 1e-6
"""Inertia of a point mass divided by its mass, m²: the engine requires a positive value."""
_ROUNDING = 1e-12
"""Relative size of products of inertia that are rounding errors."""


def _possible(inertia: Array) -> tuple[Array, float | None]:
    """An inertia matrix whose largest moment does not exceed the sum of the others.

    Thin plates are exactly at this limit, and rounded digits exceed it. Larger violations are
    rejected when the file is read.

    Returns:
        The matrix; and the smallest moment, kg m², if it was raised.
    """
    moments, axes = np.linalg.eigh(inertia)
    raised = None
    lowest = max(_THINNEST * float(moments[2]), _LEAST)
    if moments[0] < lowest:
        # An infinitely thin rod or a massless frame: the engine divides by all three moments.
        moments = np.maximum(moments, lowest)
        inertia = (axes * moments) @ axes.T
        raised = lowest
    excess = moments[2] - (moments[0] + moments[1]) * (1 - 1e-9)
    if excess <= 0:
        return inertia, raised
    return np.asarray(inertia - excess * np.outer(axes[:, 2], axes[:, 2])), raised


def set_inertial(body: Any, inertial: Inertial, *, raises: bool) -> float | None:
    """Sets mass and inertia of a body.

    Args:
        body: The body of a spec.
        inertial: The description.
        raises: Whether to raise moments of inertia that are 0 or almost 0.

    Returns:
        The smallest moment, kg m², if it was raised.
    """
    rotation = matrix_from_quat(inertial.pose.orientation)
    inertia = tensor(inertial.diagonal, inertial.products)
    raised = None
    if raises:
        point = not inertia.any()
        if point:
            inertia = np.eye(3) * _POINT * inertial.mass
        inertia, raised = _possible(inertia)
        if point and raised is None:
            raised = _POINT * inertial.mass
    turned = rotation @ inertia @ rotation.T
    body.explicitinertial = True
    body.mass = inertial.mass
    body.ipos = list(inertial.pose.position)
    body.iquat = list(to_wxyz(IDENTITY))
    body.fullinertia = [
        turned[0, 0],
        turned[1, 1],
        turned[2, 2],
        turned[0, 1],
        turned[0, 2],
        turned[1, 2],
    ]
    return raised


@dataclass(frozen=True, kw_only=True, slots=True)
class Principal:
    """A body's mass and inertia as in a compiled model."""

    mass: float
    """kg."""
    position: Array
    """The centre of mass in the body, m, shape (3,)."""
    orientation: Array
    """The principal axes in the body, (w, x, y, z)."""
    moments: Array
    """kg m², shape (3,)."""

    def along_body(self) -> Principal:
        """The same, with the body's axes as principal axes if they are.

        The compiler sorts the moments.
        """
        turn = matrix_from_quat(from_wxyz(self.orientation.tolist()))
        moments = (turn**2) @ self.moments
        rest = (turn * self.moments) @ turn.T - np.diag(moments)
        if np.abs(rest).max() > _ROUNDING * moments.max():
            return self
        return replace(self, orientation=np.array([1.0, 0.0, 0.0, 0.0]), moments=moments)

    @property
    def at_body(self) -> bool:
        """Whether the inertial frame is that of the body."""
        return not self.position.any() and bool(self.orientation[0] == 1.0)


def principal_inertial(inertial: Inertial, *, raises: bool) -> tuple[Principal, float | None]:
    """What the engine's compiler makes of an inertial; see `set_inertial`.

    Raises:
        ValueError: The compiler rejects it.
    """
    spec = mujoco.MjSpec()
    spec.compiler.boundmass = 0
    body = spec.worldbody.add_body()
    raised = set_inertial(body, inertial, raises=raises)
    model = spec.compile()
    principal = Principal(
        mass=float(model.body_mass[1]),
        position=model.body_ipos[1].copy(),
        orientation=model.body_iquat[1].copy(),
        moments=model.body_inertia[1].copy(),
    )
    return principal, raised
