"""Collision geometry of a fixed mesh: its surface instead of its convex hull.

A convex part of a mesh becomes its own hull. In any other part, each flat patch becomes a thin slab
behind the surface, so that rooms, holes and valleys stay open.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cartwheel.description.meshes.surface import (
    Faces,
    Points,
    components,
    distinct,
    edges_of,
    groups,
    is_closed,
    numbered,
    outwards,
    planes,
    with_area,
)
from cartwheel.description.shapes.outline import Edge, OutlineError, fill
from cartwheel.geometry import cross, cross_rows

MOST_PIECES = 6000
"""Maximum pieces per mesh, which take four seconds to build; parts that need more become hulls."""
_THICKEST, _THINNEST = 0.05, 0.004
"""Limits of a slab's thickness, m."""
_DENT = 0.01
"""Maximum depth of dents in a convex part, and of bends in a flat patch, m."""
_SAME_WAY = 0.9995
"""Minimum cosine between the normals of neighbours in a patch."""
_SMALL = 0.05
"""m; parts up to this size, such as bolts or keyboard keys, become hulls."""
_FINE = 250
"""Facets; parts with more are simplified first."""
_COARSE = (0.01, 0.02, 0.03)
"""Tolerances for merging corners, m: the first with few enough facets is used, or the last."""
_MOST_ASKED = 4096
"""Maximum number of faces tested for convexity; finer meshes are sampled."""
_MOST_PAIRS, _MOST_PAIRS_AT_ONCE = 50_000_000, 2_000_000
"""Maximum pairs of slabs and nearby faces, in total and at once: ten seconds, and 400 MB."""
_MOST_SIDE_PAIRS = 10_000_000
"""Maximum pairs for the sides of a mesh's slabs; each part has its share of them."""
_SHARES = (0.05, 0.5, 0.95)
"""Where along an edge the neighbour is looked for."""
_REACHES = np.array([2.0, 4.0])
"""How far an oblique side reaches below a neighbour, in multiples of the slab's thickness."""
_LOWER = 1.8
"""Largest distance to a neighbour from a thickness above the slab, in thicknesses."""


@dataclass(frozen=True, slots=True, eq=False)
class Standing:
    """The convex pieces for collisions with a fixed mesh."""

    pieces: tuple[Points, ...] = ()
    """Corners of each piece, (n, 3) in m; empty if the hull of the whole mesh is as good."""
    hulls: int = 0
    """Number of parts that became hulls because their surface needs too many pieces."""


def standing_pieces(vertices: NDArray[np.floating], faces: NDArray[np.integer]) -> Standing:
    """Convex pieces that cover a mesh's surface.

    Args:
        vertices: Shape (n, 3), m; without duplicates.
        faces: Shape (m, 3), counter-clockwise from outside.
    """
    points = np.asarray(vertices, dtype=np.float64)
    triangles = with_area(points, np.asarray(faces, dtype=np.int64))
    if not len(triangles):
        return Standing()
    pieces: list[Points] = []
    parts = components(triangles, len(points))
    if len(parts) > MOST_PIECES:
        return Standing(hulls=1)
    hulls = 0
    for part in parts:
        slabs = None
        corners = points[distinct(part)]
        if np.ptp(corners, axis=0).max() > _SMALL and not _is_convex(points, part, corners):
            pairs = _MOST_SIDE_PAIRS * len(part) // len(triangles)
            slabs = _slabs(*_coarse(points, part), MOST_PIECES - len(pieces), pairs)
            hulls += slabs is None
        one_hull = slabs is None and len(parts) == 1
        pieces += [corners] if slabs is None else slabs
    if one_hull:
        return Standing(hulls=hulls)
    return Standing(tuple(piece for piece in pieces if _is_solid(piece)), hulls)


def _coarse(points: Points, faces: Faces) -> tuple[Points, Faces]:
    """Simplifies a finely meshed surface by merging corners at their mean.

    A chair may have 30,000 facets, each of which would become a slab.
    """
    for size in _COARSE:
        if len(faces) <= _FINE:
            break
        points, faces = _merged(points, faces, size)
    return points, faces


def _merged(points: Points, faces: Faces, size: float) -> tuple[Points, Faces]:
    """A surface with at most one corner in each cube of a grid."""
    used, place = np.unique(faces, return_inverse=True)
    cells = np.floor(points[used] / size).astype(np.int64)
    _, cell, count = np.unique(cells, axis=0, return_inverse=True, return_counts=True)
    cell = cell.ravel()
    middles = np.zeros((len(count), 3))
    np.add.at(middles, cell, points[used])
    middles /= count[:, None]
    merged = cell[place.reshape(faces.shape)]
    first = merged.argmin(axis=1)[:, None]
    turned = np.take_along_axis(merged, (first + np.arange(3)) % 3, axis=1)
    return middles, with_area(middles, np.unique(turned, axis=0))


def _is_convex(points: Points, faces: Faces, corners: Points) -> bool:
    """Whether a closed surface with some corners is convex; an open surface has no inside."""
    if not is_closed(faces):
        return False
    normals, origins = planes(points, outwards(points, faces)[:: len(faces) // _MOST_ASKED + 1])
    for start in range(0, len(normals), 256):
        block = slice(start, start + 256)
        ahead = normals[block] @ corners.T
        ahead -= np.einsum("ij,ij->i", normals[block], origins[block])[:, None]
        if float(ahead.max()) > _DENT:
            return False
    return True


def _slabs(points: Points, faces: Faces, most: int, pairs: int) -> list[Points] | None:
    """A slab for each convex piece of each flat patch; None if there would be more than `most`.

    Also None if tracing a patch's rim, or finding nearby faces, would take too long. If the sides
    would need more than `pairs` pairs of points and nearby faces, they are not oblique.
    """
    if is_closed(faces):
        faces = outwards(points, faces)
    normals, origins = planes(points, faces)
    fronts: list[Points] = []
    facing: list[Points] = []
    for patch in _patches(faces, normals, points):
        if len(patch) == 1:
            outlines, normal = [points[faces[patch[0]]]], normals[patch[0]]
        else:
            try:
                outlines, normal = _outlines(points, faces[patch], normals[patch], origins[patch])
            except OutlineError:
                return None
        if len(fronts) + len(outlines) > most:
            return None
        fronts += outlines
        facing += [normal] * len(outlines)
    if not fronts:
        return []
    middles = np.array([front.mean(axis=0) for front in fronts])
    thicknesses = _thicknesses(middles, np.array(facing), points, faces)
    if thicknesses is None:
        return None
    sides = _sides(fronts, facing, thicknesses, (points, faces), pairs)
    slabs = []
    for front, normal, middle, thick, side in zip(
        fronts, facing, middles, thicknesses, sides, strict=True
    ):
        # The back is smaller, to stay behind the neighbouring patches too.
        arms = front - middle
        reach = np.linalg.norm(arms, axis=1, keepdims=True)
        back = middle + arms * np.maximum(0.2, 1 - thick / np.maximum(reach, 1e-9))
        slabs.append(np.concatenate([front, back - thick * normal, side]))
    return slabs


def _outlines(
    points: Points, faces: Faces, normals: Points, origins: Points
) -> tuple[list[Points], Points]:
    """The convex pieces of a flat patch, and its normal."""
    normal = normals.mean(axis=0)
    normal /= np.linalg.norm(normal)
    u = cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    u /= np.linalg.norm(u)
    v = cross(normal, u)
    flat = np.column_stack([points @ u, points @ v])
    height = float((origins @ normal).mean())
    pieces = (np.array(piece) for piece in fill(_rim(faces, flat)))
    found = [piece[:, :1] * u + piece[:, 1:] * v + height * normal for piece in pieces]
    return found, normal


def _patches(faces: Faces, normals: Points, points: Points) -> Iterator[NDArray[np.int64]]:
    """Indices of the faces in each flat patch."""
    edges = edges_of(faces)
    owners = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, owners = edges[order], owners[order]
    shared = (edges[1:] == edges[:-1]).all(axis=1)
    one, two = owners[:-1][shared], owners[1:][shared]
    level = np.einsum("ij,ij->i", normals[one], normals[two]) > _SAME_WAY
    one, two = one[level], two[level]
    label = np.arange(len(faces))
    while True:
        before = label.copy()
        low = np.minimum(label[one], label[two])
        np.minimum.at(label, one, low)
        np.minimum.at(label, two, low)
        label = label[label]
        if (label == before).all():
            break
    for patch in groups(label):
        corners = points[np.unique(faces[patch])]
        normal = normals[patch].mean(axis=0)
        if np.ptp(corners @ normal) <= _DENT:
            yield patch
        else:  # a smooth bend, which is split into its facets
            yield from (np.array([face]) for face in patch)


def _rim(faces: Faces, flat: Points) -> list[Edge]:
    """The edges that belong to a single face."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    numbers = numbered(np.sort(edges, axis=1))
    _, first, counts = np.unique(numbers, return_index=True, return_counts=True)
    found = []
    for a, b in edges[first[counts == 1]].tolist():
        p, q = flat[a].tolist(), flat[b].tolist()
        found.append(((p[0], p[1]), (q[0], q[1])))
    return found


def _thicknesses(middles: Points, normals: Points, points: Points, faces: Faces) -> Points | None:
    """Half the wall thickness behind each point, within a slab's limits.

    None if too many faces are near too many points.
    """
    found = _depths(middles, normals, points, faces, _MOST_PAIRS)
    return None if found is None else np.asarray(np.clip(found[0] / 2, _THINNEST, _THICKEST))


def _sides(
    fronts: list[Points],
    facing: list[Points],
    thicknesses: Points,
    surface: tuple[Points, Faces],
    most: int,
) -> list[Points]:
    """Further corners at the back of each slab, below neighbours in almost the same plane.

    Whatever sinks into a slab next to a neighbour would otherwise be pushed along the surface by
    the neighbour's side, if that is the shortest way out. A side that is this oblique pushes it up.
    """
    starts, ways, ups, deep, owners = [], [], [], [], []
    for index, (front, normal, thick) in enumerate(zip(fronts, facing, thicknesses, strict=True)):
        along = np.roll(front, -1, axis=0) - front
        out = cross_rows(along, normal)
        lengths = np.linalg.norm(out, axis=1)
        sound = lengths > 1e-6
        out = out[sound] / lengths[sound, None]
        start, along = front[sound], along[sound]
        inward = np.einsum("ij,ij->i", start + along / 2 - front.mean(axis=0), out) < 0
        out[inward] = -out[inward]
        starts.append(np.stack([start + share * along for share in _SHARES], axis=1))
        ways.append(out * thick)
        ups.append(np.broadcast_to(normal, out.shape))
        deep.append(np.full(len(out), thick))
        owners.append(np.full(len(out), index))
    start, way, up = np.concatenate(starts), np.concatenate(ways), np.concatenate(ups)
    thick, owner = np.concatenate(deep), np.concatenate(owners)
    # From above the surface next to each edge, at two distances from it.
    above = (start[:, None] + (way[:, None] * _REACHES[:, None])[:, :, None]) + (
        (up * thick[:, None])[:, None, None]
    )
    rays = np.broadcast_to(up[:, None, None], above.shape)
    found = _depths(above.reshape(-1, 3), rays.reshape(-1, 3), *surface, most)
    sides: list[list[Points]] = [[] for _ in fronts]
    if found is not None:
        first, second = (each.reshape(above.shape[:3]) for each in found)
        limit = thick[:, None, None]
        # The neighbour is hardly lower, and as thick.
        hit = np.logical_and(first < _LOWER * limit, second > 1.99 * limit)
        covered = np.logical_and.reduce(hit, axis=2)
        is_near, is_far = covered[:, 0], covered[:, 0] & covered[:, 1]
        for edge in np.flatnonzero(is_near).tolist():
            reach = _REACHES[int(is_far[edge])]
            ends = start[edge, [0, -1]] + reach * way[edge] - thick[edge] * up[edge]
            sides[owner[edge]].append(ends)
    return [np.concatenate(each) if each else np.empty((0, 3)) for each in sides]


def _depths(
    starts: Points, normals: Points, points: Points, faces: Faces, most: int
) -> tuple[Points, Points] | None:
    """Distances against the normals to the first and the second face, m, at most twice a slab's.

    None if there would be more than `most` pairs of points and nearby faces.
    """
    a, b, c = (points[faces[:, k]] for k in range(3))
    e1, e2 = b - a, c - a
    across = cross_rows(e1, e2)
    lowest, highest = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    first = np.full(len(starts), 2 * _THICKEST)
    second = first.copy()
    # Tests each ray against each triangle in range with the Möller-Trumbore test, written as triple
    # products. Nearby rays are tested together.
    for block in _near(starts):
        low = starts[block].min(axis=0) - 2 * _THICKEST
        high = starts[block].max(axis=0) + 2 * _THICKEST
        near = np.flatnonzero((highest >= low).all(axis=1) & (lowest <= high).all(axis=1))
        most -= len(block) * len(near)
        if most < 0 or len(block) * len(near) > _MOST_PAIRS_AT_ONCE:
            return None
        along = -normals[block][:, None, :]
        s = starts[block][:, None, :] - a[near][None]
        turned = cross_rows(s, along)
        with np.errstate(divide="ignore", invalid="ignore"):
            area = -(along * across[near]).sum(axis=2)
            t = (s * across[near]).sum(axis=2) / area
            u = (e2[near] * turned).sum(axis=2) / area
            v = -(e1[near] * turned).sum(axis=2) / area
            inside = (u >= 0) & (v >= 0) & (u + v <= 1)
        hit = (np.abs(area) > 1e-12) & inside & (t > 1e-4)
        t = np.where(hit, t, 2 * _THICKEST)
        first[block] = t.min(axis=1, initial=2 * _THICKEST)
        # On an edge, two faces are hit at the same distance.
        behind = np.where(t > first[block][:, None] + 1e-4, t, 2 * _THICKEST)
        second[block] = behind.min(axis=1, initial=2 * _THICKEST)
    return first, second


def _near(points: Points) -> Iterator[NDArray[np.int64]]:
    """Groups of up to 64 nearby points, found by repeatedly halving the extent."""
    waiting = [np.arange(len(points))]
    while waiting:
        some = waiting.pop()
        if len(some) <= 64:
            yield some
            continue
        widest = int(np.ptp(points[some], axis=0).argmax())
        some = some[np.argsort(points[some, widest], kind="stable")]
        waiting += [some[: len(some) // 2], some[len(some) // 2 :]]


def _is_solid(piece: Points) -> bool:
    """Whether the piece has enough volume for the engine's hull."""
    spread = np.linalg.svd(piece - piece.mean(axis=0), compute_uv=False)
    return bool(spread[2] > 1e-4)
