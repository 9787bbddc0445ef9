"""Collisions between links of one model: which links are meant, and where they overlap."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from cartwheel.description.model import Link, Mesh, RobotDescription
from cartwheel.description.solids import Floats, Solid, boxes_meet, hull, overlap, solid_of

PENETRATION = 0.002
"""Minimum penetration of two shapes that counts as an overlap, m."""
MOST_LINKS = 60
"""Largest number of links of a model that are compared with each other."""


def collides(description: RobotDescription, link: Link) -> bool:
    """Whether a link collides with others of its model that do, too."""
    return description.self_collide if link.self_collide is None else link.self_collide


def has_mesh(link: Link) -> bool:
    """Whether a collision of a link is a mesh, which collides as its convex hull if it moves."""
    return any(isinstance(each.shape, Mesh) for each in link.collisions)


def overlapping(
    pairs: Sequence[tuple[Link, Link]], solids: Mapping[str, Iterable[Solid]] | None = None
) -> Iterator[tuple[Link, Link]]:
    """Those of the pairs of links whose convex hulls overlap while all joints are at 0.

    Args:
        pairs: The pairs.
        solids: Collisions by link; None: they are computed.
    """
    links = {link.name: link for pair in pairs for link in pair}
    if solids is None:
        solids = {
            name: [found for each in link.collisions if (found := solid_of(each, name)) is not None]
            for name, link in links.items()
        }
    clouds: dict[str, list[Floats]] = {
        name: [hull(solid).placed(link.pose) for solid in solids[name]]
        for name, link in links.items()
    }
    for first, second in pairs:
        if any(
            boxes_meet(a, b) and overlap(a, b, PENETRATION)
            for a in clouds[first.name]
            for b in clouds[second.name]
        ):
            yield first, second
