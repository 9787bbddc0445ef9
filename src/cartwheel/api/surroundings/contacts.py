"""Contacts between the links of a world."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from cartwheel.geometry import Vec3
from cartwheel.simulation import Simulation

if TYPE_CHECKING:
    from cartwheel.api.links import Link
    from cartwheel.api.model import Model
    from cartwheel.simulation.models.touches import Touch


@dataclass(frozen=True, kw_only=True, slots=True)
class Contact:
    """Two links that touch at one point."""

    models: tuple[str, str]
    """Names of the two models."""
    links: tuple[str, str]
    """Names of the two links in their models."""
    collisions: tuple[str, str]
    """Names of the two collisions in their links."""
    point: Vec3
    """m, in the world."""
    normal: Vec3
    """Unit vector in the world, from the second link into the first."""
    force: Vec3
    """Force on the first link, N, in world axes: the normal force and friction."""
    depth: float
    """Penetration depth, m; the physics needs a small depth for a force."""


def contacts_between(
    simulation: Simulation, between: str | Model | Link | Sequence[str | Model | Link] | None
) -> tuple[Contact, ...]:
    """The contacts in the current state; see `World.contacts`."""
    turns = selection(simulation, between)
    found = simulation.truth.contacts(lambda one, two: turns(one, two) is not None)
    return tuple(
        _contact(touch.turned() if turns(touch.first, touch.second) else touch) for touch in found
    )


def selection(
    simulation: Simulation,
    between: str | Model | Link | Sequence[str | Model | Link] | None,
    ignored: Callable[[Place], bool] = lambda _: False,
) -> Callable[[Place, Place], bool | None]:
    """A function that returns whether a contact of two collisions is meant, turned; else None.

    Args:
        simulation: The simulation.
        between: As for `World.contacts`.
        ignored: Whether contacts of a collision do not count.
    """
    sides = [side_of(simulation, each) for each in _listed(between)]
    known: dict[tuple[Place, Place], bool | None] = {}

    def turned(one: Place, two: Place) -> bool | None:
        if ignored(one) or ignored(two):
            return None
        if not sides or _fits(one, two, sides):
            return False
        return True if _fits(two, one, sides) else None

    def turns(one: Place, two: Place) -> bool | None:
        if (one, two) not in known:
            known[one, two] = turned(one, two)
        return known[one, two]

    return turns


Place = tuple[str, str, str]
"""Names of a model, of a link in it, and of a collision in the link."""
Side = tuple[str, str | None]
"""A model, and one of its links or None for all."""


def _listed(
    between: str | Model | Link | Sequence[str | Model | Link] | None,
) -> Sequence[str | Model | Link]:
    if between is None:
        return ()
    if isinstance(between, str) or not isinstance(between, Sequence):
        return (between,)
    if len(between) not in (1, 2):
        raise TypeError(f"contacts are between one or two models or links (got {len(between)})")
    return between


def side_of(simulation: Simulation, named: str | Model | Link) -> Side:
    """The model or link that a program gives.

    Raises:
        UnknownNameError: It does not exist.
    """
    if not isinstance(named, str):
        named = named.scoped_name
    model, separator, link = named.partition("::")
    if not separator:
        simulation.truth.description(model)
        return model, None
    simulation.truth.link(model, link)
    return model, link


def _fits(one: Place, two: Place, sides: Sequence[Side]) -> bool:
    return all(
        model == names[0] and link in (None, names[1])
        for (model, link), names in zip(sides, (one, two), strict=False)
    )


def _contact(touch: Touch) -> Contact:
    one, two = touch.first, touch.second
    return Contact(
        models=(one[0], two[0]),
        links=(one[1], two[1]),
        collisions=(one[2], two[2]),
        point=touch.point,
        normal=touch.normal,
        force=touch.force,
        depth=touch.depth,
    )
