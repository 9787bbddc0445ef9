"""A coloured part of a mesh, and the error for unusable mesh files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cartwheel.codes.files import MESH_UNREADABLE
from cartwheel.errors import Code, DescriptionError, Origin, Value
from cartwheel.geometry import cross_rows

if TYPE_CHECKING:
    from cartwheel.description.model import Rgba

Floats = NDArray[np.float32]
Ints = NDArray[np.int32]

MOST_BYTES = 1 << 28
"""Maximum file size."""
MOST_TRIANGLES = 5_000_000
"""Maximum triangles in a file, with all instances; a scanned building has two million."""


class MeshError(DescriptionError):
    """A mesh file that cannot be used.

    Args:
        path: The file.
        reason: What is wrong with it, without its name.
        code: Replaces `MESH_UNREADABLE`.
        origin: The element that refers to the file.
        hint: The likely fix.
        meant: The suggested submesh, if the name is unknown.
        values: Other names and numbers in the reason, for programs.
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
    """Triangles with one material, in the frame of the visual or collision. Read-only arrays."""

    name: str
    """Name of the node, or of the geometry if the node has none."""
    vertices: Floats
    """(n, 3), metres."""
    faces: Ints
    """(m, 3), counter-clockwise seen from outside."""
    normals: Floats | None = None
    """(n, 3), unit length; None if the file contains none."""
    uv: Floats | None = None
    """(n, 2), v up: (0, 0) is the image's lower left corner."""
    rgba: Rgba | None = None
    """Diffuse colour; None if the file states none."""
    texture: Path | bytes | None = None
    """An image file, or its contents."""
    geometry: str = ""
    """The geometry's name in the file, which a ``<submesh>`` may also use."""


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
    """A validated submesh without degenerate triangles; None if no triangle remains.

    Raises:
        ValueError: A vertex is not finite, or a face refers to a vertex that does not exist.
    """
    points = np.ascontiguousarray(vertices, dtype=np.float32).reshape(-1, 3)
    triangles = np.ascontiguousarray(faces, dtype=np.int64).reshape(-1, 3)
    if not np.isfinite(points).all():
        raise ValueError("a vertex coordinate is not finite")
    if triangles.size and (triangles.min() < 0 or triangles.max() >= len(points)):
        raise ValueError("a face of the mesh contains an invalid vertex index")
    proper = has_area(points, triangles)
    directions = _per_vertex(normals, len(points), 3)
    coordinates = _per_vertex(uv, len(points), 2)
    if not proper.all():
        triangles = triangles[proper]
        if not len(triangles):
            return None
        # The vertices of degenerate triangles often have no normal: they are removed as well.
        used, compact = np.unique(triangles, return_inverse=True)
        triangles, points = compact.reshape(-1, 3), points[used]
        directions = directions[used] if directions is not None else None
        coordinates = coordinates[used] if coordinates is not None else None
    if not len(triangles):
        return None
    if directions is not None:
        lengths = np.linalg.norm(directions, axis=1, keepdims=True)
        if not (np.isfinite(lengths).all() and (lengths > 1e-9).all()):
            directions = None  # the renderer's normals are better than incomplete ones
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
    """The submesh scaled along its axes; mirroring also reverses the faces to keep the outside."""
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


def memory_of(submesh: Submesh) -> int:
    """The memory of a submesh, bytes; several may share an image."""
    arrays = (submesh.vertices, submesh.faces, submesh.normals, submesh.uv)
    image = len(submesh.texture) if isinstance(submesh.texture, bytes) else 0
    return image + sum(each.nbytes for each in arrays if each is not None)


def unique_rows(points: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Indices of the distinct rows, and for each row the number of its distinct row.

    Rows are compared by a 64-bit hash, because sorting numbers takes a tenth of the time of sorting
    rows. In the case of a collision, which no real mesh has shown, the rows themselves are
    compared.
    """
    rows = np.ascontiguousarray(points) + np.float32(0)  # -0.0 and 0.0 are equal
    bits = rows.view(np.uint32).astype(np.uint64)
    key = np.zeros(len(rows), dtype=np.uint64)
    for column in bits.T:
        key = (key ^ column) * np.uint64(0x9E3779B97F4A7C15)
        key ^= key >> np.uint64(29)
    if (key[1:] > key[:-1]).all():  # they are the result of an earlier call
        return np.arange(len(rows)), np.arange(len(rows))
    _, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    inverse = inverse.reshape(-1)
    if not np.array_equal(rows[first][inverse], rows):
        _, first, inverse = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return first.astype(np.int64), inverse.reshape(-1).astype(np.int64)


def has_area(points: Floats, triangles: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Which triangles have three different corners that are not on a line."""
    corners = points[triangles].astype(np.float64)
    a = corners[:, 0]
    ab, ac = corners[:, 1] - a, corners[:, 2] - a
    doubled = np.linalg.norm(cross_rows(ab, ac), axis=1)
    longest = np.maximum(np.einsum("ij,ij->i", ab, ab), np.einsum("ij,ij->i", ac, ac))
    # Relative to the edges, because a mesh in millimetres is scaled later; single precision does
    # not resolve smaller angles.
    return np.asarray((longest > 0) & (doubled > 1e-7 * longest))


def _per_vertex(values: NDArray[Any] | None, count: int, width: int) -> Floats | None:
    if values is None:
        return None
    array = np.ascontiguousarray(values, dtype=np.float32)
    if array.shape != (count, width) or not np.isfinite(array).all():
        return None
    return array


def _frozen(submesh: Submesh) -> Submesh:
    """Makes cached arrays read-only, because several robots share them."""
    for array in (submesh.vertices, submesh.faces, submesh.normals, submesh.uv):
        if array is not None:
            array.flags.writeable = False
    return submesh
