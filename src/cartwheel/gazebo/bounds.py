"""Bounds of entities, and tests whether an entity overlaps bounds in a request."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from cartwheel.description.model import (
    Capsule,
    Heightmap,
    Plane,
    Polyline,
    RobotDescription,
    Sphere,
)
from cartwheel.description.solids import Floats, distance, moved, solid_of
from cartwheel.gazebo.entities import Entities
from cartwheel.gazebo.requests import vector
from cartwheel.gazebo.results import FAILED, PACKAGE, UNSUPPORTED, Refusal
from cartwheel.geometry import Pose, rotate
from cartwheel.messages import message_class, zero

EMPTY, BOX, CONVEX_HULL, SPHERE = range(4)
"""Types in Bounds.msg."""
_TOUCH = 1e-6
"""Tolerance for contact, m."""


@dataclass(frozen=True, slots=True)
class _Piece:
    """A collision in its link's frame."""

    link: str
    points: Floats
    """Points with this convex hull, shape (n, 3), m; for a plane, a point and the normal."""
    radius: float = 0.0
    """Distance by which the shape extends beyond the hull, m."""
    endless: bool = False


class Rooms:
    """Convex bounds of the models' collisions in the current state.

    Visuals are used for models without collisions. Use it on the simulation's thread, after a
    forward pass.

    Args:
        entities: Resolves model names.
    """

    def __init__(self, entities: Entities) -> None:
        self._entities = entities
        self._known: dict[str, tuple[RobotDescription, tuple[_Piece, ...]]] = {}

    def message(self, name: str) -> Any:
        """``Bounds`` in the frame of the model's canonical link: a box, or none for infinite
        shapes.

        Raises:
            UnknownNameError: The model does not exist.
        """
        description = self._entities.model(name)
        own = self._entities.link_motion(name, description.canonical_link).pose.inverse()
        made = zero(f"{PACKAGE}/msg/Bounds")
        pieces = self._pieces(name, description)
        if not pieces or any(each.endless for each in pieces):
            return made
        made.type = BOX
        reach = [
            (moved(each.points, own @ self._place(name, each)), each.radius) for each in pieces
        ]
        low = np.min([points.min(axis=0) - radius for points, radius in reach], axis=0)
        high = np.max([points.max(axis=0) + radius for points, radius in reach], axis=0)
        Vector3 = message_class("geometry_msgs/msg/Vector3")
        made.points = [Vector3(*high.tolist()), Vector3(*low.tolist())]
        return made

    def within(self, asked: Any) -> Callable[[str], bool]:
        """Returns a test whether a model overlaps the given ``Bounds``, which are in the world
        frame.

        Raises:
            Refusal: The bounds are invalid.
        """
        if asked.type == EMPTY:
            return lambda _: True
        points, radius = _shape(asked)
        return lambda name: any(
            self._gap(name, piece, points) <= radius + _TOUCH
            for piece in self._pieces(name, self._entities.model(name))
        )

    def _gap(self, name: str, piece: _Piece, points: Floats) -> float:
        """Distance between a collision and the convex hull of points in the world, m."""
        place = self._place(name, piece)
        if piece.endless:
            on, normal = place.apply(piece.points[0]), rotate(place.orientation, piece.points[1])
            return float(((points - on) @ normal).min())
        return distance(moved(piece.points, place), points) - piece.radius

    def _place(self, name: str, piece: _Piece) -> Pose:
        return self._entities.link_motion(name, piece.link).pose

    def _pieces(self, name: str, description: RobotDescription) -> tuple[_Piece, ...]:
        before, pieces = self._known.get(name, (None, ()))
        if before is not description:
            pieces = tuple(_solid(description, "collisions") or _solid(description, "visuals"))
            self._known[name] = description, pieces
        return pieces


def _solid(description: RobotDescription, kind: str) -> list[_Piece]:
    return [piece for link in description.links for piece in _of(link.name, getattr(link, kind))]


def _of(link: str, parts: Any) -> Iterator[_Piece]:
    for part in parts:
        shape, place = part.shape, part.pose
        if isinstance(shape, Plane):
            normal = rotate(place.orientation, shape.normal)
            yield _Piece(link, np.array([place.position, normal]), endless=True)
        elif isinstance(shape, Heightmap):
            wide, deep, high = shape.size
            corners = _corners((-wide / 2, wide / 2), (-deep / 2, deep / 2), (0.0, high))
            yield _Piece(link, moved(corners + shape.position, place))
        elif isinstance(shape, Polyline):
            corners = np.array([(x, y, z) for x, y in shape.points for z in (0.0, shape.height)])
            yield _Piece(link, moved(corners, place))
        elif isinstance(shape, Sphere):
            yield _Piece(link, np.array([place.position]), radius=shape.radius)
        elif isinstance(shape, Capsule):
            ends = np.array([(0.0, 0.0, -shape.length / 2), (0.0, 0.0, shape.length / 2)])
            yield _Piece(link, moved(ends, place), radius=shape.radius)
        elif (solid := solid_of(part, link)) is not None:
            yield _Piece(link, solid.vertices)


def _shape(asked: Any) -> tuple[Floats, float]:
    """World points whose convex hull is requested, and the distance that it extends beyond them."""
    needed = {BOX: "two points", SPHERE: "two points", CONVEX_HULL: "at least three points"}
    if asked.type not in needed:
        raise Refusal(UNSUPPORTED, f"bounds of type {asked.type} are not supported")
    given = [vector(point, f"points[{index}]") for index, point in enumerate(asked.points)]
    if len(given) < 3 if asked.type == CONVEX_HULL else len(given) != 2:
        raise Refusal(FAILED, f"bounds of type {asked.type} require {needed[asked.type]}")
    points = np.array(given)
    if asked.type == SPHERE:
        radius = float(points[1, 0])
        if radius < 0:
            raise Refusal(FAILED, f"a sphere's radius must not be negative (got {radius:g})")
        return points[:1], radius
    if asked.type == BOX:
        points = _corners(*points.T)
    return points, 0.0


def _corners(x: Any, y: Any, z: Any) -> Floats:
    """Corners of a box from two values per axis, shape (8, 3)."""
    return np.array(list(itertools.product(x, y, z)), dtype=np.float64)
