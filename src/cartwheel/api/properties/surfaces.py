"""Friction and restitution of links."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from cartwheel.api.properties.inertials import missing
from cartwheel.api.values import array, invalid
from cartwheel.description.model import NO_BOUNCE, Link, Surface

_DEFAULT = 1.0
"""Gazebo's default coefficient."""


def friction_of(link: Link) -> tuple[float, float]:
    """The coefficients mu and mu2 of a link's first collision.

    Raises:
        CartwheelError: The link has no collision.
    """
    surface = _first(link)
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
    return _with_surfaces(link, lambda surface: replace(surface, mu1=mu, mu2=mu2))


def restitution_of(link: Link) -> float:
    """The coefficient of restitution of a link's first collision.

    Raises:
        CartwheelError: The link has no collision.
    """
    return min(_first(link).restitution or 0.0, 1.0)


def with_restitution(link: Link, restitution: float) -> Link:
    """The link with another coefficient on all collisions.

    Collisions without a threshold that can be reached get the threshold 0.
    """
    _first(link)
    given = float(array(restitution, (), "restitution"))
    if not 0 <= given <= 1:
        raise invalid("restitution", "must be from 0 to 1", restitution)

    def changed(surface: Surface) -> Surface:
        threshold = surface.bounce_threshold
        if threshold is None or threshold >= NO_BOUNCE:
            threshold = 0.0
        return replace(surface, restitution=given, bounce_threshold=threshold)

    return _with_surfaces(link, changed)


def _first(link: Link) -> Surface:
    if not link.collisions:
        raise missing("link", link.name, "collision")
    return link.collisions[0].surface


def _with_surfaces(link: Link, change: Callable[[Surface], Surface]) -> Link:
    collisions = tuple(replace(each, surface=change(each.surface)) for each in link.collisions)
    return replace(link, collisions=collisions)
