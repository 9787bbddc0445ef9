"""Explicit geom pairs with their own contact parameters.

MuJoCo takes a contact's parameters from one of its geoms. Three properties require an explicit
pair: softer friction for a sliding body, direction-dependent friction, and torsional friction.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from cartwheel.geometry import Vec3
from cartwheel.world import contact
from cartwheel.world.contact import BuiltSurface

MOST_PAIRS = 500
"""Maximum number of explicit pairs; each costs 6 ns per step."""
_HOLDS = 10.0
"""A coefficient at which nothing slips: Gazebo's ground plane has 100 and 50."""
_PATCH = 3 * math.pi / 16
"""Mean friction arm of a circular patch with Hertz pressure, relative to its radius."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Alignment:
    """The directions in which the two coefficients of a pair apply."""

    first: str
    second: str
    """Geom names."""
    body: str | None
    """The body with the axes of `direction`; None for a direction in the world, as ODE chooses it.
    """
    direction: Vec3
    across: bool
    """Whether the pair's first coefficient applies perpendicular to the direction."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Pair:
    """Two geoms that may touch, with their contact parameters."""

    first: BuiltSurface
    second: BuiltSurface
    friction: tuple[float, float]
    """The larger coefficient first, because the engine scales by it."""
    torsion: float
    """m; maximum torque about the normal per normal force."""
    reference: tuple[float, float]
    friction_time: float | None
    """Decay time of slip, s; None for the contact's stiffness."""
    impedance: tuple[float, ...]
    alignment: Alignment | None = None

    def arguments(self) -> dict[str, Any]:
        """Arguments for ``MjSpec.add_pair``."""
        _, _, rolling = contact.friction(self.first.surface)
        found: dict[str, Any] = {
            "geomname1": self.first.name,
            "geomname2": self.second.name,
            "condim": 4 if self.torsion else 3,
            "friction": [*self.friction, self.torsion or contact.TORSION, rolling, rolling],
            "solref": list(self.reference),
            "solimp": list(self.impedance),
        }
        if self.friction_time is not None:
            found["solreffriction"] = [self.friction_time, 1.0]
        return found


def stated_pairs(
    surfaces: Iterable[BuiltSurface],
    joined: Collection[frozenset[str]] = (),
    *,
    soft_sliding: bool = True,
) -> Iterator[Pair]:
    """Pairs of moving geoms with geoms of other models that need their own parameters.

    In MuJoCo's convex contact model, a sliding body is lifted: at speed v, it hovers at mu v b/k,
    with the damping b of friction and the stiffness k of the normal direction, and skips. Only an
    explicit pair can have a separate b, so sliding bodies get pairs with fixed bodies. A wheel
    keeps the stiff value, because it slips sideways by ω v/b in a turn at rate ω. Wheels that slide
    in each turn, and tracks, are softer, also in the normal direction, so that they stay on the
    ground. Parts of a robot's trunk that are dragged where its wheels roll are guided by the wheels
    and are softer still.

    Each pair is tested in every step, near or far. In a world with more than `MOST_PAIRS`, only the
    largest floors get pairs, and bodies that slide on smaller ones are lifted.

    Args:
        surfaces: Surfaces of all models.
        joined: Bodies of different models that are connected by a joint and do not collide.
        soft_sliding: Whether sliding bodies get pairs with softer friction.
    """
    surfaces = list(surfaces)
    special = any(map(_special, surfaces))
    if not special and not soft_sliding:
        return
    movers = [each for each in surfaces if each.moves and (special or each.slides)]
    standing = [each for each in surfaces if not each.moves]
    if movers and len(movers) * len(standing) > MOST_PAIRS:
        standing.sort(key=lambda each: each.floor_area, reverse=True)
        standing = standing[: max(1, MOST_PAIRS // len(movers))]
    count = 0
    for mover in movers:
        for still in standing:
            time = mover.friction_time if soft_sliding else None
            if (pair := _pair(still, mover, joined, time)) is not None:
                count += 1
                yield pair
    for index, first in enumerate(movers if special else ()):
        for second in movers[index + 1 :]:
            if count >= MOST_PAIRS:
                return
            if _special(first) or _special(second):
                pair = _pair(first, second, joined)
                if pair is not None:
                    count += 1
                    yield pair


def _special(surface: BuiltSurface) -> bool:
    mu1, mu2 = contact.coefficients(surface.surface)
    return mu1 != mu2 or bool(surface.surface.patch_radius)


def _pair(
    first: BuiltSurface,
    second: BuiltSurface,
    joined: Collection[frozenset[str]],
    friction_time: float | None = None,
) -> Pair | None:
    if joined and frozenset((first.body, second.body)) in joined:
        return None
    if first.model == second.model or not contact.masks_fit(first.surface, second.surface):
        return None
    a, b = first.surface, second.surface
    rules = first if first.friction[0] < second.friction[0] else second
    mu1, mu2 = map(min, contact.coefficients(a), contact.coefficients(b))
    if min(mu1, mu2) > _HOLDS:
        mu1 = mu2 = min(mu1, mu2)
    torsion = min(1.0 if s.torsional is None else s.torsional for s in (a, b))
    torsion *= _PATCH * max(s.patch_radius or 0.0 for s in (a, b))
    if mu1 == mu2 and not torsion and friction_time is None:
        return None
    scrubs = second.scrubs_softly and friction_time is not None
    return Pair(
        first=first,
        second=second,
        friction=(max(mu1, mu2), min(mu1, mu2)),
        torsion=torsion,
        reference=rules.reference,
        friction_time=friction_time,
        impedance=contact.SCRUBBING_IMPEDANCE if scrubs else contact.IMPEDANCE,
        alignment=_alignment(first, second, across=mu2 > mu1) if mu1 != mu2 else None,
    )


def _alignment(first: BuiltSurface, second: BuiltSurface, *, across: bool) -> Alignment:
    """Uses the direction of the surface with the smaller mu1 if both have one, as Gazebo does."""
    by_mu1 = sorted((first, second), key=lambda each: contact.coefficients(each.surface)[0])
    stated = [each.direction for each in by_mu1 if each.direction is not None]
    body, direction = stated[0] if stated else (None, (0.0, 0.0, 0.0))
    return Alignment(
        first=first.name, second=second.name, body=body, direction=direction, across=across
    )
