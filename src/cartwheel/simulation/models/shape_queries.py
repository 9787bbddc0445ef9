"""Rays, distances between shapes and the height of the ground, for programs."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from cartwheel.geometry import Vec3
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.models.terrain_distance import Terrain
from cartwheel.simulation.models.touches import collision_names
from cartwheel.world.bodies import COLLISION_GROUP
from cartwheel.world.entry import ModelEntry
from cartwheel.world.visuals import HIDDEN_GROUP

Place = tuple[str, str, str]
"""Names of the model, the link and the collision."""
Link = tuple[str, str]
"""Names of the model and the link."""
Chosen = Callable[[Place], bool]
"""Whether a collision counts."""

_PLANE = mujoco.mjtGeom.mjGEOM_PLANE
_HEIGHTMAP = mujoco.mjtGeom.mjGEOM_HFIELD
_FARTHEST = 1e6
"""m."""
_ABOVE = 1.0
"""m; height above everything from which the ground is searched."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Seen:
    """Where a ray hits a collision."""

    place: Place
    distance: float
    """m."""
    point: Vec3
    """m, in the world."""
    normal: Vec3
    """Unit vector out of the surface, in the world."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Gap:
    """The shortest way between two collisions."""

    places: tuple[Place, Place]
    distance: float
    """m; negative if they overlap."""
    points: tuple[Vec3, Vec3]
    """m, in the world."""


class ShapeQueries:
    """Answers questions about the collision shapes in the current state.

    Args:
        engine: The engine.
        entries: Returns the models in the world.
    """

    def __init__(self, engine: Engine, entries: Callable[[], Sequence[ModelEntry]]) -> None:
        self._engine = engine
        self._entries = entries
        self._model: Any = None
        self._places: list[Place] = []
        self._shapes: list[int] = []
        """Geoms of collisions."""
        self._terrains: dict[int, Terrain] = {}
        """The heightmaps to which distances were computed, by their geoms."""

    def ray(self, origin: Vec3, direction: Vec3, most: float, passed: Chosen) -> Seen | None:
        """What a ray hits first; None if it hits nothing within a distance.

        Args:
            origin: m, in the world.
            direction: Of any length above 0, in the world.
            most: m; may be infinite.
            passed: Whether the ray passes a collision.
        """
        self._bind()
        unit = np.array(direction) / np.linalg.norm(direction)
        return self._cast(np.array(origin), unit, most, passed)

    def ground(self, x: float, y: float, below: float) -> float | None:
        """Height of the highest fixed surface at a place, m; None without one.

        Args:
            x: m.
            y: m.
            below: Only surfaces below this height count, m; may be infinite.
        """
        self._bind()
        model, data = self._engine.model, self._engine.data
        fixed = [
            shape for shape in self._shapes if model.body_weldid[model.geom_bodyid[shape]] == 0
        ]
        if not fixed:
            return None
        if below == math.inf:
            tops = data.geom_xpos[fixed, 2] + model.geom_rbound[fixed]
            below = float(tops.max()) + _ABOVE
        fixed_names = {self._places[shape] for shape in fixed}
        down = np.array([0.0, 0.0, -1.0])
        start = np.array([x, y, below])
        found = self._cast(start, down, math.inf, lambda place: place not in fixed_names)
        return None if found is None else found.point[2]

    def gap(self, first: Chosen, second: Chosen) -> Gap | None:
        """The shortest way between two sets of collisions; None if one of them is empty.

        Args:
            first: Selects the collisions of one set.
            second: Selects those of the other one, without those of the first.
        """
        self._bind()
        ones = [shape for shape in self._shapes if first(self._places[shape])]
        taken = set(ones)
        others = [
            shape for shape in self._shapes if shape not in taken and second(self._places[shape])
        ]
        best: Gap | None = None
        ends = np.zeros(6)
        for least, most, one, other in self._pairs(ones, others):
            if best is not None:
                if least >= best.distance:
                    break
                most = min(most, best.distance)  # noqa: PLW2901 - no farther than the best
            distance = self._distance(one, other, most, ends)
            if distance >= most and best is not None:
                continue
            start, end = ends[:3].tolist(), ends[3:].tolist()
            best = Gap(
                places=(self._places[one], self._places[other]),
                distance=float(distance),
                points=((start[0], start[1], start[2]), (end[0], end[1], end[2])),
            )
        return best

    def are_apart(self, one: Link, other: Link, distance: float) -> bool:
        """Whether all collisions of two links are farther apart than a distance, m."""
        self._bind()
        ones, others = (
            [shape for shape in self._shapes if self._places[shape][:2] == link]
            for link in (one, other)
        )
        ends = np.zeros(6)
        for least, _, first, second in self._pairs(ones, others):
            if least > distance:
                break
            if self._distance(first, second, 2 * distance, ends) <= distance:
                return False
        return True

    def _distance(self, one: int, other: int, most: float, ends: Any) -> float:
        """Distance between two geoms, m, at most `most`; `ends` receives the nearest points."""
        model, data = self._engine.model, self._engine.data
        if model.geom_type[one] == _HEIGHTMAP:
            return self._terrain(one).distance(data, other, most=most, ends=ends)
        if model.geom_type[other] == _HEIGHTMAP:
            distance = self._terrain(other).distance(data, one, most=most, ends=ends)
            ends[:3], ends[3:] = ends[3:].copy(), ends[:3].copy()
            return distance
        return float(mujoco.mj_geomDistance(model, data, one, other, most, ends))

    def _terrain(self, geom: int) -> Terrain:
        if geom not in self._terrains:
            self._terrains[geom] = Terrain(self._engine.model, geom)
        return self._terrains[geom]

    def _pairs(
        self, ones: Sequence[int], others: Sequence[int]
    ) -> Iterator[tuple[float, float, int, int]]:
        """Pairs of shapes by the least possible distance, with the largest possible one."""
        model, data = self._engine.model, self._engine.data
        if not ones or not others:
            return
        apart = np.linalg.norm(data.geom_xpos[ones][:, None] - data.geom_xpos[others][None], axis=2)
        reach = model.geom_rbound[ones][:, None] + model.geom_rbound[others][None]
        planes = model.geom_type == _PLANE
        endless = planes[ones][:, None] | planes[others][None]
        least = np.where(endless, self._above_planes(ones, others), apart - reach)
        most = np.where(endless, _FARTHEST, np.minimum(apart + reach + _ABOVE, _FARTHEST))
        grounds = planes | (model.geom_type == _HEIGHTMAP)
        both = grounds[ones][:, None] & grounds[others][None]
        for index in np.argsort(least, axis=None, kind="stable").tolist():
            row, column = divmod(index, len(others))
            if not both[row, column]:
                yield float(least[row, column]), float(most[row, column]), ones[row], others[column]

    def _above_planes(self, ones: Sequence[int], others: Sequence[int]) -> Any:
        """Least possible distances of shapes to planes, m; of other pairs, any number."""
        model, data = self._engine.model, self._engine.data
        normals = data.geom_xmat.reshape(-1, 3, 3)[:, :, 2]

        def height(shapes: Sequence[int], planes: Sequence[int]) -> Any:
            way = data.geom_xpos[shapes][:, None] - data.geom_xpos[planes][None]
            along = np.einsum("ijk,jk->ij", way, normals[planes])
            return along - model.geom_rbound[shapes][:, None]

        planes = model.geom_type[ones] == _PLANE
        return np.where(planes[:, None], height(others, ones).T, height(ones, others))

    def _cast(self, start: Any, unit: Any, most: float, passed: Chosen) -> Seen | None:
        model, data = self._engine.model, self._engine.data
        groups = np.zeros(mujoco.mjNGROUP, dtype=np.uint8)
        groups[COLLISION_GROUP] = 1
        hit, normal = np.full(1, -1, dtype=np.int32), np.zeros(3)
        hidden = [shape for shape in self._shapes if passed(self._places[shape])]
        before = model.geom_group[hidden]
        model.geom_group[hidden] = HIDDEN_GROUP
        try:
            distance = mujoco.mj_ray(model, data, start, unit, groups, True, -1, hit, normal)
        finally:
            model.geom_group[hidden] = before
        if hit[0] < 0 or distance > most:
            return None
        x, y, z = (start + distance * unit).tolist()
        nx, ny, nz = normal.tolist()
        return Seen(
            place=self._places[int(hit[0])],
            distance=float(distance),
            point=(x, y, z),
            normal=(nx, ny, nz),
        )

    def _bind(self) -> None:
        engine = self._engine
        if self._model is not engine.model:
            self._model = engine.model
            self._terrains = {}
            self._places = collision_names(engine.model, self._entries())
            self._shapes = np.flatnonzero(engine.model.geom_group == COLLISION_GROUP).tolist()
        engine.refresh_poses()
