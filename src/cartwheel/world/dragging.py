"""Finds the parts that a base must slide over the ground, and limits their friction.

When a base drives, its fixed casters slide. When it turns, the wheels of two axles that are not
steered slide sideways. A steered wheel beside its steering axis slides, unless it rolls around this
axis. Descriptions often state coefficients of 100 or more for such parts. By Coulomb's law, their
friction then exceeds what the motors can overcome. Gazebo's bases move, because ODE stops its
iterations before the friction has its full value.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

from cartwheel.world import contact
from cartwheel.world.additions import Added
from cartwheel.world.contact import BuiltSurface
from cartwheel.world.tyres import Tread

LARGEST_MU = 1.0
"""Maximum friction coefficient of parts that must slide: Gazebo's default, and that of rubber."""
_TOUCHES = 0.02
"""Maximum height of a part that touches the ground, relative to the radius of the wheels."""
_NEAR = 0.1
"""Maximum difference between the heights of wheels and of a ball caster, relative to the radius of
the wheels."""
LARGEST_STEERED_MU = 1.5
"""The same for wheels that motors steer. They also need grip, for turns at high speed."""


def limited(
    surfaces: Iterable[BuiltSurface], *, limit: bool
) -> tuple[list[BuiltSurface], list[Added]]:
    """The surfaces, with dragged parts marked and the friction of sliding parts limited.

    Args:
        surfaces: Surfaces of all models.
        limit: Whether to limit the friction.

    Returns:
        The surfaces, and the collisions whose friction is reduced.
    """
    surfaces, twins = _without_misaligned(surfaces)
    treads: dict[str, list[Tread]] = {}
    for each in surfaces:
        if each.tread is not None:
            treads.setdefault(each.model, []).append(each.tread)
    made: list[BuiltSurface] = []
    added: dict[tuple[str, str], Added] = {}
    for each in surfaces:
        beside = treads.get(each.model, ())
        surface = replace(each, trails=_trails(each, beside), scrubs=_scrubs(each, beside))
        largest = _largest(surface) if limit else math.inf
        if max(contact.coefficients(surface.surface)) > largest:
            surface = _limited(surface, largest)
            found = surface.added("limited-friction", largest)
            added[surface.model, found.element] = found
        made.append(surface)
    dragging = {each.model for each in made if _drags(each, treads.get(each.model, ()))}
    made = [
        replace(each, pulls=each.rolls and each.model in dragging and each.name not in twins)
        for each in made
    ]
    return made, list(added.values())


def _without_misaligned(
    surfaces: Iterable[BuiltSurface],
) -> tuple[list[BuiltSurface], frozenset[str]]:
    """The surfaces, where wheels that cannot roll in the direction of the motion are dragged parts.

    Ball casters are often described as a sphere on a continuous joint with any axis, or as two
    spheres at one point, of which one rolls forward and one sideways.

    Returns:
        The surfaces, and the names of those that roll forward at the place of one that cannot.
    """
    surfaces = list(surfaces)
    driven: dict[str, list[Tread]] = {}
    for each in surfaces:
        if each.tread is not None and each.tread.driven:
            driven.setdefault(each.model, []).append(each.tread)
    made = []
    across: dict[str, list[Tread]] = {}
    for each in surfaces:
        wheels = driven.get(each.model, ())
        if each.tread is not None and _is_misaligned(each.tread, wheels):
            across.setdefault(each.model, []).append(each.tread)
            each = replace(each, rolls=False, tread=None, bottom=each.tread.bottom)  # noqa: PLW2901
        elif each.low is not None and _touches(each.low, wheels):
            each = replace(each, rolls=False, bottom=each.low)  # noqa: PLW2901
        made.append(each)
    twins = (each for each in made if _is_at_one(each.tread, across.get(each.model, ())))
    return made, frozenset(each.name for each in twins)


def _is_at_one(tread: Tread | None, others: Sequence[Tread]) -> bool:
    """Whether an undriven wheel is at the place of another wheel."""
    if tread is None or tread.driven:
        return False
    return any(math.dist(tread.centre, each.centre) < _NEAR * each.radius for each in others)


def _touches(bottom: float, treads: Sequence[Tread]) -> bool:
    """Whether a part is about as low as wheels, or lower, so that the robot tilts onto it."""
    return any(bottom - each.bottom < _NEAR * each.radius for each in treads)


def _is_misaligned(tread: Tread, driven: Sequence[Tread]) -> bool:
    """Whether an undriven wheel on a fixed axle is not parallel to driven wheels, which are.

    A base with driven wheels in several directions, such as three omnidirectional wheels, moves in
    each of them.
    """
    if tread.driven or tread.carried or tread.steered != "not" or not driven:
        return False
    if any(each.steered != "not" or each.carried for each in driven):
        return False
    parallel = all(each.rolls_beside(driven[0]) for each in driven)
    return parallel and not tread.rolls_beside(driven[0])


def _largest(surface: BuiltSurface) -> float:
    """Maximum friction coefficient of a surface."""
    if surface.trails or surface.scrubs:
        return LARGEST_MU
    if surface.tread is not None and surface.tread.steered == "by motors":
        return LARGEST_STEERED_MU
    return math.inf


def _limited(surface: BuiltSurface, largest: float) -> BuiltSurface:
    mu1, mu2 = contact.coefficients(surface.surface)
    changed = replace(surface.surface, mu1=min(mu1, largest), mu2=min(mu2, largest))
    return replace(surface, surface=changed, friction=contact.friction(changed))


def _drags(surface: BuiltSurface, treads: Sequence[Tread]) -> bool:
    """Whether a geom with friction touches level ground together with wheels."""
    if surface.bottom is None or not any(contact.coefficients(surface.surface)):
        return False
    return any(surface.bottom - each.bottom < _TOUCHES * each.radius for each in treads)


def _trails(surface: BuiltSurface, treads: Sequence[Tread]) -> bool:
    """Whether a geom touches the ground beside wheels, at about the same height."""
    bottom = surface.bottom
    return bottom is not None and any(abs(bottom - each.bottom) < each.radius for each in treads)


def _scrubs(surface: BuiltSurface, treads: Sequence[Tread]) -> bool:
    """Whether a wheel slides sideways in a turn, or in each motion, as a caster without trail does.
    Mecanum wheels roll in each direction.
    """
    mu1, mu2 = contact.coefficients(surface.surface)
    if surface.tread is None or (surface.surface.fdir1_frame is not None and mu1 != mu2):
        return False
    if surface.tread.follows_nothing and any(each.driven for each in treads):
        return True
    return any(map(surface.tread.scrubs_beside, treads))
