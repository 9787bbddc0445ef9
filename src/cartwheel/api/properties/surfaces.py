"""Friction coefficients of links."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cartwheel.api.properties.inertials import missing
from cartwheel.api.values import array, invalid
from cartwheel.description.model import Link

_DEFAULT = 1.0
"""Gazebo's default coefficient."""


def friction_of(link: Link) -> tuple[float, float]:
    """The coefficients mu and mu2 of a link's first collision.

    Raises:
        CartwheelError: The link has no collision.
    """
    if not link.collisions:
        raise missing("link", link.name, "collision")
    surface = link.collisions[0].surface
    mu = _DEFAULT if surface.mu1 is None else surface.mu1
    return mu, mu if surface.mu2 is None else surface.mu2


def with_friction(link: Link, friction: float | Sequence[float]) -> Link:
    """The link with other coefficients on all collisions."""
    friction_of(link)
    shape = (2,) if np.ndim(friction) else ()
    given = array(friction, shape, "friction")
    if (given < 0).any():
        raise invalid("friction", "must not be negative", friction)
    mu, mu2 = np.broadcast_to(given, 2).tolist()
    collisions = tuple(
        replace(each, surface=replace(each.surface, mu1=mu, mu2=mu2)) for each in link.collisions
    )
    return replace(link, collisions=collisions)
