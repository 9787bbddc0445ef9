"""Finds models that stand only by the width of their tyres, such as bicycles.

Wheels collide as ellipsoids, which touch the ground in the middle. A model whose wheels are in line
would then balance on a line, and tip to the side. It keeps the shapes that its description states.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

from cartwheel.description.model import Ellipsoid, Joint, Link, RobotDescription
from cartwheel.geometry import Vec3
from cartwheel.world.tyres import Axle, axle_of, is_upright, lowest, tyre

_PARALLEL = 0.99
"""Minimum cosine between the axles of wheels in line."""
_IN_LINE = 0.1
"""Maximum distance of two wheels along their axle, relative to their distance across it."""
_TOUCHES = 0.1
"""Maximum height of a part that touches the ground, relative to the radius of the wheels."""


def stands_on_width(description: RobotDescription) -> bool:
    """Whether a model touches the ground only with wheels that are in line."""
    if description.static:
        return False
    axles = list(_axles(description))
    if not axles or not _in_line([axle for _, axle in axles]):
        return False
    names = {link.name for link, _ in axles}
    bottoms: list[tuple[float, float]] = []
    across: list[tuple[float, float]] = []
    for link, axle in axles:
        own = axle.seen_from(link.pose)
        for collision in link.collisions:
            shape, place = tyre(collision, own)
            if not isinstance(shape, Ellipsoid):
                return False
            centre, radius = (link.pose @ place).position, max(shape.radii)
            bottoms.append((centre[2] - radius, radius))
            across.append((_dot(centre, axles[0][1].axis), min(shape.radii)))
    offsets = [offset for offset, _ in across]
    if max(offsets) - min(offsets) > min(half for _, half in across):
        return False
    ground, radius = min(bottoms)
    first = axles[0][1]
    if max(_apart(first, axle)[1] for _, axle in axles) < radius:
        return False  # one wheel, such as a part of a test stand
    return not any(
        lowest(collision.shape, link.pose @ collision.pose) < ground + _TOUCHES * radius
        for link in description.links
        if link.name not in names
        for collision in link.collisions
    )


def _axles(description: RobotDescription) -> Iterator[tuple[Link, Axle]]:
    """The links that roll and have collisions, each with its axle in the model."""
    inbound: dict[str, Joint] = {}
    for each in description.joints:
        inbound.setdefault(each.child, each)
    links = {link.name: link for link in description.links}
    for link in description.links:
        root, seen = link, {link.name}
        above = inbound.get(link.name)
        # A tyre may be fixed to a hub.
        while above is not None and above.type == "fixed" and above.parent in links.keys() - seen:
            root = links[above.parent]
            seen.add(root.name)
            above = inbound.get(root.name)
        axle = axle_of(above)
        if axle is None or not link.collisions:
            continue
        there = axle.seen_from(root.pose.inverse())
        if not is_upright(there.axis):
            yield link, there


def _in_line(axles: Sequence[Axle]) -> bool:
    """Whether wheels with these axles roll one behind the other."""
    return all(
        abs(_dot(first.axis, second.axis)) > _PARALLEL and _behind(first, second)
        for first, second in pairwise(axles)
    )


def _behind(first: Axle, second: Axle) -> bool:
    along, across = _apart(first, second)
    return along <= _IN_LINE * across


def _apart(first: Axle, second: Axle) -> tuple[float, float]:
    """Distances of two axles along the first one and across it, m."""
    x, y, z = (a - b for a, b in zip(second.point, first.point, strict=True))
    gap = (x, y, z)
    along = _dot(gap, first.axis)
    return abs(along), math.sqrt(max(0.0, _dot(gap, gap) - along**2))


def _dot(a: Vec3, b: Vec3) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))
