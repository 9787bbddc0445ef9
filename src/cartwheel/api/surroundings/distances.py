"""Rays, and distances between models."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from cartwheel.api.properties.inertials import missing
from cartwheel.api.surroundings.contacts import Side, side_of
from cartwheel.api.values import Vector, invalid, scalar, vector
from cartwheel.geometry import Vec3
from cartwheel.simulation import Simulation
from cartwheel.simulation.limits import number, numbers

if TYPE_CHECKING:
    from cartwheel.api.links import Link
    from cartwheel.api.model import Model

Places: TypeAlias = "str | Model | Link | Sequence[str | Model | Link]"
"""One model or link, or several: each a `Model`, a `Link` or a name."""

_Test = Callable[[tuple[str, str, str]], bool]
"""Selects collisions by their names and those of their model and link."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Hit:
    """Where a ray hits a collision."""

    model: str
    """Name of the model."""
    link: str
    """Name of the link in the model."""
    collision: str
    """Name of the collision in the link."""
    distance: float
    """Distance from the origin of the ray, m."""
    point: Vec3
    """m, in the world."""
    normal: Vec3
    """Unit vector out of the surface, in the world."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Clearance:
    """The shortest way between two models or links."""

    distance: float
    """m; the negative penetration depth if they overlap."""
    points: tuple[Vec3, Vec3]
    """The nearest points of the surfaces, m, in the world."""
    models: tuple[str, str]
    """Names of the two models."""
    links: tuple[str, str]
    """Names of the two links in their models."""
    collisions: tuple[str, str]
    """Names of the two collisions in their links."""


def ray(
    simulation: Simulation, origin: Vector, direction: Vector, max_range: float, ignore: Places
) -> Hit | None:
    """What a ray hits first; see `World.ray`."""
    start = vector(origin, "origin")
    numbers(start, "origin")
    way = vector(direction, "direction")
    longest = max(map(abs, way))
    if longest == 0:
        raise invalid("direction", "must not be zero", direction)
    if max_range != math.inf:
        scalar(max_range, "max_range", above=0.0)
    x, y, z = (each / longest for each in way)
    found = simulation.truth.shapes.ray(start, (x, y, z), max_range, among(simulation, ignore))
    if found is None:
        return None
    model, link, collision = found.place
    return Hit(
        model=model,
        link=link,
        collision=collision,
        distance=found.distance,
        point=found.point,
        normal=found.normal,
    )


def ground_height(simulation: Simulation, x: float, y: float, below: float) -> float:
    """Height of the highest fixed surface; see `World.ground_height`."""
    if below != math.inf:
        number(below, "below")
    found = simulation.truth.shapes.ground(number(x, "x"), number(y, "y"), below)
    return math.nan if found is None else found


def clearance(
    simulation: Simulation, one: Places, other: Places | None, ignore: Places
) -> Clearance:
    """The shortest way between two models or links; see `World.clearance`."""
    first = among(simulation, one)
    ignored = among(simulation, ignore)
    second = _not_among(simulation, one) if other is None else among(simulation, other)
    found = simulation.truth.shapes.gap(
        lambda place: first(place) and not ignored(place),
        lambda place: second(place) and not ignored(place),
    )
    if found is None:
        raise missing(
            "world", simulation.world.name, "distance between them",
            _why_none(simulation, first, second, ignored, alone=other is None),
        )  # fmt: skip
    (model, link, collision), (with_model, with_link, with_collision) = found.places
    return Clearance(
        distance=found.distance,
        points=found.points,
        models=(model, with_model),
        links=(link, with_link),
        collisions=(collision, with_collision),
    )


def _why_none(
    simulation: Simulation, first: _Test, second: _Test, ignored: _Test, *, alone: bool
) -> str:
    """Why two sides have no distance."""
    places = [
        (name, link.name, collision.name)
        for name, resident in simulation.population.residents.items()
        for link in resident.entry.description.links
        for collision in link.collisions
    ]
    ones, others = (
        {place for place in places if test(place) and not ignored(place)}
        for test in (first, second)
    )
    if not ones:
        return "The first one has no collision, or it is ignored."
    if not others:
        return (
            "Nothing else has a collision, besides what is ignored." if alone
            else "The second one has no collision, or it is ignored."
        )  # fmt: skip
    return "Both are the same." if ones == others else "Both are planes."


def _sides(simulation: Simulation, given: Places) -> list[Side]:
    if isinstance(given, str) or not isinstance(given, Sequence):
        return [side_of(simulation, given)]
    return [side_of(simulation, each) for each in given]


def among(simulation: Simulation, given: Places) -> _Test:
    """Whether a collision belongs to one of some models or links."""
    sides = _sides(simulation, given)
    return lambda place: any(
        place[0] == model and link in (None, place[1]) for model, link in sides
    )


def _not_among(simulation: Simulation, given: Places) -> _Test:
    """Whether a collision belongs to other models than these, or those of these links."""
    models = {model for model, _ in _sides(simulation, given)}
    return lambda place: place[0] not in models
