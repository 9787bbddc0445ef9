"""One coloured piece of a mesh, and the error of a mesh file that gives none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.codes.files import MESH_UNREADABLE
from cartwheel.errors import Code, DescriptionError, Origin, Value

if TYPE_CHECKING:
    from cartwheel.description.model import Rgba

Floats = NDArray[np.float32]
Ints = NDArray[np.int32]

MOST_BYTES = 1 << 28
"""Of a file."""
MOST_TRIANGLES = 5_000_000
"""Of a file, with all its instances; a scanned building has two million."""


class MeshError(DescriptionError):
    """A mesh file that cannot be used.

    Args:
        path: The file.
        reason: What is wrong with it, without its name.
        code: Where it is not `MESH_UNREADABLE`.
        origin: The element that names it.
        hint: The likely fix.
        meant: The submesh that was likely meant, where one is unknown.
        values: What else the reason names, for programs.
    """

    code = MESH_UNREADABLE

    def __init__(
        self,
        path: Path,
        reason: str,
        *,
        code: Code | None = None,
        origin: Origin | None = None,
        hint: str | None = None,
        meant: str = "",
        values: Mapping[str, Value] | None = None,
    ) -> None:
        self.path = path
        self.reason = reason
        self.meant = meant
        super().__init__(
            f"mesh {path}: {reason}",
            code=code,
            origin=origin,
            hint=hint,
            values={**(values or {}), "kind": "mesh", "name": str(path), "meant": meant},
        )


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Submesh:
    """Triangles of one material, in the frame of the visual or collision; arrays are read-only."""

    name: str
    """The node's; the geometry's where it has none."""
    vertices: Floats
    """(n, 3), metres."""
    faces: Ints
    """(m, 3), counter-clockwise seen from outside."""
    normals: Floats | None = None
    """(n, 3), unit length; None where the file states none."""
    uv: Floats | None = None
    """(n, 2), v up: (0, 0) is the image's lower left corner."""
    rgba: Rgba | None = None
    """Diffuse colour; None where the file states none."""
    texture: Path | bytes | None = None
    """An image file, or one's contents."""
    geometry: str = ""
    """What the file calls the geometry, which a ``<submesh>`` may name as well."""


def build_submesh(
    name: str,
    vertices: NDArray[Any],
    faces: NDArray[Any],
    *,
    normals: NDArray[Any] | None = None,
    uv: NDArray[Any] | None = None,
    rgba: Rgba | None = None,
    texture: Path | bytes | None = None,
) -> Submesh | None:
    """A checked submesh without its degenerate triangles; None where no triangle is left.

    Raises:
        ValueError: a vertex is not finite, or a face names a vertex that does not exist.
    """
    points = np.ascontiguousarray(vertices, dtype=np.float32).reshape(-1, 3)
    triangles = np.ascontiguousarray(faces, dtype=np.int64).reshape(-1, 3)
    if not np.isfinite(points).all():
        raise ValueError("a vertex is not a finite number")
    if triangles.size and (triangles.min() < 0 or triangles.max() >= len(points)):
        raise ValueError("a face refers to a vertex that does not exist")
    proper = _has_area(points, triangles)
    directions = _per_vertex(normals, len(points), 3)
    coordinates = _per_vertex(uv, len(points), 2)
    if not proper.all():
        triangles = triangles[proper]
        if not len(triangles):
            return None
        # A degenerate triangle's corners often have no normal either: they go with it.
        used, compact = np.unique(triangles, return_inverse=True)
        triangles, points = compact.reshape(-1, 3), points[used]
        directions = directions[used] if directions is not None else None
        coordinates = coordinates[used] if coordinates is not None else None
    if not len(triangles):
        return None
    if directions is not None:
        lengths = np.linalg.norm(directions, axis=1, keepdims=True)
        if not (np.isfinite(lengths).all() and (lengths > 1e-9).all()):
            directions = None  # the renderer's own are better than half of them
        else:
            directions = (directions / lengths).astype(np.float32)
    return _frozen(
        Submesh(
            name=name,
            vertices=points,
            faces=triangles.astype(np.int32),
            normals=directions,
            uv=coordinates,
            rgba=rgba,
            texture=texture,
        )
    )


def scale_submesh(submesh: Submesh, scale: tuple[float, float, float]) -> Submesh:
    """The submesh scaled along its axes; a mirroring scale turns the faces, so outside stays."""
    if scale == (1.0, 1.0, 1.0):
        return submesh
    factors = np.asarray(scale, dtype=np.float32)
    normals = submesh.normals
    if normals is not None:
        normals = normals / factors  # the inverse transpose of a diagonal matrix
        normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)
    mirrored = float(np.prod(np.sign(factors))) < 0
    return _frozen(
        replace(
            submesh,
            vertices=submesh.vertices * factors,
            faces=np.ascontiguousarray(submesh.faces[:, ::-1]) if mirrored else submesh.faces,
            normals=normals,
        )
    )


def unique_rows(points: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Indices of the distinct rows, and for each row the number of its distinct one.

    Rows are told apart by a 64-bit hash, as sorting numbers takes a tenth of the time of sorting
    rows; a collision, which no real mesh has shown, falls back to the rows themselves.
    """
    rows = np.ascontiguousarray(points) + np.float32(0)  # -0.0 and 0.0 are one place
    bits = rows.view(np.uint32).astype(np.uint64)
    key = np.zeros(len(rows), dtype=np.uint64)
    for column in bits.T:
        key = (key ^ column) * np.uint64(0x9E3779B97F4A7C15)
        key ^= key >> np.uint64(29)
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    inverse = inverse.reshape(-1)
    if not np.array_equal(rows[first][inverse], rows):
        _, first, inverse = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return first.astype(np.int64), inverse.reshape(-1).astype(np.int64)


def _has_area(points: Floats, triangles: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Which triangles have three corners in three places that are not on a line."""
    a, b, c = (points[triangles[:, i]].astype(np.float64) for i in range(3))
    ab, ac = b - a, c - a
    doubled = np.linalg.norm(np.cross(ab, ac), axis=1)
    longest = np.maximum(np.einsum("ij,ij->i", ab, ab), np.einsum("ij,ij->i", ac, ac))
    # Relative to the edges, as a mesh in millimetres is scaled only later; single precision
    # resolves an angle no finer than this.
    return np.asarray((longest > 0) & (doubled > 1e-7 * longest))


def _per_vertex(values: NDArray[Any] | None, count: int, width: int) -> Floats | None:
    if values is None:
        return None
    array = np.ascontiguousarray(values, dtype=np.float32)
    if array.shape != (count, width) or not np.isfinite(array).all():
        return None
    return array


def _frozen(submesh: Submesh) -> Submesh:
    """Cached arrays are shared between robots: nobody may write to them."""
    for array in (submesh.vertices, submesh.faces, submesh.normals, submesh.uv):
        if array is not None:
            array.flags.writeable = False
    return submesh
